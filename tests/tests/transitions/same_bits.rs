//! A task that is not there is not there: every bit of the torque is that of a controller that
//! never heard of it.

use arms::LWR_IV;
use cell::names::PlantKind;
use controller_core::joint::JointVector;
use controller_core::{Capacity, Change, Controller, ControllerConfig, State, TaskSet};
use stratum_tests::config::{three_level, two_level};
use stratum_tests::oracle::closed_loop::{TWO_LEVEL_START, posture};

use super::run::{CYCLE_S, Run, on_circle};

fn config(tasks: TaskSet) -> ControllerConfig {
    ControllerConfig {
        tasks,
        ..two_level()
    }
}

fn bits(torque: &JointVector<f64>) -> [u64; 7] {
    torque.map(f64::to_bits).into()
}

/// Room and absent tasks change nothing.
#[test]
fn room_for_tasks_changes_no_bit() {
    let alone = two_level().tasks;
    let with_room = (alone.with_capacity(Capacity {
        levels: 7,
        rows: 12,
    }))
    .expect("room");
    let absent = three_level().tasks.without(1);
    for other in [with_room, absent] {
        let start = posture(TWO_LEVEL_START);
        let mut run = Run::new(&LWR_IV, &config(alone), PlantKind::Ideal, start, 1);
        let controller = Controller::new(&LWR_IV, &config(other)).expect("valid");
        let mut state = State::new();
        let origin = run.controller.rest_reference(&start);
        let mut longer = controller.rest_reference(&start);
        for _ in 0..1000 {
            let mut reference = origin.clone();
            reference.targets_mut()[0] = on_circle(&origin.targets()[0], run.t_s());
            longer.targets_mut()[0] = reference.targets()[0];
            let measurement = run.measurement();
            let other = controller.step(&mut state, &measurement, &longer);
            let step = run
                .controller
                .step(&mut run.state, &measurement, &reference);
            assert_eq!(bits(&step.torque), bits(&other.torque));
            run.act(&step);
        }
    }
}

/// Behind the change that takes a task away nothing is left of it.
#[test]
fn a_task_that_went_leaves_no_bit() {
    let two = three_level().tasks;
    let start = posture(TWO_LEVEL_START);
    let mut run = Run::new(&LWR_IV, &config(two), PlantKind::Ideal, start, 1);
    let alone = two_level().tasks;
    let controller = Controller::new(&LWR_IV, &config(alone)).expect("valid");
    let mut state = State::new();
    let origin = run.controller.rest_reference(&start);
    let mut last: Option<JointVector<f64>> = None;
    let mut compared = 0;
    for cycle in 0..2500 {
        if cycle == 1000 {
            run.begin(&Change::Remove { slot: 1 });
        }
        let mut reference = origin.clone();
        reference.targets_mut()[0] = on_circle(&origin.targets()[0], run.t_s());
        let mut shorter = controller.rest_reference(&start);
        shorter.targets_mut()[0] = reference.targets()[0];
        let measurement = run.measurement();
        // Beside it, told what acts: its observer sees the same arm, but rounds otherwise until
        // both start anew.
        if cycle == 1251 {
            state.reset();
            run.state.reset();
        } else if let Some(torque) = last.filter(|_| cycle < 1251) {
            state.set_applied_torque(&torque);
        }
        let other = controller.step(&mut state, &measurement, &shorter);
        let step = run
            .controller
            .step(&mut run.state, &measurement, &reference);
        if cycle > 1250 {
            assert!(!step.status.changing.any(), "cycle {cycle}");
            assert_eq!(bits(&step.torque), bits(&other.torque), "cycle {cycle}");
            compared += 1;
        }
        last = Some(step.torque);
        run.act(&step);
    }
    assert!(f64::from(compared) * CYCLE_S > 2.4, "{compared} cycles");
}
