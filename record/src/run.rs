//! A simulated run: true values, cycle by cycle.

use controller_core::fault::Mode;
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
    /// |R_kk| per task row; empty where it is not known.
    pub conditioning: Vec<f64>,
    /// Every level, highest priority first.
    pub levels: Vec<LevelSample>,
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
    /// Desired position of the point \[m\].
    pub desired_point: [f64; 3],
    /// True position of the point \[m\].
    pub actual_point: [f64; 3],
}

/// Channels of a run.
#[rustfmt::skip]
pub const CHANNELS: &[Channel<Sample>] = &[
    Channel { columns: "t", unit: "s", meaning: "cycle instant", place: Place::Both, values: |s, sink| sink(Value::Number(s.t_s)) },
    Channel { columns: "q{joint}", unit: "rad", meaning: "true joint angles", place: Place::Both, values: |s, sink| numbers(s.state.q.as_slice(), sink) },
    Channel { columns: "dq{joint}", unit: "rad/s", meaning: "true joint speeds", place: Place::File, values: |s, sink| numbers(s.state.dq.as_slice(), sink) },
    Channel { columns: "tau{joint}", unit: "Nm", meaning: "torque applied from t on, after limits, before the plant's noise", place: Place::File, values: |s, sink| numbers(s.torque.as_slice(), sink) },
    Channel { columns: "tau_ext{joint}", unit: "Nm", meaning: "true tau_ext of (6), -J^T F", place: Place::Both, values: |s, sink| numbers(s.tau_ext.as_slice(), sink) },
    Channel { columns: "r{joint}", unit: "Nm", meaning: "residual", place: Place::Both, values: |s, sink| numbers(s.residual.as_slice(), sink) },
    Channel { columns: "mode", unit: "", meaning: "number of the controller's mode: 0 running, 1 limited, 2 braking, 3 resting, 4 blind, 5 stopped; empty where it is not known", place: Place::File, values: |s, sink| sink(s.mode.map_or(Value::Empty, |mode| Value::Count(mode.number().into()))) },
    Channel { columns: "conditioning{row}", unit: "1/sqrt(kg)", meaning: "abs R_kk per task row", place: Place::Series, values: |s, sink| numbers(&rows(&s.conditioning), sink) },
    Channel { columns: "hand_force", unit: "N", meaning: "largest force of a hand", place: Place::Series, values: |s, sink| sink(Value::Number(s.hand_force_n)) },
];

/// Channels of each level of a run.
#[rustfmt::skip]
pub const LEVEL_CHANNELS: &[Channel<LevelSample>] = &[
    Channel { columns: "x{level}_des_{axis}", unit: "m", meaning: "level N, desired coordinate along each of its axes A", place: Place::File, values: |l, sink| numbers(&l.desired, sink) },
    Channel { columns: "x{level}_{axis}", unit: "m", meaning: "true coordinate", place: Place::File, values: |l, sink| numbers(&l.actual, sink) },
    Channel { columns: "e{level}", unit: "m, rad", meaning: "norm of the error of level N; of an orientation the angle between desired and true frame about the axes of the level", place: Place::Both, values: |l, sink| sink(Value::Number(l.error)) },
    Channel { columns: "leak{level}", unit: "m/s2, rad/s2", meaning: "priority leak", place: Place::Series, values: |l, sink| sink(Value::Number(l.leak)) },
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
