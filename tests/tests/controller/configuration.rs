//! Every configuration that cannot be is refused with one line that says what
//! would be allowed.

use arms::LWR_IV;
use controller_core::arm::ArmError;
use controller_core::gain::diagonal;
use controller_core::joint::Vector3;
use controller_core::law::null_space::NullDamping;
use controller_core::ranges::{DEAD_CYCLES_MAX, GAIN_MAX};
use controller_core::task::Tracked;
use controller_core::{
    Axes, ConfigError, Controller, ControllerConfig, Link, LinkPoint, NullSpace, State, Target,
    Task, TaskGains, TaskSet,
};
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, three_level, two_level, with_tasks};
use stratum_tests::controller;

use super::{at, resting, start};

fn refused(change: impl FnOnce(&mut ControllerConfig)) -> (ConfigError, String) {
    let mut config = three_level();
    change(&mut config);
    let controller = Controller::<f64>::new(&LWR_IV, &config);
    let error = controller.expect_err("a configuration that cannot be");
    (error, error.to_string())
}

fn line(change: impl FnOnce(&mut ControllerConfig)) -> String {
    refused(change).1
}

/// Why the tasks of the three-level configuration make no set once one has changed.
fn set_line(level: usize, change: impl FnOnce(&mut Task)) -> String {
    let mut tasks = three_level().tasks.tasks().to_vec();
    change(&mut tasks[level - 1]);
    let error = TaskSet::new(&tasks).expect_err("tasks that make no set");
    error.to_string()
}

/// Levels first, then rows; seven and twelve are allowed.
#[test]
fn sets_have_one_to_seven_levels_and_twelve_rows() {
    let flange = |axes| Task::position(FLANGE, axes, REFERENCE_GAINS);
    assert_eq!(
        TaskSet::new(&[]).map_err(|error| error.to_string()),
        Err("there are 0 tasks; allowed 1 to 7".into())
    );
    assert_eq!(
        TaskSet::new(&[flange(Axes::X); 8]),
        Err(ConfigError::Levels { levels: 8 })
    );
    assert_eq!(
        TaskSet::new(&[flange(Axes::XYZ); 8]).map_err(|error| error.to_string()),
        Err("there are 8 tasks; allowed 1 to 7".into())
    );
    assert_eq!(
        TaskSet::new(&[flange(Axes::XYZ); 5]),
        Err(ConfigError::Rows { rows: 15 })
    );
    assert_eq!(
        TaskSet::new(&[flange(Axes::XY); 7]).map_err(|error| error.to_string()),
        Err("the tasks have 14 rows together; allowed 1 to 12".into())
    );
    for count in 1..=7 {
        let tasks = vec![flange(Axes::Y); count];
        let set = TaskSet::new(&tasks).expect("up to seven");
        assert_eq!(set.tasks(), tasks, "kept in this order");
        let config = with_tasks(&tasks);
        assert_eq!(controller::<f64>(&config).level_count(), count);
    }
    let seven = [Axes::XYZ, Axes::XYZ, Axes::Z].map(flange);
    assert_eq!(TaskSet::new(&seven).expect("seven rows").tasks(), seven);
}

#[test]
fn points_that_are_not_on_the_arm_are_refused() {
    for value in [f64::NAN, 10.5, f64::NEG_INFINITY, -10.000001] {
        let place = |point: LinkPoint| LinkPoint {
            offset: [0.0, value, 0.0],
            ..point
        };
        assert_eq!(
            set_line(1, |task| task.tracked = Tracked::Position(place(FLANGE))),
            format!("level 1: point offset {value} m; allowed -10 to 10")
        );
    }
    // A link that the arm does not have has no name.
    let numbers = (0..10).filter_map(Link::from_number).map(Link::number);
    assert!(numbers.eq(1..=7));
    assert_eq!(Link::from_number(usize::MAX), None);
}

/// The tables of the arm are refused through the controller as well.
#[test]
fn an_arm_that_cannot_be_is_refused() {
    let mut arm = LWR_IV;
    arm.links[3].mass = f64::NAN;
    let error = Controller::<f64>::new(&arm, &three_level()).expect_err("no such arm");
    assert!(matches!(
        error,
        ConfigError::Arm(ArmError::NonFinite { link: 4, .. })
    ));
    assert_eq!(error.to_string(), "link 4: mass = NaN; it must be finite");
}

#[test]
fn gains_that_are_no_gains_are_refused() {
    assert_eq!(
        set_line(1, |task| task.gains.stiffness[1][1] = f64::NAN),
        "level 1: task stiffness [1/s2]: entry NaN; allowed -1e9 to 1e9"
    );
    assert_eq!(
        set_line(2, |task| task.gains.damping[0][0] = 2.0 * GAIN_MAX),
        "level 2: task damping [1/s]: entry 2000000000; allowed -1e9 to 1e9"
    );
    assert_eq!(
        set_line(1, |task| task.gains.stiffness[2][0] = 3.0),
        "level 1: task stiffness [1/s2]: entry (3, 1) differs from (1, 3) by 3; the matrix must \
         be symmetric"
    );
    assert_eq!(
        line(|config| config.null_space.stiffness[6][0] = 0.5),
        "null-space stiffness [Nm/rad]: entry (7, 1) differs from (1, 7) by 0.5; the matrix must \
         be symmetric"
    );
    assert_eq!(
        set_line(1, |task| task.gains.damping[2][2] = 0.0),
        "level 1: task damping [1/s]: pivot 0 at row 3; the matrix must be positive definite (a \
         diagonal one: every entry above 0)"
    );
    assert_eq!(
        line(|config| config.null_space.damping =
            NullDamping::Joint(diagonal([1.0, 1.0, 1.0, -2.0, 1.0, 1.0, 1.0]))),
        "null-space damping [Nms/rad]: pivot -2 at row 4; the matrix must be positive definite (a \
         diagonal one: every entry above 0)"
    );
    // Symmetric with positive entries, and yet not definite.
    let indefinite = [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(
        set_line(1, |task| task.gains.stiffness = indefinite),
        "level 1: task stiffness [1/s2]: pivot -3 at row 2; the matrix must be positive definite \
         (a diagonal one: every entry above 0)"
    );
}

/// Rows and columns of axes that the task does not control have no influence.
#[test]
fn gains_of_uncontrolled_axes_do_not_matter() {
    let with = |change: fn(&mut Task)| {
        let mut tasks = three_level().tasks.tasks().to_vec();
        change(&mut tasks[1]);
        controller::<f64>(&with_tasks(&tasks))
    };
    let torque = |controller: Controller<f64>| {
        let mut reference = resting(&controller, &start());
        if let Target::Position { x, .. } = &mut reference.targets_mut()[1] {
            *x += Vector3::repeat(0.1);
        }
        let mut state = State::new();
        state.follow_at_once();
        let step = controller.step(&mut state, &at(start()), &reference);
        assert!(step.status.is_clear(), "{:?}", step.status);
        step.torque
    };
    let other = with(|task| {
        task.gains.stiffness[2][2] = -1.0;
        task.gains.stiffness[0][2] = 1e12;
        task.gains.damping[2][1] = 7.0;
        task.gains.damping[1][2] = f64::NAN;
        task.gains.stiffness[2][1] = f64::INFINITY;
    });
    assert_eq!(torque(with(|_| ())), torque(other));
}

#[test]
fn observer_gain_cycle_and_dead_time_have_their_ranges() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            line(|config| config.observer_gain[2] = value),
            format!(
                "observer gain of joint 3 is {value} 1/s; it must be above 0 and at most 1000000000.0"
            )
        );
    }
    for value in [0.00009, 0.0201, f64::NAN, -0.002] {
        assert_eq!(
            line(|config| config.cycle_s = value),
            format!("cycle {value} s; allowed 0.0001 to 0.02")
        );
    }
    assert_eq!(DEAD_CYCLES_MAX, 8);
    assert_eq!(
        line(|config| config.dead_cycles = 9),
        "dead time of 9 cycles; allowed 0 to 8"
    );
}

#[test]
fn damping_too_strong_for_the_cycle_is_refused_with_joint_value_and_posture() {
    let (error, text) = refused(|config| config.dead_cycles = 1);
    let named = error.named(&arms::IIWA_7).to_string();
    assert_eq!(named, text.replacen("joint 3", "A3", 1));
    match error {
        ConfigError::Damping {
            joint,
            value,
            bound,
            posture,
        } => {
            // Coaxial with 5 and 7 in the stretched arm, and the most damped of them.
            assert_eq!(joint, 3);
            assert!((1.27..1.33).contains(&value) && (bound - 1.0).abs() < 1e-12);
            assert!(posture.iter().all(|q| q.abs() < 3.0));
        }
        other => panic!("{other}"),
    }
    assert!(
        text.starts_with(
            "null-space damping of joint 3 is too strong for the cycle: h lambda_max = 1."
        ) && text.ends_with(" deg; it must be below 1.000"),
        "{text}"
    );
}

/// D = c M: c must be a rate, and h c stays below one half, dead time or not.
#[test]
fn inertia_shaped_damping_has_its_own_bound() {
    let with = |rate: f64, dead_cycles| {
        let mut config = three_level();
        config.null_space.damping = NullDamping::Inertia(rate);
        config.dead_cycles = dead_cycles;
        Controller::<f64>::new(&LWR_IV, &config)
    };
    for dead_cycles in [0, 1, 2] {
        assert!(with(249.0, dead_cycles).is_ok(), "h c = 0.498");
        assert!(matches!(
            with(251.0, dead_cycles),
            Err(ConfigError::Damping { value, bound: 0.5, .. }) if (value - 0.502).abs() < 1e-12
        ));
    }
    for value in [0.0, -10.0, f64::NAN] {
        let error = with(value, 0).expect_err("no rate").to_string();
        assert_eq!(
            error,
            format!(
                "inertia-shaped null-space damping {value} 1/s; it must be above 0 and at most 1e9"
            )
        );
    }
}

/// K_d h = 6, K_p = 1e5 and K_I = 1e6 with a cycle of dead time were once accepted: a hold
/// on the ideal plant diverged.
#[test]
fn gains_that_the_cycle_cannot_carry_are_refused() {
    let with = |stiffness: f64, damping: f64, dead_cycles: u8| {
        let gains = TaskGains::uniform(stiffness, damping);
        let config = ControllerConfig {
            dead_cycles,
            null_space: NullSpace {
                damping: NullDamping::Inertia(10.0),
                ..two_level().null_space
            },
            ..with_tasks(&[Task::position(FLANGE, Axes::XYZ, gains)])
        };
        Controller::<f64>::new(&LWR_IV, &config).map(|_| ())
    };
    // Without dead time K_d h < 2 and K_p h < 2 K_d.
    for (stiffness, damping, allowed) in [
        (400.0, 999.0, true),
        (400.0, 1000.0, false),
        (400.0, 3000.0, false),
        (39_900.0, 40.0, true),
        (40_000.0, 40.0, false),
        (1e5, 40.0, false),
    ] {
        assert_eq!(
            with(stiffness, damping, 0).is_ok(),
            allowed,
            "{stiffness} {damping}"
        );
    }
    assert_eq!(
        with(1e5, 40.0, 0).expect_err("too stiff").to_string(),
        "level 1: task stiffness 100000 1/s2 and damping 40 1/s make the sampled loop unstable: \
         the cycle is 0.002 s; it must be below 0.000800 s"
    );
    for late in 0..=8 {
        assert!(with(400.0, 40.0, late).is_ok());
    }
    assert!(with(400.0, 500.0, 1).is_err() && with(400.0, 300.0, 8).is_err());
    let observing = |gain: f64, dead_cycles: u8| {
        let mut config = two_level();
        config.null_space.damping = NullDamping::Inertia(10.0);
        (config.dead_cycles, config.observer_gain[2]) = (dead_cycles, gain);
        Controller::<f64>::new(&LWR_IV, &config).map(|_| ())
    };
    assert!(observing(1e6, 0).is_ok() && observing(499.0, 1).is_ok());
    assert_eq!(
        observing(1e6, 1).expect_err("too fast").to_string(),
        "observer gain of joint 3 is 1000000 1/s; it must be above 0 and at most 500.0"
    );
}
