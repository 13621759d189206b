//! What enters a cycle, and the check that it can be true.

use crate::arm::ArmModel;
use crate::fault::{Fault, FaultKind, Quantity};
use crate::joint::{DOF, JointVector};
use crate::ranges::{INTERVAL_FACTORS, POSITION_MARGIN, SPEED_FACTOR};
use crate::real::Real;

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

/// Whether a measurement can be true.
///
/// # Errors
/// The first quantity that cannot be true: a position beyond its range by more
/// than [`POSITION_MARGIN`], a speed above [`SPEED_FACTOR`] times the data sheet,
/// an interval outside [`INTERVAL_FACTORS`] of `cycle_s`, anything not finite.
pub(crate) fn believe<T: Real>(
    arm: &ArmModel<T>,
    cycle_s: T,
    measurement: &Measurement<T>,
) -> Result<(), Fault> {
    let Measurement { q, dq, interval_s } = measurement;
    let margin = T::from_f64(POSITION_MARGIN);
    let factor = T::from_f64(SPEED_FACTOR);
    let [low, high] = INTERVAL_FACTORS.map(|factor| T::from_f64(factor) * cycle_s);
    let ([least, greatest], speeds) = (arm.position_range(), arm.speed_limit());
    // All at once first; which one it is matters only then. False for NaN as well.
    let mut believed = (*interval_s >= low) & (*interval_s <= high);
    for i in 0..DOF {
        believed &= (q[i] >= least[i] - margin) & (q[i] <= greatest[i] + margin);
        believed &= dq[i].magnitude() <= speeds[i] * factor;
    }
    if believed {
        return Ok(());
    }
    believe_in_turn(arm, cycle_s, measurement)
}

/// The same one by one.
#[cold]
#[inline(never)]
pub(crate) fn believe_in_turn<T: Real>(
    arm: &ArmModel<T>,
    cycle_s: T,
    measurement: &Measurement<T>,
) -> Result<(), Fault> {
    let Measurement { q, dq, interval_s } = measurement;
    let factor = T::from_f64(SPEED_FACTOR);
    let [low, high] = INTERVAL_FACTORS.map(|factor| T::from_f64(factor) * cycle_s);
    let speeds = arm.speed_limit();
    believe_posture(arm, q)?;
    for (index, (&value, &limit)) in (1..).zip(dq.iter().zip(speeds)) {
        let limit = limit * factor;
        within(Quantity::Speed, index, value, -limit, limit)?;
    }
    within(Quantity::Interval, 0, *interval_s, low, high)
}

/// The part of [`believe`] that is about q.
#[cold]
#[inline(never)]
pub(crate) fn believe_posture<T: Real>(arm: &ArmModel<T>, q: &JointVector<T>) -> Result<(), Fault> {
    let ([least, greatest], margin) = (arm.position_range(), T::from_f64(POSITION_MARGIN));
    for (index, (&value, (&min, &max))) in (1..).zip(q.iter().zip(least.iter().zip(greatest))) {
        within(Quantity::Position, index, value, min - margin, max + margin)?;
    }
    Ok(())
}

#[inline(always)]
pub(crate) fn within<T: Real>(
    quantity: Quantity,
    index: u8,
    value: T,
    min: T,
    max: T,
) -> Result<(), Fault> {
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
