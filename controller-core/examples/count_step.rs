//! Control cycles for an instruction counter: `benches/instructions.sh` runs this
//! under callgrind, which counts each call of a function in `counted` by itself.
//!
//! `count_step step` runs whole cycles in random and adversarial states (`quick`: a
//! few), `count_step stages` every stage of the three-level cycle. The order of the
//! calls is printed, one name per line.

#![cfg(not(target_os = "none"))]

#[path = "../benches/cases/mod.rs"]
mod cases;

use std::hint::black_box;

use cases::{Case, Input, levels, states};
use controller_core::controller::ControllerState;
use controller_core::law::Cycle;
use controller_core::observer::Observer;
use controller_core::real::Real;
use controller_core::record::Recorder;

/// What callgrind counts: every function here is one number.
mod counted {
    use controller_core::config::ControllerConfig;
    use controller_core::controller::{Controller, ControllerState, Step};
    use controller_core::dynamics::Dynamics;
    use controller_core::hierarchy::Hierarchy;
    use controller_core::joint::{JointState, JointVector};
    use controller_core::kinematics::Kinematics;
    use controller_core::law::{Command, Cycle, TaskMotion, TorqueDemand};
    use controller_core::limits::TorqueCommand;
    use controller_core::linalg::Cholesky;
    use controller_core::measurement::{Measurement, Reference};
    use controller_core::model::ArmModel;
    use controller_core::observer::Observer;
    use controller_core::real::Real;
    use controller_core::record::Recorder;
    use controller_core::task::TaskRows;

    #[inline(never)]
    pub fn step<T: Real>(
        controller: &Controller<T>,
        state: &mut ControllerState<T>,
        recorder: &mut Recorder<T, 64>,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
    ) -> Step<T> {
        let step = controller.step(state, measurement, reference);
        recorder.push(measurement, &step);
        step
    }

    #[inline(never)]
    pub fn kinematics<T: Real>(model: &ArmModel<T>, joints: &JointState<T>) -> Kinematics<T> {
        Kinematics::new(model, joints)
    }

    #[inline(never)]
    pub fn dynamics<T: Real>(
        model: &ArmModel<T>,
        kinematics: &Kinematics<T>,
        joints: &JointState<T>,
    ) -> Dynamics<T> {
        Dynamics::new(model, kinematics, joints)
    }

    #[inline(never)]
    pub fn cholesky_inside_dynamics<T: Real>(dynamics: &Dynamics<T>) -> Cholesky<T> {
        Cholesky::new(&dynamics.mass_matrix)
    }

    #[inline(never)]
    pub fn task_rows<T: Real>(
        config: &ControllerConfig<T>,
        reference: &Reference<T>,
        kinematics: &Kinematics<T>,
        joints: &JointState<T>,
    ) -> TaskRows<T> {
        TaskRows::new(&config.tasks, &reference.tasks, kinematics, joints)
    }

    #[inline(never)]
    pub fn hierarchy<T: Real>(rows: &TaskRows<T>, dynamics: &Dynamics<T>) -> Hierarchy<T> {
        Hierarchy::new(rows, &dynamics.cholesky)
    }

    #[inline(never)]
    pub fn motion<T: Real>(
        dynamics: &Dynamics<T>,
        hierarchy: &Hierarchy<T>,
        joints: &JointState<T>,
    ) -> TaskMotion<T> {
        TaskMotion::new(dynamics, hierarchy, joints)
    }

    #[inline(never)]
    pub fn command<T: Real>(
        config: &ControllerConfig<T>,
        parts: (&Dynamics<T>, &TaskRows<T>, &Hierarchy<T>, &TaskMotion<T>),
        joints: &JointState<T>,
        posture: &JointVector<T>,
    ) -> Command<T> {
        let (dynamics, rows, hierarchy, motion) = parts;
        let null_space = &config.null_space;
        Command::new(
            null_space, dynamics, rows, hierarchy, motion, joints, posture,
        )
    }

    #[inline(never)]
    pub fn demand<T: Real>(cycle: &Cycle<'_, T>) -> TorqueDemand<T> {
        TorqueDemand::hierarchical(cycle)
    }

    #[inline(never)]
    pub fn limits<T: Real>(demand: &TorqueDemand<T>, limit: &JointVector<T>) -> JointVector<T> {
        match TorqueCommand::new(demand, limit) {
            Ok(command) => command.torque,
            Err(_) => *limit,
        }
    }

    #[inline(never)]
    pub fn observer_update<T: Real>(
        observer: &mut Observer<T>,
        config: &ControllerConfig<T>,
        momentum: &JointVector<T>,
    ) -> JointVector<T> {
        observer.update(&config.observer_gain, config.cycle_s, momentum)
    }

    #[inline(never)]
    pub fn observer_apply<T: Real>(
        observer: &mut Observer<T>,
        dynamics: &Dynamics<T>,
        joints: &JointState<T>,
        torque: &JointVector<T>,
    ) {
        observer.apply(dynamics, joints, torque);
    }
}

/// Whole cycles: each state is preceded by one that is not counted apart, so that
/// the observer runs. A cycle must not end in a fault: that is another path.
fn steps<T: Real>(case: &Case<T>, inputs: &[Input]) {
    let mut recorder = Recorder::new();
    let mut state = ControllerState::new();
    for (index, input) in inputs.iter().enumerate() {
        let (measurement, reference) = case.typed(input);
        if state.fault().is_some() || index == 0 {
            state.reset();
            let _ = case.controller.step(&mut state, &measurement, &reference);
        }
        let step = counted::step(
            black_box(&case.controller),
            black_box(&mut state),
            black_box(&mut recorder),
            black_box(&measurement),
            black_box(&reference),
        );
        let kind = if step.status.fault.is_none() {
            input.kind
        } else {
            "fault"
        };
        println!("{} {kind}", case.name);
        black_box(step);
    }
}

fn stages<T: Real>(case: &Case<T>, inputs: &[Input]) {
    let model = black_box(&case.model);
    let config = black_box(&case.config);
    let mut observer = Observer::new();
    for (index, input) in inputs.iter().enumerate() {
        let (_, reference) = black_box(case.typed(input));
        let joints = black_box(case.joints(input));
        let kinematics = black_box(counted::kinematics(model, &joints));
        let dynamics = black_box(counted::dynamics(model, &kinematics, &joints));
        let _ = black_box(counted::cholesky_inside_dynamics(&dynamics));
        if index == 0 {
            observer.update(&config.observer_gain, config.cycle_s, &dynamics.momentum);
        }
        let residual = counted::observer_update(&mut observer, config, &dynamics.momentum);
        let rows = black_box(counted::task_rows(config, &reference, &kinematics, &joints));
        let hierarchy = black_box(counted::hierarchy(&rows, &dynamics));
        let motion = black_box(counted::motion(&dynamics, &hierarchy, &joints));
        let posture = &reference.posture;
        let parts = (&dynamics, &rows, &hierarchy, &motion);
        let command = black_box(counted::command(config, parts, &joints, posture));
        let demand = counted::demand(black_box(&Cycle {
            state: &joints,
            kinematics: &kinematics,
            dynamics: &dynamics,
            rows: &rows,
            hierarchy: &hierarchy,
            motion: &motion,
            posture,
            command: &command,
            residual: &residual,
        }));
        let torque = counted::limits(black_box(&demand), model.torque_limit());
        counted::observer_apply(black_box(&mut observer), &dynamics, &joints, &torque);
        for stage in [
            "kinematics",
            "dynamics",
            "cholesky_inside_dynamics",
            "observer_update",
            "task_rows",
            "hierarchy",
            "motion",
            "command",
            "demand",
            "limits",
            "observer_apply",
        ] {
            println!("{} {stage}", case.name);
        }
    }
}

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    if wanted == "stages" {
        let inputs = &states()[..16];
        stages(&levels::<f64>(3), inputs);

        stages(&levels::<f32>(3), inputs);
    } else {
        let mut inputs = states();
        if wanted == "quick" {
            inputs.truncate(20);
        }
        steps(&levels::<f64>(2), &inputs);
        steps(&levels::<f64>(3), &inputs);
        steps(&levels::<f32>(2), &inputs);
        steps(&levels::<f32>(3), &inputs);
    }
}
