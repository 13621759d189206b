//! The change run: a task comes, both get softer, change places, the former second goes.

use arms::LWR_IV;
use controller_core::joint::Vector3;
use controller_core::{Controller, ControllerConfig, Reference, Target, Task, TaskGains, TaskSet};
use stratum_tests::config::{three_level, two_level};
use stratum_tests::oracle::closed_loop::{CASE_START, circle, posture};

use super::run::Run;
use cell::names::{MeasurementKind, NullStiffness, PlantKind};
use cell::scenario::{CHANGES, Scenario};
use hil_sim::controllers::{ControllerKind, TorqueLaw};
use hil_sim::experiment::Experiment;
use hil_sim::metrics::ChangeFigures;
use hil_sim::plant::PlantOptions;

fn run(name: &str, plant: PlantKind, measurement: MeasurementKind) -> Vec<ChangeFigures> {
    let text = CHANGES.iter().find(|(known, _)| *known == name);
    let scenario = Scenario::parse(text.expect("a scenario of changes").1).expect("valid");
    let options = PlantOptions::of(plant, &scenario.arm().parameters);
    let experiment = Experiment {
        scenario,
        plant,
        contacts: false,
        controller: ControllerKind::Torque(TorqueLaw::Hierarchical),
        null_stiffness: NullStiffness::Normal,
        measurement,
        seed: 1,
        options,
    };
    let controller = experiment.controller().expect("a controller");
    let summary = experiment
        .run(&controller, |_| Ok(()), |_| ())
        .expect("a run");
    assert!(summary.reason.is_none(), "{:?}", summary.reason);
    println!("{name}, {plant:?}, {measurement:?}");
    for change in &summary.changes {
        println!("  {change}");
    }
    assert_eq!(summary.changes.len(), 5);
    summary.changes
}

/// Largest step of each event \[Nm\], and largest error of level 1 while level 2 comes and while the
/// gains change \[mm\].
fn figures(changes: &[ChangeFigures]) -> ([f64; 5], f64) {
    let steps = [0, 1, 2, 3, 4].map(|event| changes[event].torque_step_nm);
    let error = |event: usize| changes[event].level_max[0].expect("level 1 is there");
    (steps, error(0).max(error(1)).max(error(2)))
}

#[test]
fn on_the_ideal_plant_nothing_steps_and_the_first_level_stays() {
    for (name, most_nm) in [("changing-tasks", 2.5), ("changing-tasks-in-conflict", 2.5)] {
        let (steps, error) = figures(&run(name, PlantKind::Ideal, MeasurementKind::Direct));
        assert!(
            steps.iter().all(|step| *step <= most_nm),
            "{name}: {steps:?}"
        );
        assert!(error <= 0.05, "{name}: {error}");
    }
}

/// What the torque does without a change on this plant, noise of its speeds, is below 1 Nm.
#[test]
fn on_the_realistic_plant_nothing_steps() {
    for name in ["changing-tasks", "changing-tasks-in-conflict"] {
        let (steps, _) = figures(&run(name, PlantKind::Realistic, MeasurementKind::Direct));
        assert!(steps.iter().all(|step| *step <= 2.5), "{name}: {steps:?}");
    }
}

/// The same changes at once, each by another controller from one cycle to the next: largest step of
/// the torque in the tenth of a second behind each \[Nm\]. What the first figures are held against.
fn at_once(wrist_by: [f64; 3]) -> [f64; 4] {
    let set = three_level().tasks;
    let [flange, wrist] = [0, 1].map(|slot| set.tasks()[slot]);
    let soft = |task: Task| Task {
        gains: TaskGains::uniform(100.0, 20.0),
        ..task
    };
    let start = posture(CASE_START);
    let made = |tasks: &[Task]| {
        let config = ControllerConfig {
            tasks: TaskSet::new(tasks).expect("tasks"),
            ..two_level()
        };
        Controller::<f64>::new(&LWR_IV, &config).expect("valid")
    };
    let mut run = Run::new(&LWR_IV, &two_level(), PlantKind::Ideal, start, 1);
    let origins = made(&[flange, wrist]).rest_reference(&start);
    let mut steps = [0.0; 4];
    let mut next = 0;
    for cycle in 0..6000 {
        let t_s = f64::from(cycle) * 0.002;
        let due = [2.0, 5.0, 7.0, 9.0];
        if next < 4 && t_s >= due[next] - 1e-9 {
            run.controller = match next {
                0 => made(&[flange, wrist]),
                1 => made(&[soft(flange), soft(wrist)]),
                2 => made(&[soft(wrist), soft(flange)]),
                _ => made(&[soft(flange)]),
            };
            run.state.follow_at_once();
            run.count_anew();
            next += 1;
        }
        let circle = match origins.targets()[0] {
            Target::Position { x, .. } => circle(0.04, 5.0).sample(&x, t_s),
            other => other,
        };
        let place = match origins.targets()[1] {
            Target::Position { x, .. } => Target::position(x + Vector3::from(wrist_by)),
            other => other,
        };
        let reference = match next {
            0 | 4 => Reference::new([circle], start),
            3 => Reference::new([place, circle], start),
            _ => Reference::new([circle, place], start),
        };
        let _ = run.cycle(&reference);
        if next > 0 && t_s < due[next - 1] + 0.1 {
            steps[next - 1] = run.step;
        }
    }
    steps
}

/// At once the torque steps; over half a second it does not.
#[test]
fn over_a_time_the_torque_steps_less_than_at_once() {
    for (name, by) in [
        ("changing-tasks", [0.0, 0.03, 0.0]),
        ("changing-tasks-in-conflict", [0.12, 0.0, 0.0]),
    ] {
        let [add, gains, order, remove] = at_once(by);
        println!("{name} at once: {add:.2} / {gains:.2} / {order:.2} / {remove:.2} Nm");
        let (steps, _) = figures(&run(name, PlantKind::Ideal, MeasurementKind::Direct));
        let [faded_add, faded_gains, _, faded_order, faded_remove] = steps;
        assert!(faded_add < add && faded_order < order, "{name}");
        assert!(faded_remove < remove, "{name}");
        // Without an error gains do nothing.
        assert!(faded_gains < gains.max(0.1), "{name}");
    }
}
