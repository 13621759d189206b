//! A cycle and its stages, each behind a call of its own: callgrind counts these
//! functions by name, and the timer cannot see through them.

use std::hint::black_box;

use super::{Case, Input};
use controller_core::config::ControllerConfig;
use controller_core::controller::{Controller, ControllerState, Step};
use controller_core::dynamics::Dynamics;
use controller_core::hierarchy::Hierarchy;
use controller_core::joint::{JointState, JointVector, zeros};
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

/// The stages in the order of the cycle; one is also inside another.
pub const STAGES: [&str; 11] = [
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
];

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

/// One cycle taken apart: what every stage reads.
pub struct Stages<T: Real> {
    pub joints: JointState<T>,
    pub reference: Reference<T>,
    pub kinematics: Kinematics<T>,
    pub dynamics: Dynamics<T>,
    pub residual: JointVector<T>,
    pub rows: TaskRows<T>,
    pub hierarchy: Hierarchy<T>,
    pub motion: TaskMotion<T>,
    pub command: Command<T>,
    pub demand: TorqueDemand<T>,
    pub torque: JointVector<T>,
}

impl<T: Real> Stages<T> {
    /// Calls every function of [`STAGES`] once, in this order.
    pub fn run(case: &Case<T>, observer: &mut Observer<T>, input: &Input) -> Self {
        let model = black_box(&case.model);
        let config = black_box(&case.config);
        let (_, reference) = black_box(case.typed(input));
        let joints = black_box(case.joints(input));
        let kinematics = black_box(kinematics(model, &joints));
        let dynamics = black_box(dynamics(model, &kinematics, &joints));
        let _ = black_box(cholesky_inside_dynamics(&dynamics));
        if !observer.started {
            observer.update(&config.observer_gain, config.cycle_s, &dynamics.momentum);
        }
        let residual = observer_update(observer, config, &dynamics.momentum);
        let rows = black_box(task_rows(config, &reference, &kinematics, &joints));
        let hierarchy = black_box(hierarchy(&rows, &dynamics));
        let motion = black_box(motion(&dynamics, &hierarchy, &joints));
        let parts = (&dynamics, &rows, &hierarchy, &motion);
        let command = black_box(command(config, parts, &joints, &reference.posture));
        let zero = zeros();
        let mut stages = Self {
            joints,
            reference,
            kinematics,
            dynamics,
            residual,
            rows,
            hierarchy,
            motion,
            command,
            demand: TorqueDemand(zero),
            torque: zero,
        };
        stages.demand = demand(black_box(&stages.cycle()));
        stages.torque = limits(black_box(&stages.demand), model.torque_limit());
        observer_apply(
            black_box(observer),
            &stages.dynamics,
            &stages.joints,
            &stages.torque,
        );
        stages
    }

    /// What the law reads.
    pub fn cycle(&self) -> Cycle<'_, T> {
        Cycle {
            state: &self.joints,
            kinematics: &self.kinematics,
            dynamics: &self.dynamics,
            rows: &self.rows,
            hierarchy: &self.hierarchy,
            motion: &self.motion,
            posture: &self.reference.posture,
            command: &self.command,
            residual: &self.residual,
        }
    }
}
