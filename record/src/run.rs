//! A simulated run: true values, cycle by cycle.

use controller_core::fault::{Mode, Status};
use controller_core::joint::{DOF, JointState, JointVector};

use crate::channel::{Channel, Place, Value, numbers};

/// One cycle of a run.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Time \[s\].
    pub t_s: f64,
    /// True joint state.
    pub state: JointState<f64>,
    /// Torque that acts from now on for a cycle \[Nm\].
    pub torque: JointVector<f64>,
    /// r \[Nm\].
    pub residual: JointVector<f64>,
    /// What the cycle of the controller was part of; none where it is not known.
    pub mode: Option<Mode>,
    /// Whether a torque was cut to its limit.
    pub saturated: bool,
    /// Whether a task row could not be resolved.
    pub rank: bool,
    /// True tau_ext of (6) \[Nm\]: minus the joint torque of the contacts.
    pub tau_ext: JointVector<f64>,
    /// Largest force of a hand \[N\].
    pub hand_force_n: f64,
    /// How far each task row is from a singularity \[1/sqrt(kg)\]: |R_kk|, within limits the
    /// roots of the mobilities of its level; empty where it is not known.
    pub conditioning: Vec<f64>,
    /// What the law within limits met; none of other laws.
    pub limits: Option<LimitSample>,
    /// Every level, highest priority first.
    pub levels: Vec<LevelSample>,
}

/// What the law within limits met in a cycle.
#[derive(Clone, Debug)]
pub struct LimitSample {
    /// Its flags.
    pub status: Status,
    /// Share of what it asks the joints for that the null space got.
    pub null_share: f64,
    /// What the bounds of the joints do on the null-space motion \[W\].
    pub null_power: f64,
}

/// One level at one instant, true values.
#[derive(Clone, Debug, Default)]
pub struct LevelSample {
    /// Desired coordinates of its axes \[m\], or the desired quaternion.
    pub desired: Vec<f64>,
    /// True coordinates of its axes \[m\], or the true quaternion.
    pub actual: Vec<f64>,
    /// Norm of their difference \[m\], or the angle between them about the axes \[rad\].
    pub error: f64,
    /// Norm of the task acceleration that the torques of lower levels and of the
    /// null space cause on this arm \[m/s2\], or \[rad/s2\]; NaN where it is not known.
    pub leak: f64,
    /// Share of what it asks the joints for that the level got; NaN where it is not known.
    pub share: f64,
    /// Task acceleration that the bounds of the joints take from the level \[m/s2\], of an
    /// orientation at 0.1 m; NaN where it is not known.
    pub disturbance: f64,
    /// Desired position of the point \[m\].
    pub desired_point: [f64; 3],
    /// True position of the point \[m\].
    pub actual_point: [f64; 3],
}

impl LimitSample {
    /// 1 where a joint (from 0) may not go further up, -1 further down, else 0.
    #[must_use]
    pub fn at_bound(&self, joint: usize) -> i8 {
        let end = |at: bool| i8::from(at);
        let (least, greatest) = (self.status.at_least, self.status.at_greatest);
        end(greatest.contains(joint)) - end(least.contains(joint))
    }
}

/// Channels of a run.
#[rustfmt::skip]
pub const CHANNELS: &[Channel<Sample>] = &[
    Channel { columns: "t", unit: "s", meaning: "cycle instant", place: Place::Both, values: |s, sink| sink(Value::Number(s.t_s)) },
    Channel { columns: "q{joint}", unit: "rad", meaning: "true joint angles", place: Place::Both, values: |s, sink| numbers(s.state.q.as_slice(), sink) },
    Channel { columns: "dq{joint}", unit: "rad/s", meaning: "true joint speeds", place: Place::Both, values: |s, sink| numbers(s.state.dq.as_slice(), sink) },
    Channel { columns: "tau{joint}", unit: "Nm", meaning: "torque applied from t on, after limits, before the plant's noise", place: Place::Both, values: |s, sink| numbers(s.torque.as_slice(), sink) },
    Channel { columns: "tau_ext{joint}", unit: "Nm", meaning: "true tau_ext of (6), -J^T F", place: Place::Both, values: |s, sink| numbers(s.tau_ext.as_slice(), sink) },
    Channel { columns: "r{joint}", unit: "Nm", meaning: "residual", place: Place::Both, values: |s, sink| numbers(s.residual.as_slice(), sink) },
    Channel { columns: "mode", unit: "", meaning: "number of the controller's mode: 0 running, 1 limited, 2 braking, 3 resting, 4 blind, 5 stopped; empty where it is not known", place: Place::File, values: |s, sink| sink(s.mode.map_or(Value::Empty, |mode| Value::Count(mode.number().into()))) },
    Channel { columns: "conditioning{row}", unit: "1/sqrt(kg)", meaning: "abs R_kk per task row; within limits root of z per direction of its level", place: Place::Series, values: |s, sink| numbers(&rows(&s.conditioning), sink) },
    Channel { columns: "at_bound{joint}", unit: "", meaning: "1 where a joint may not go further up, -1 further down, else 0; empty without the law within limits", place: Place::File, values: |s, sink| (0..DOF).for_each(|i| sink(s.limits.as_ref().map_or(Value::Empty, |l| Value::Count(l.at_bound(i).into())))) },
    Channel { columns: "pivots", unit: "", meaning: "exchanges that the projection onto the bounds took", place: Place::Both, values: |s, sink| sink(s.limits.as_ref().map_or(Value::Empty, |l| Value::Count(l.status.pivots.into()))) },
    Channel { columns: "null_share", unit: "", meaning: "share of what it asks for that the null space got", place: Place::Series, values: |s, sink| sink(Value::Number(s.limits.as_ref().map_or(f64::NAN, |l| l.null_share))) },
    Channel { columns: "null_power", unit: "W", meaning: "what the bounds do on the null-space motion", place: Place::Series, values: |s, sink| sink(Value::Number(s.limits.as_ref().map_or(f64::NAN, |l| l.null_power))) },
    Channel { columns: "hand_force", unit: "N", meaning: "largest force of a hand", place: Place::Series, values: |s, sink| sink(Value::Number(s.hand_force_n)) },
];

/// Channels of each level of a run.
#[rustfmt::skip]
pub const LEVEL_CHANNELS: &[Channel<LevelSample>] = &[
    Channel { columns: "x{level}_des_{axis}", unit: "m", meaning: "level N, desired coordinate along each of its axes A", place: Place::File, values: |l, sink| numbers(&l.desired, sink) },
    Channel { columns: "x{level}_{axis}", unit: "m", meaning: "true coordinate", place: Place::File, values: |l, sink| numbers(&l.actual, sink) },
    Channel { columns: "e{level}", unit: "m, rad", meaning: "norm of the error of level N; of an orientation the angle between desired and true frame about the axes of the level", place: Place::Both, values: |l, sink| sink(Value::Number(l.error)) },
    Channel { columns: "leak{level}", unit: "m/s2, rad/s2", meaning: "priority leak", place: Place::Series, values: |l, sink| sink(Value::Number(l.leak)) },
    Channel { columns: "share{level}", unit: "", meaning: "share of what it asks for that the level got", place: Place::Series, values: |l, sink| sink(Value::Number(l.share)) },
    Channel { columns: "disturbance{level}", unit: "m/s2", meaning: "task acceleration that the bounds of the joints take from the level, of an orientation at 0.1 m", place: Place::Series, values: |l, sink| sink(Value::Number(l.disturbance)) },
    Channel { columns: "point{level}_des_{axis}", unit: "m", meaning: "desired position of the point", place: Place::Series, values: |l, sink| numbers(&l.desired_point, sink) },
    Channel { columns: "point{level}_{axis}", unit: "m", meaning: "true position of the point", place: Place::Series, values: |l, sink| numbers(&l.actual_point, sink) },
];

/// One entry per possible row, NaN where there is none.
fn rows(known: &[f64]) -> [f64; DOF] {
    let mut rows = [f64::NAN; DOF];
    for (row, value) in rows.iter_mut().zip(known) {
        *row = *value;
    }
    rows
}
