//! What enters a cycle, and the check that it can be true.

use heapless::Vec;
use nalgebra::SVector;

use crate::fault::{Fault, FaultKind, Quantity};
use crate::joint::{DOF, JointState, JointVector, zeros};
use crate::model::ArmModel;
use crate::real::Real;
use crate::task::{MAX_LEVELS, TaskReference};

/// How far beyond its limit a measured joint position is still believed \[rad\].
pub const POSITION_MARGIN: f64 = 0.2;

/// Multiple of the data-sheet speed up to which a measured speed is believed.
pub const SPEED_FACTOR: f64 = 3.0;

/// Multiples of the nominal cycle between which a measured interval is believed.
pub const INTERVAL_FACTORS: [f64; 2] = [0.5, 20.0];

/// Norms between which a desired orientation is believed to be a quaternion.
pub const QUATERNION_NORMS: [f64; 2] = [0.5, 2.0];

/// What the robot reports at a cycle instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<T: Real> {
    /// q \[rad\].
    pub q: JointVector<T>,
    /// dq \[rad/s\].
    pub dq: JointVector<T>,
    /// h: time since the previous measurement \[s\]; the nominal cycle at first.
    pub interval_s: T,
}

/// What the arm should do at this instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference<T: Real> {
    /// One entry per level, in priority order; every number finite.
    pub tasks: Vec<TaskReference<T>, MAX_LEVELS>,
    /// q_d \[rad\], posture towards which the null space is compliant. With an
    /// integrated posture it counts at the first cycle only.
    pub posture: JointVector<T>,
}

impl<T: Real> Reference<T> {
    /// No task reference yet, posture all zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            tasks: Vec::new(),
            posture: zeros(),
        }
    }
}

impl<T: Real> Default for Reference<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// The joint state of a plausible measurement.
///
/// # Errors
/// The first quantity that cannot be true: a position beyond its limit by more
/// than [`POSITION_MARGIN`], a speed above [`SPEED_FACTOR`] times the data sheet,
/// an interval outside [`INTERVAL_FACTORS`] of `cycle_s`, anything not finite.
pub(crate) fn plausible<T: Real>(
    model: &ArmModel<T>,
    cycle_s: T,
    measurement: &Measurement<T>,
) -> Result<JointState<T>, Fault> {
    let Measurement { q, dq, interval_s } = measurement;
    let margin = T::from_f64(POSITION_MARGIN);
    let factor = T::from_f64(SPEED_FACTOR);
    let [low, high] = INTERVAL_FACTORS.map(|factor| T::from_f64(factor) * cycle_s);
    let (positions, speeds) = (model.position_limit(), model.speed_limit());
    // All at once first; which one it is matters only then. False for NaN as well.
    let mut believed = (*interval_s >= low) & (*interval_s <= high);
    for i in 0..DOF {
        believed &= q[i].magnitude() <= positions[i] + margin;
        believed &= dq[i].magnitude() <= speeds[i] * factor;
    }
    if believed {
        return Ok(JointState { q: *q, dq: *dq });
    }
    for (index, (&value, &limit)) in (1..).zip(q.iter().zip(positions)) {
        let limit = limit + margin;
        within(Quantity::Position, index, value, -limit, limit)?;
    }
    for (index, (&value, &limit)) in (1..).zip(dq.iter().zip(speeds)) {
        let limit = limit * factor;
        within(Quantity::Speed, index, value, -limit, limit)?;
    }
    within(Quantity::Interval, 0, *interval_s, low, high)?;
    Ok(JointState { q: *q, dq: *dq })
}

/// Whether every value is finite: x - x is 0 where x is, else NaN, which no sum loses.
#[inline(always)]
#[allow(clippy::eq_op)]
pub(crate) fn all_finite<T: Real, const N: usize>(values: &SVector<T, N>) -> bool {
    let mut sum = T::ZERO;
    for i in 0..N {
        sum += values[i] - values[i];
    }
    sum == T::ZERO
}

/// Checks that a reference has `levels` entries and only finite numbers.
///
/// # Errors
/// The first entry that is not.
pub(crate) fn usable<T: Real>(reference: &Reference<T>, levels: usize) -> Result<(), Fault> {
    let count = reference.tasks.len();
    if count != levels {
        return Err(Fault {
            kind: FaultKind::Implausible,
            quantity: Quantity::ReferenceCount,
            index: 0,
            value: count as f64,
            min: levels as f64,
            max: levels as f64,
        });
    }
    for (index, task) in (1..).zip(&reference.tasks) {
        let norm_squared = task.orientation.dot(&task.orientation);
        let [low, high] = QUATERNION_NORMS.map(|norm| T::from_f64(norm * norm));
        within(Quantity::Orientation, index, norm_squared, low, high)?;
        if !(all_finite(&task.x) & all_finite(&task.dx) & all_finite(&task.ddx)) {
            for &value in task.x.iter().chain(&task.dx).chain(&task.ddx) {
                let quantity = Quantity::TaskReference;
                finite(FaultKind::Implausible, quantity, index, value)?;
            }
        }
    }
    if !all_finite(&reference.posture) {
        for (index, &value) in (1..).zip(&reference.posture) {
            let quantity = Quantity::PostureReference;
            finite(FaultKind::Implausible, quantity, index, value)?;
        }
    }
    Ok(())
}

#[inline(always)]
fn within<T: Real>(quantity: Quantity, index: u8, value: T, min: T, max: T) -> Result<(), Fault> {
    // False for NaN as well.
    if value >= min && value <= max {
        return Ok(());
    }
    Err(Fault {
        kind: FaultKind::Implausible,
        quantity,
        index,
        value: value.to_f64(),
        min: min.to_f64(),
        max: max.to_f64(),
    })
}

#[inline(always)]
pub(crate) fn finite<T: Real>(
    kind: FaultKind,
    quantity: Quantity,
    index: u8,
    value: T,
) -> Result<(), Fault> {
    if value.finite() {
        return Ok(());
    }
    Err(Fault {
        kind,
        quantity,
        index,
        value: value.to_f64(),
        min: f64::MIN,
        max: f64::MAX,
    })
}
