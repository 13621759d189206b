//! The arm as the robot sees it in a cycle, and what of it ends a motion.

use crate::request::CollisionBehavior;
use crate::robot::pose::{between, product, turned_into, twist_at, wrench_about};
use crate::robot::settings::{Approach, Limits};
use crate::robot_error::{RobotError, RobotErrors};
use crate::state::{DOF, Pose, State};

/// q4 at which the sign of the elbow changes, negative \[rad\].
const ELBOW: f64 = 0.467_002_423_653_011;

/// Cycle of the interface \[s\].
const CYCLE_S: f64 = 1e-3;

/// What sensors and the robot's own model say in a cycle. Vectors are in the axes of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    /// Joint angles \[rad\].
    pub q: [f64; DOF],
    /// Joint speeds \[rad/s\].
    pub dq: [f64; DOF],
    /// Torque on the side of the links, gravity included \[Nm\].
    pub tau_j: [f64; DOF],
    /// That without what the robot's model expects \[Nm\]: what the arm exerts on others, not
    /// filtered.
    pub tau_ext: [f64; DOF],
    /// Force \[N\] and moment about the flange's origin \[Nm\] that explain `tau_ext`.
    pub wrench: [f64; 6],
    /// The flange \[m\].
    pub o_t_f: Pose,
    /// Velocity of the flange's origin \[m/s\], angular velocity \[rad/s\].
    pub twist: [f64; 6],
    /// Motor angles \[rad\].
    pub theta: [f64; DOF],
    /// Motor speeds \[rad/s\].
    pub dtheta: [f64; DOF],
}

/// Whether a number is at most another one; what is no number is not.
fn within(value: f64, most: f64) -> bool {
    value.abs() <= most
}

impl Approach {
    /// Whether a joint may be there so fast \[rad\], \[rad/s\].
    fn allows(&self, q: f64, dq: f64) -> bool {
        let [lower, upper] = self.ends;
        let left = if dq > 0.0 { upper - q } else { q - lower };
        let fast = dq.abs() + self.offset;
        // Resting is allowed everywhere; compared by squares.
        dq == 0.0 || fast * fast <= 2.0 * self.deceleration * left.max(0.0)
    }
}

impl Limits {
    /// The first joint that is beyond its range, from 0.
    pub(super) fn beyond(&self, q: &[f64; DOF]) -> Option<usize> {
        let mut joints = q.iter().zip(&self.position);
        joints.position(|(q, [lower, upper])| !(lower..=upper).contains(&q))
    }

    /// What of the arm's motion and torque is beyond a limit.
    pub(super) fn violated(&self, arm: &Arm, state: &State, twist: &[f64; 6]) -> RobotErrors {
        let mut errors = RobotErrors::NONE;
        let mut unless = |allowed: bool, error| {
            if !allowed {
                errors = errors.with(error);
            }
        };
        unless(
            self.beyond(&arm.q).is_none(),
            RobotError::JointPositionLimitsViolation,
        );
        let all = |values: &[f64; DOF], most: &[f64; DOF]| {
            values.iter().zip(most).all(|(&v, &most)| within(v, most))
        };
        let mut ends = arm.q.iter().zip(&arm.dq).zip(&self.approach);
        unless(
            all(&arm.dq, &self.speed)
                && ends.all(|((&q, &dq), approach)| {
                    approach.as_ref().is_none_or(|it| it.allows(q, dq))
                }),
            RobotError::JointVelocityViolation,
        );
        let [x, y, z, a, b, c] = *twist;
        let [linear, angular] = self.cartesian_speed;
        unless(
            x * x + y * y + z * z <= linear * linear && a * a + b * b + c * c <= angular * angular,
            RobotError::CartesianVelocityViolation,
        );
        unless(
            all(&arm.tau_j, &self.sensor),
            RobotError::TauJRangeViolation,
        );
        let none = |collisions: &[f64]| collisions.iter().all(|&level| level == 0.0);
        unless(none(&state.joint_collision), RobotError::JointReflex);
        unless(
            none(&state.cartesian_collision),
            RobotError::CartesianReflex,
        );
        errors
    }
}

/// Levels above thresholds: 1 where the value is above; `latched` ones stay.
fn levels<const N: usize>(
    levels: &mut [f64; N],
    values: &[f64; N],
    most: &[f64; N],
    latched: bool,
) {
    for ((level, &value), &most) in levels.iter_mut().zip(values).zip(most) {
        let above = !within(value, most);
        if above || !latched {
            *level = f64::from(u8::from(above));
        }
    }
}

/// Sign of the elbow and angle of joint 3 \[rad\], as the state has them.
fn elbow(q: &[f64; DOF]) -> [f64; 2] {
    let [_, _, q3, q4, ..] = *q;
    [q3, if q4 + ELBOW < 0.0 { -1.0 } else { 1.0 }]
}

/// Writes what is measured into a state; the twist of the end effector. `watched`: collisions count.
pub(super) fn report(
    state: &mut State,
    arm: &Arm,
    collision: &CollisionBehavior,
    gain: f64,
    watched: bool,
) -> [f64; 6] {
    for ((rate, &now), &before) in state.dtau_j.iter_mut().zip(&arm.tau_j).zip(&state.tau_j) {
        *rate = (now - before) / CYCLE_S;
    }
    state.q = arm.q;
    state.dq = arm.dq;
    state.tau_j = arm.tau_j;
    state.theta = arm.theta;
    state.dtheta = arm.dtheta;
    state.elbow = elbow(&arm.q);
    state.o_t_ee = product(&arm.o_t_f, &state.f_t_ee);

    let o_t_k = product(&state.o_t_ee, &state.ee_t_k);
    let wrench = wrench_about(&arm.wrench, between(&arm.o_t_f, &o_t_k));
    let filter = |filtered: &mut [f64], values: &[f64]| {
        for (filtered, value) in filtered.iter_mut().zip(values) {
            *filtered += gain * (value - *filtered);
        }
    };
    filter(&mut state.tau_ext_hat_filtered, &arm.tau_ext);
    filter(&mut state.o_f_ext_hat_k, &wrench);
    state.k_f_ext_hat_k = turned_into(&o_t_k, &state.o_f_ext_hat_k);

    let (torque, force) = (state.tau_ext_hat_filtered, state.o_f_ext_hat_k);
    let lower = &collision.lower_torque_nominal;
    levels(&mut state.joint_contact, &torque, lower, false);
    let lower = &collision.lower_force_nominal;
    levels(&mut state.cartesian_contact, &force, lower, false);
    if watched {
        let upper = &collision.upper_torque_nominal;
        levels(&mut state.joint_collision, &torque, upper, true);
        let upper = &collision.upper_force_nominal;
        levels(&mut state.cartesian_collision, &force, upper, true);
    }
    twist_at(&arm.twist, between(&arm.o_t_f, &state.o_t_ee))
}

/// What the robot wants the arm to do, when it is to stay where it is.
pub(super) fn stay(state: &mut State) {
    state.q_d = state.q;
    state.dq_d = [0.0; DOF];
    state.ddq_d = [0.0; DOF];
    state.o_t_ee_d = state.o_t_ee;
    state.o_t_ee_c = state.o_t_ee;
    state.elbow_d = state.elbow;
    state.elbow_c = state.elbow;
    state.delbow_c = [0.0; 2];
    state.ddelbow_c = [0.0; 2];
    state.o_dp_ee_d = [0.0; 6];
    state.o_dp_ee_c = [0.0; 6];
    state.o_ddp_ee_c = [0.0; 6];
}
