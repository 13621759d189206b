//! Control cycles for an instruction counter: `benches/instructions.sh` runs this
//! under callgrind, which counts each call of a function in `cases::stages` by itself.
//!
//! `count_step step` runs whole cycles in random and adversarial states (`quick`: a
//! few), the same of the FR3 in a tenth of them, cycles in which every reference jumps, and
//! cycles of 7, 9 and 12 rows, with all levels changing and without;
//! `count_step arms` a few cycles of every arm, `count_step stages` every stage alone,
//! `count_step resolver` the velocity-level resolver in the states of `step`. The order of the
//! calls is printed, one name per line.

#![cfg(not(target_os = "none"))]

#[path = "../benches/cases/mod.rs"]
mod cases;

use std::hint::black_box;

use arms::{FR3, LWR_IV, LWR_IV_DAMPING, LWR_IV_STIFFNESS};
use cases::stages::{resolve, stage, step};
use cases::{Case, Input, levels, levels_of, states};
use controller_core::arm::ArmParameters;
use controller_core::cycle::record::Recorder;
use controller_core::cycle::{self, Data};
use controller_core::fault::Status;
use controller_core::real::Real;
use controller_core::resolver::ResolverState;
use controller_core::{
    Axes, Change, Controller, ControllerConfig, Link, Measurement, NullSpace, Order, State, Target,
    Task, TaskGains, TaskSet,
};

/// What decides how long a cycle is: whether commands are limited near lost directions, whether a
/// level is released, whether the arm is bent for it, and the pivots of the projection.
fn path(status: &Status, data: &Data<impl Real>) -> String {
    let pivots = match status.pivots {
        0 => "idle".into(),
        pivots => format!("pivots-{pivots}"),
    };
    let way = if status.fault.is_some() {
        return "fault".into();
    } else if data.way_out.bends() {
        "bent-"
    } else if status.released.any() {
        "released-"
    } else if data.spectrum.limits_commands {
        "limited-"
    } else {
        ""
    };
    format!("{way}{pivots}")
}

/// Whole cycles: each state is preceded by one that is not counted apart, so that
/// the observer runs. A cycle must not end in a fault: that is another path.
fn steps<T: Real>(case: &Case<T>, inputs: &[Input]) {
    let mut recorder = Recorder::new();
    let mut state = State::new();
    for (index, input) in inputs.iter().enumerate() {
        let (measurement, reference) = case.typed(input);
        if state.fault().is_some() || index == 0 {
            state.reset();
            let _ = case.controller.step(&mut state, &measurement, &reference);
        }
        // References of random places are no motion: joining them is another path.
        state.follow_at_once();
        let step = step(
            black_box(&case.controller),
            black_box(&mut state),
            black_box(&mut recorder),
            black_box(&measurement),
            black_box(&reference),
        );
        println!("{} {}", case.name, path(&step.status, state.data()));
        black_box(step);
    }
}

/// The most that a reference adds: every level and the posture jump in one cycle.
fn joins<T: Real>(case: &Case<T>, inputs: &[Input]) {
    let mut recorder = Recorder::new();
    for input in inputs {
        let (measurement, _) = case.typed(input);
        let mut state = State::new();
        let mut reference = case.controller.rest_reference(&measurement.q);
        let _ = case.controller.step(&mut state, &measurement, &reference);
        for target in reference.targets_mut() {
            if let Target::Position { x, .. } = target {
                x.add_scalar_mut(T::from_f64(0.1));
            }
        }
        reference.posture.add_scalar_mut(T::from_f64(0.3));
        let step = step(
            black_box(&case.controller),
            black_box(&mut state),
            black_box(&mut recorder),
            black_box(&measurement),
            black_box(&reference),
        );
        let joining = step.status.joining.0.count_ones() as usize;
        let all = joining == case.controller.level_count() + 1;
        println!("{} {}", case.name, if all { "joining" } else { "fault" });
        black_box(step);
    }
}

/// The LWR with a pose above the elbow, and with 12 rows above the wrist: so many rows, 7, 9 or
/// 12, and no resolver. The levels in reverse are another order.
fn with_rows<T: Real>(rows: usize) -> Controller<T> {
    let gains = TaskGains::uniform(400.0, 40.0);
    let point = |name| LWR_IV.point(name).expect("a point of the arm");
    let elbow = if rows > 7 { Axes::XYZ } else { Axes::X };
    let tasks = [
        Task::position(LWR_IV.flange_point(), Axes::XYZ, gains),
        Task::orientation(Link::L7.frame(), Axes::XYZ, gains),
        Task::position(point("elbow"), elbow, gains),
        Task::position(point("wrist"), Axes::XYZ, gains),
    ];
    let used = if rows > 9 { 4 } else { 3 };
    let config = ControllerConfig {
        tasks: TaskSet::new(&tasks[..used]).expect("valid tasks"),
        null_space: NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING),
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
    Controller::new(&LWR_IV, &config).expect("a valid configuration")
}

/// Cycles with so many rows, and the first of them in which all levels are on their way to the
/// reverse order.
fn rows<T: Real>(count: usize, inputs: &[Input]) {
    let controller = with_rows::<T>(count);
    let mut recorder = Recorder::new();
    let slots: Vec<_> = (0..controller.level_count()).rev().collect();
    let order = Change::Reorder(Order::new(&slots).expect("each once"));
    let transition = controller.transition(&order, 0.5).expect("a change");
    for input in inputs {
        let q = input.q.map(T::from_f64).into();
        let measurement = Measurement {
            q,
            dq: input.dq.map(T::from_f64).into(),
            interval_s: T::from_f64(input.interval_s),
        };
        let reference = controller.rest_reference(&q);
        let mut state = State::new();
        let _ = controller.step(&mut state, &measurement, &reference);
        for what in ["rows", "changing"] {
            if what == "changing" {
                controller
                    .begin(&mut state, &transition)
                    .expect("a change of these tasks");
            }
            let step = step(
                black_box(&controller),
                black_box(&mut state),
                black_box(&mut recorder),
                black_box(&measurement),
                black_box(&reference),
            );
            let what = if step.status.fault.is_some() {
                "fault"
            } else {
                what
            };
            println!("{count}-rows-{} {what}", std::any::type_name::<T>());
            black_box(step);
        }
    }
}

fn stages<T: Real>(case: &Case<T>, inputs: &[Input]) {
    let mut data = Data::new();
    for input in inputs {
        let (measurement, reference) = case.typed(input);
        let input = cycle::Input {
            measurement: &measurement,
            reference: &reference,
        };
        // The observer runs from the second cycle on.
        case.controller.evaluate(&input, &mut data);
        for (name, run) in Controller::<T>::STAGES {
            stage(
                black_box(run),
                black_box(&case.controller),
                black_box(&input),
                black_box(&mut data),
            );
            println!("{} {}", case.name, name.text().replace(' ', "_"));
        }
    }
}

fn resolutions<T: Real>(case: &Case<T>, inputs: &[Input]) {
    for input in inputs {
        let (measurement, reference) = case.typed(input);
        let mut state = ResolverState::new(measurement.q);
        state.follow_at_once();
        let resolution = resolve(
            black_box(&case.resolver),
            black_box(&mut state),
            black_box(&measurement),
            black_box(&reference),
        );
        let fault = resolution.status.fault.is_some();
        println!("{} {}", case.name, if fault { "fault" } else { "resolver" });
        black_box(resolution);
    }
}

/// Whole cycles of an arm with two and three levels in both precisions, in every `nth` state.
fn steps_of(arm: &ArmParameters, nth: usize) {
    let inputs: Vec<_> = states(arm).into_iter().step_by(nth).collect();
    steps(&levels_of::<f64>(arm, 2), &inputs);
    steps(&levels_of::<f64>(arm, 3), &inputs);
    steps(&levels_of::<f32>(arm, 2), &inputs);
    steps(&levels_of::<f32>(arm, 3), &inputs);
}

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    if wanted == "stages" {
        let inputs = &states(&LWR_IV)[..16];
        stages(&levels::<f64>(2), inputs);
        stages(&levels::<f64>(3), inputs);
        stages(&levels::<f32>(2), inputs);
        stages(&levels::<f32>(3), inputs);
    } else if wanted == "resolver" {
        let inputs = states(&LWR_IV);
        resolutions(&levels::<f64>(2), &inputs);
        resolutions(&levels::<f64>(3), &inputs);
        resolutions(&levels::<f32>(2), &inputs);
        resolutions(&levels::<f32>(3), &inputs);
    } else if wanted == "arms" {
        for arm in arms::ALL {
            steps_of(arm, 100);
        }
    } else {
        let quick = wanted == "quick";
        steps_of(&LWR_IV, if quick { 100 } else { 1 });
        steps_of(&FR3, if quick { 100 } else { 10 });
        let some = &states(&LWR_IV)[..16];
        joins(&levels::<f64>(2), some);
        joins(&levels::<f64>(3), some);
        joins(&levels::<f32>(2), some);
        joins(&levels::<f32>(3), some);
        for count in [7, 9, 12] {
            rows::<f64>(count, some);
            rows::<f32>(count, some);
        }
    }
}
