//! The stages of a cycle: one function per result, in order. This list is the one place
//! where the cycle is composed.

pub use super::controller::Run;
use super::controller::{Controller, Law};
use super::data::{Data, Input};
use crate::arm::ArmModel;
use crate::arm::dynamics::Dynamics;
use crate::arm::kinematics::Kinematics;
use crate::joint::{DOF, JointState, all_finite};
use crate::law::allocation::TorqueLimits;
use crate::law::control::TorqueDemand;
use crate::law::limits::projection::{Projection, Wished};
use crate::law::limits::way_out::Straight;
use crate::law::limits::wish::{Ask, Wish};
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
    /// [`Data::tasks`].
    Tasks,
    /// [`Data::followed`].
    Followed,
    /// [`Data::rows`].
    TaskRows,
    /// [`Data::hierarchy`], of the exact law.
    Hierarchy,
    /// [`Data::spectrum`], of the law within limits.
    Spectrum,
    /// [`Data::motion`].
    MotionSplit,
    /// [`Data::posture`].
    Posture,
    /// [`Data::control`], of the exact law.
    Control,
    /// [`Data::wish`], of the law within limits.
    Wish,
    /// [`Data::bounds`], of the law within limits.
    Bounds,
    /// [`Data::projection`], of the law within limits.
    Projection,
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
            Self::Tasks => "tasks",
            Self::Followed => "followed",
            Self::TaskRows => "task rows",
            Self::Hierarchy => "hierarchy",
            Self::Spectrum => "spectrum",
            Self::MotionSplit => "motion split",
            Self::Posture => "posture",
            Self::Control => "control",
            Self::Wish => "wish",
            Self::Bounds => "bounds",
            Self::Projection => "projection",
            Self::TorqueDemand => "torque demand",
            Self::Allocation => "allocation",
            Self::ObserverInput => "observer input",
        }
    }
}

/// A stage with its name.
pub type Stage<T> = (StageName, Run<T>);

/// Number of stages of the law within limits.
pub const STAGE_COUNT: usize = 17;

/// Number of stages of the exact law.
pub const EXACT_STAGE_COUNT: usize = 15;

impl<T: Real> Controller<T> {
    /// Before the law: what is, and what is followed.
    pub(super) const OBSERVED: [Stage<T>; 8] = [
        (StageName::JointState, joint_state),
        (StageName::Kinematics, kinematics),
        (StageName::Dynamics, dynamics),
        (StageName::HoldingTorque, holding_torque),
        (StageName::Observer, observer),
        (StageName::Tasks, tasks),
        (StageName::Followed, followed),
        (StageName::TaskRows, task_rows),
    ];

    /// The law within limits.
    const WITHIN_LIMITS: [Stage<T>; 7] = [
        (StageName::Spectrum, spectrum),
        (StageName::MotionSplit, spectral_motion),
        (StageName::Posture, constant_posture),
        (StageName::Wish, wish),
        (StageName::Bounds, bounds),
        (StageName::Projection, projection),
        (StageName::TorqueDemand, projected_demand),
    ];

    /// The exact law but for its last stage, which other laws may take the place of.
    pub(super) const EXACT: [Stage<T>; 4] = [
        (StageName::Hierarchy, hierarchy),
        (StageName::MotionSplit, motion_split),
        (StageName::Posture, posture),
        (StageName::Control, control),
    ];

    /// Behind the law: what reaches the motors, and what is remembered of it.
    pub(super) const ALLOWED: [Stage<T>; 2] = [
        (StageName::Allocation, allocation),
        (StageName::ObserverInput, observer_input),
    ];

    /// The cycle with the law within limits.
    pub const STAGES: [Stage<T>; STAGE_COUNT] = {
        let [a, b, c, d, e, f, g, h] = Self::OBSERVED;
        let [i, j, k, l, m, n, o] = Self::WITHIN_LIMITS;
        let [p, q] = Self::ALLOWED;
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q]
    };

    /// The cycle with the exact law.
    pub const EXACT_STAGES: [Stage<T>; EXACT_STAGE_COUNT] = {
        let [a, b, c, d, e, f, g, h] = Self::OBSERVED;
        let [i, j, k, l] = Self::EXACT;
        let [p, q] = Self::ALLOWED;
        let demand: Stage<T> = (StageName::TorqueDemand, torque_demand);
        [a, b, c, d, e, f, g, h, i, j, k, l, demand, p, q]
    };
}

/// The law within limits, for a controller.
pub(super) fn within_limits<T: Real>() -> Law<T> {
    Law {
        limits: true,
        run: law_within_limits,
    }
}

/// The exact law, for a controller.
pub(super) fn exact<T: Real>() -> Law<T> {
    Law {
        limits: false,
        run: exact_law,
    }
}

/// The law of a controller. Behind a call: the one indirect call of a cycle has a name, by which
/// `cargo bench-m7` knows where it leads.
#[inline(never)]
pub(super) fn run_law<T: Real>(
    controller: &Controller<T>,
    input: &Input<'_, T>,
    data: &mut Data<T>,
) {
    (controller.law.run)(controller, input, data);
}

#[inline(never)]
fn law_within_limits<T: Real>(
    controller: &Controller<T>,
    input: &Input<'_, T>,
    data: &mut Data<T>,
) {
    for (_, run) in Controller::WITHIN_LIMITS {
        run(controller, input, data);
    }
}

#[inline(never)]
fn exact_law<T: Real>(controller: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    for (_, run) in Controller::EXACT {
        run(controller, input, data);
    }
    torque_demand(controller, input, data);
}

fn joint_state<T: Real>(_: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    // One by one: both together are copied by a call.
    data.joints.q = input.measurement.q;
    data.joints.dq = input.measurement.dq;
}

fn kinematics<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    set_kinematics(&controller.arm, &data.joints, &mut data.kinematics);
}

/// Behind a call: it is in the flash once, for the cycle and for references.
#[inline(never)]
fn set_kinematics<T: Real>(
    arm: &ArmModel<T>,
    joints: &JointState<T>,
    kinematics: &mut Kinematics<T>,
) {
    kinematics.update(arm, joints);
}

/// The result of that stage alone, for references: they need no more of a cycle.
pub(super) fn kinematics_at<T: Real>(
    controller: &Controller<T>,
    joints: &JointState<T>,
) -> Kinematics<T> {
    let mut kinematics = Kinematics::new();
    set_kinematics(&controller.arm, joints, &mut kinematics);
    kinematics
}

fn dynamics<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    set_dynamics(
        &controller.arm,
        &data.kinematics,
        &data.joints,
        &mut data.dynamics,
    );
}

#[inline(never)]
fn set_dynamics<T: Real>(
    arm: &ArmModel<T>,
    kinematics: &Kinematics<T>,
    joints: &JointState<T>,
    dynamics: &mut Dynamics<T>,
) {
    dynamics.update(arm, kinematics, joints);
}

fn holding_torque<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    let (gravity, limit) = (&data.dynamics.gravity, controller.arm.torque_limit());
    if all_finite(gravity) {
        for i in 0..DOF {
            data.holding_torque[i] = gravity[i].most(-limit[i]).least(limit[i]);
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

fn tasks<T: Real>(controller: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    let ages_s = input.reference.ages_s();
    data.tasks.watch(&controller.own(), ages_s, &data.followed);
    if data.tasks.changing().any() {
        let interval_s = input.measurement.interval_s;
        let met = data.tasks.advance(interval_s, &data.spectrum);
        data.forget_levels(met);
    }
}

#[inline(never)]
fn followed<T: Real>(controller: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    data.followed.update(
        data.tasks.levels(&controller.levels),
        input.reference,
        data.tasks.stale(),
        &data.kinematics,
        &data.joints.q,
        input.measurement.interval_s,
    );
}

fn task_rows<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.rows.update(
        data.tasks.levels(&controller.levels),
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

/// Of the law within limits, which has no integrated one.
fn constant_posture<T: Real>(_: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.posture = *data.followed.posture();
    if let Some(offset) = data.followed.posture_offset() {
        data.posture += offset;
    }
}

#[inline(never)]
fn control<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.control.update(
        data.tasks.compliance(&controller.compliance),
        &data.dynamics,
        &data.rows,
        &data.hierarchy,
        &data.motion,
        &(data.posture - data.joints.q),
    );
}

fn spectrum<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    let levels = data.tasks.levels(&controller.levels);
    data.spectrum
        .update(levels, &data.rows, &data.dynamics.cholesky);
}

fn spectral_motion<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.whitened_motion.update(
        &mut data.motion,
        data.tasks.levels(&controller.levels),
        &data.dynamics.cholesky,
        &data.spectrum,
        &data.joints.dq,
    );
}

#[inline(never)]
fn wish<T: Real>(controller: &Controller<T>, input: &Input<'_, T>, data: &mut Data<T>) {
    null_force(controller, input, data);
    way_out(controller, input, data);
    with_ask(controller, data, Wish::update);
}

/// f - D n.
#[inline(always)]
pub(super) fn null_force<T: Real>(
    controller: &Controller<T>,
    _: &Input<'_, T>,
    data: &mut Data<T>,
) {
    data.control.null_force = data.tasks.compliance(&controller.compliance).force(
        &data.dynamics,
        &data.rows,
        &data.motion,
        &(data.posture - data.joints.q),
    );
}

#[inline(always)]
pub(super) fn way_out<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.way_out.update(&Straight {
        levels: data.tasks.levels(&controller.levels),
        bounds: &controller.bounds,
        kinematics: &data.kinematics,
        dynamics: &data.dynamics,
        rows: &data.rows,
        spectrum: &data.spectrum,
        motion: &data.whitened_motion,
        q: &data.joints.q,
        null_force: &data.control.null_force,
        residual: &data.observer.residual,
        posture: &data.posture,
    });
}

/// Runs what is about the wish on what it is made from.
#[inline(always)]
pub(super) fn with_ask<T: Real>(
    controller: &Controller<T>,
    data: &mut Data<T>,
    run: impl FnOnce(&mut Wish<T>, &Ask<'_, T>),
) {
    let ask = Ask {
        levels: data.tasks.levels(&controller.levels),
        bounds: &controller.bounds,
        torque_limit: controller.arm.torque_limit(),
        dynamics: &data.dynamics,
        rows: &data.rows,
        spectrum: &data.spectrum,
        motion: &data.whitened_motion,
        way_out: &data.way_out,
        null_force: &data.control.null_force,
        residual: &data.observer.residual,
    };
    run(&mut data.wish, &ask);
}

#[inline(never)]
fn bounds<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.bounds.update(&controller.bounds, &data.joints);
}

fn projection<T: Real>(controller: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    with_wished(controller, data, Projection::update);
}

/// Runs what is about the projection on what is projected.
#[inline(always)]
pub(super) fn with_wished<T: Real>(
    controller: &Controller<T>,
    data: &mut Data<T>,
    run: impl FnOnce(&mut Projection<T>, &Wished<'_, T>),
) {
    let wished = Wished {
        acceleration: &data.wish.acceleration,
        torque: &data.wish.torque,
        bounds: &data.bounds,
        levels: data.tasks.levels(&controller.levels),
        dynamics: &data.dynamics,
        rows: &data.rows,
        spectrum: &data.spectrum,
        null_velocity: &data.motion.null_velocity,
    };
    run(&mut data.projection, &wished);
}

fn projected_demand<T: Real>(_: &Controller<T>, _: &Input<'_, T>, data: &mut Data<T>) {
    data.demand = TorqueDemand(data.projection.torque);
}

/// The exact law's.
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
