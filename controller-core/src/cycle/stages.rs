//! The stages of a cycle: one function per result, in order. This list is the one place
//! where the cycle is composed.

use super::controller::Controller;
use super::data::{Data, Input};
use crate::arm::kinematics::Kinematics;
use crate::joint::{DOF, JointState, all_finite};
use crate::law::allocation::TorqueLimits;
use crate::law::control::TorqueDemand;
use crate::law::motion::MotionSplit;
use crate::law::null_space::Posture;
use crate::real::Real;

/// The stages by name, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub enum StageName {
    /// [`Data::joints`] from the measurement.
    JointState,
    /// [`Data::kinematics`].
    Kinematics,
    /// [`Data::dynamics`].
    Dynamics,
    /// [`Data::holding_torque`].
    HoldingTorque,
    /// The residual in [`Data::observer`].
    Observer,
    /// [`Data::followed`].
    Followed,
    /// [`Data::rows`].
    TaskRows,
    /// [`Data::hierarchy`].
    Hierarchy,
    /// [`Data::motion`].
    MotionSplit,
    /// [`Data::posture`].
    Posture,
    /// [`Data::control`].
    Control,
    /// [`Data::demand`]; other laws take the place of this stage.
    TorqueDemand,
    /// [`Data::allocation`].
    Allocation,
    /// The input u that [`Data::observer`] keeps for the next cycle.
    ObserverInput,
}

impl StageName {
    /// The name in tables.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::JointState => "joint state",
            Self::Kinematics => "kinematics",
            Self::Dynamics => "dynamics",
            Self::HoldingTorque => "holding torque",
            Self::Observer => "observer",
            Self::Followed => "followed",
            Self::TaskRows => "task rows",
            Self::Hierarchy => "hierarchy",
            Self::MotionSplit => "motion split",
            Self::Posture => "posture",
            Self::Control => "control",
            Self::TorqueDemand => "torque demand",
            Self::Allocation => "allocation",
            Self::ObserverInput => "observer input",
        }
    }
}

/// A stage: reads results above its own, writes its own.
pub type Run<T> = fn(&Controller<T>, &Input<'_, T>, &mut Data<T>);

/// Number of stages.
pub const STAGE_COUNT: usize = 14;

impl<T: Real> Controller<T> {
    /// The cycle.
    pub const STAGES: [(StageName, Run<T>); STAGE_COUNT] = [
        (StageName::JointState, joint_state),
        (StageName::Kinematics, kinematics),
        (StageName::Dynamics, dynamics),
        (StageName::HoldingTorque, holding_torque),
        (StageName::Observer, observer),
        (StageName::Followed, followed),
        (StageName::TaskRows, task_rows),
        (StageName::Hierarchy, hierarchy),
        (StageName::MotionSplit, motion_split),
        (StageName::Posture, posture),
        (StageName::Control, control),
        (StageName::TorqueDemand, torque_demand),
        (StageName::Allocation, allocation),
        (StageName::ObserverInput, observer_input),
    ];
}

fn joint_state<T: Real>(_: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    data.joints = JointState {
        q: input.measurement.q,
        dq: input.measurement.dq,
    };
}

fn kinematics<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    set_kinematics(controller, &data.joints, &mut data.kinematics);
}

/// Behind a call: it is in the flash once, for the cycle and for references.
#[inline(never)]
fn set_kinematics<T: Real>(
    controller: &Controller<T>,
    joints: &JointState<T>,
    kinematics: &mut Kinematics<T>,
) {
    kinematics.update(&controller.arm, joints);
}

/// The result of that stage alone, for references: they need no more of a cycle.
pub(super) fn kinematics_at<T: Real>(
    controller: &Controller<T>,
    joints: &JointState<T>,
) -> Kinematics<T> {
    let mut kinematics = Kinematics::new();
    set_kinematics(controller, joints, &mut kinematics);
    kinematics
}

#[inline(never)]
fn dynamics<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.dynamics
        .update(&controller.arm, &data.kinematics, &data.joints);
}

fn holding_torque<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    let (gravity, limit) = (&data.dynamics.gravity, controller.arm.torque_limit());
    if all_finite(gravity) {
        for i in 0..DOF {
            data.holding_torque[i] = gravity[i].limited(-limit[i], limit[i]);
        }
    }
}

fn observer<T: Real>(controller: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    data.observer.update(
        &controller.observer_gain,
        input.measurement.interval_s,
        &data.dynamics.momentum,
    );
}

#[inline(never)]
fn followed<T: Real>(controller: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    data.followed.update(
        &controller.levels,
        input.reference,
        &data.kinematics,
        &data.joints.q,
        input.measurement.interval_s,
    );
}

#[inline(never)]
fn task_rows<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.rows.update(
        &controller.levels,
        &data.followed,
        &data.kinematics,
        &data.joints,
    );
}

#[inline(never)]
fn hierarchy<T: Real>(_: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.hierarchy.update(&data.rows, &data.dynamics.cholesky);
}

#[inline(never)]
fn motion_split<T: Real>(_: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.motion
        .update(&data.dynamics, &data.hierarchy, &data.joints);
}

fn posture<T: Real>(controller: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    let start = data.followed.posture();
    let integrated = match controller.compliance.posture {
        Posture::Constant => None,
        Posture::IntegralCoupled => Some(data.motion.task_velocity),
        Posture::IntegralUncoupled => Some(MotionSplit::uncoupled_task_velocity(
            &data.dynamics,
            &data.rows,
            &data.hierarchy,
            &data.joints,
        )),
    };
    let interval_s = input.measurement.interval_s;
    data.posture = match &integrated {
        None => *start,
        Some(rate) => data.posture_integral.advance(start, rate, interval_s),
    };
    if let Some(offset) = data.followed.posture_offset() {
        data.posture += offset;
    }
}

#[inline(never)]
fn control<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.control.update(
        &controller.compliance,
        &data.dynamics,
        &data.rows,
        &data.hierarchy,
        &data.motion,
        &(data.posture - data.joints.q),
    );
}

/// The product's law.
#[inline(never)]
pub(super) fn torque_demand<T: Real>(_: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.demand = TorqueDemand::compensating(
        &data.dynamics,
        &data.hierarchy,
        &data.control,
        data.residual(),
    );
}

fn allocation<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    let limits = TorqueLimits {
        limit: controller.arm.torque_limit(),
        step: &controller.torque_step,
    };
    data.allocation.update(&data.demand, &limits);
}

fn observer_input<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    let (torque, before) = (&data.allocation.torque, &data.holding_torque);
    let acting = data.delay.send(controller.dead_cycles, torque, before);
    data.observer
        .set_input(&data.dynamics, &data.joints, &acting);
}
