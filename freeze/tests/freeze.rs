//! What can be frozen, and that the same is always written.

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use controller_core::law::null_space::Posture;
use controller_core::{
    Axes, Capacity, ControllerConfig, Link, NullSpace, Task, TaskGains, TaskSet,
};
use freeze::{FreezeError, Precision, Request, freeze};

fn config(tasks: &[Task]) -> ControllerConfig {
    ControllerConfig {
        tasks: TaskSet::new(tasks).expect("valid"),
        null_space: NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING),
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    }
}

const FLANGE: Task = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));

fn frozen(config: &ControllerConfig, limits: bool) -> Result<freeze::Frozen, FreezeError> {
    freeze(&Request {
        arm: &LWR_IV,
        config,
        limits,
        precision: Precision::F64,
        job: "test",
    })
}

#[test]
fn the_same_controller_gives_the_same_file() {
    for limits in [true, false] {
        let config = config(&[FLANGE]);
        let [first, second] = [(); 2].map(|()| frozen(&config, limits).expect("frozen").rust());
        assert!(first == second, "limits {limits}");
        assert!(first.contains(&format!("{:#018x}", controller_core::SOURCE)));
    }
}

/// Gains are inputs: another one gives the same functions.
#[test]
fn other_gains_change_nothing_but_the_values_they_start_with() {
    let functions = |stiffness: f64| {
        let gains = TaskGains::uniform(stiffness, 40.0);
        let task = Task::position(LWR_IV_FLANGE, Axes::XYZ, gains);
        let text = frozen(&config(&[task]), true).expect("frozen").rust();
        let start = text.find("/// What the robot reports").expect("types");
        text[start..].to_string()
    };
    assert!(functions(400.0) == functions(300.0));
}

#[test]
fn what_cannot_be_frozen_is_named() {
    let refused = |change: &dyn Fn(&mut ControllerConfig), limits: bool| {
        let mut config = config(&[FLANGE]);
        change(&mut config);
        frozen(&config, limits).expect_err("refused")
    };
    let dead = refused(&|config| config.dead_cycles = 2, true);
    assert_eq!(dead, FreezeError::DeadCycles(2));
    assert_eq!(
        dead.to_string(),
        "dead time of 2 cycles; a frozen cycle allows 0"
    );
    let integrated = |config: &mut ControllerConfig| {
        config.null_space.posture = Posture::IntegralCoupled;
    };
    assert_eq!(refused(&integrated, false), FreezeError::Posture);
    let roomier = |config: &mut ControllerConfig| {
        let capacity = Capacity { levels: 3, rows: 8 };
        config.tasks = config.tasks.with_capacity(capacity).expect("room");
    };
    assert_eq!(refused(&roomier, true), FreezeError::Capacity);
    let turned = Task::orientation(Link::L7.frame(), Axes::XYZ, TaskGains::uniform(400.0, 40.0));
    assert_eq!(
        frozen(&config(&[FLANGE, turned]), true).expect_err("refused"),
        FreezeError::Orientation { level: 2 }
    );
    let wrong = refused(&|config| config.observer_gain[3] = f64::NAN, true);
    assert!(matches!(wrong, FreezeError::Config(_)), "{wrong}");
}
