//! Whether a reference can be meant.

use super::measurement::within;
use crate::fault::{Fault, FaultKind, ORIENTATION_CODE, POSITION_CODE, Quantity};
use crate::joint::{JointVector, Vector3, all_finite};
use crate::ranges::QUATERNION_NORMS;
use crate::real::Real;
use crate::task::{LevelPoint, Levels, Reference, Target};

/// Checks that a reference has one target per level, of the kind of its task, and only
/// finite numbers.
///
/// # Errors
/// The first target or posture that is not so.
pub(crate) fn usable<T: Real>(reference: &Reference<T>, levels: &Levels<T>) -> Result<(), Fault> {
    let (targets, levels) = (reference.targets(), levels.as_slice());
    if targets.len() != levels.len() {
        let (value, allowed) = (targets.len() as f64, levels.len() as f64);
        return Err(refusal(Quantity::TargetCount, 0, value, [allowed; 2]));
    }
    for (index, (target, level)) in (1..).zip(targets.iter().zip(levels)) {
        match (target, &level.tracked) {
            (Target::Hold, _) => {}
            (Target::Position { x, dx, ddx }, LevelPoint::Position(..)) => {
                finite(Quantity::Target, index, [x, dx, ddx])?;
            }
            (Target::Orientation { q, w, dw }, LevelPoint::Orientation(_)) => {
                let [low, high] = QUATERNION_NORMS.map(|norm| T::from_f64(norm * norm));
                within(Quantity::Orientation, index, q.dot(q), low, high)?;
                finite(Quantity::Target, index, [w, dw])?;
            }
            (Target::Position { .. }, LevelPoint::Orientation(_)) => {
                return Err(wrong_kind(index, POSITION_CODE, ORIENTATION_CODE));
            }
            (Target::Orientation { .. }, LevelPoint::Position(..)) => {
                return Err(wrong_kind(index, ORIENTATION_CODE, POSITION_CODE));
            }
        }
    }
    if all_finite(&reference.posture) {
        return Ok(());
    }
    Err(not_finite(&reference.posture))
}

#[inline(always)]
fn finite<T: Real, const N: usize>(
    quantity: Quantity,
    index: u8,
    vectors: [&Vector3<T>; N],
) -> Result<(), Fault> {
    let mut all = true;
    for vector in vectors {
        all &= all_finite(vector);
    }
    if all {
        return Ok(());
    }
    let mut values = vectors.into_iter().flatten();
    let value = values.find(|value| !value.finite());
    let value = value.map_or(f64::NAN, |value| value.to_f64());
    Err(refusal(quantity, index, value, [f64::MIN, f64::MAX]))
}

#[cold]
fn not_finite<T: Real>(posture: &JointVector<T>) -> Fault {
    let mut joints = (1..).zip(posture);
    let (index, value) = joints
        .find(|(_, value)| !value.finite())
        .map_or((0, f64::NAN), |(index, value)| (index, value.to_f64()));
    refusal(
        Quantity::PostureReference,
        index,
        value,
        [f64::MIN, f64::MAX],
    )
}

#[cold]
fn refusal(quantity: Quantity, index: u8, value: f64, [min, max]: [f64; 2]) -> Fault {
    Fault {
        kind: FaultKind::Implausible,
        quantity,
        index,
        value,
        min,
        max,
    }
}

#[cold]
fn wrong_kind(index: u8, given: f64, allowed: f64) -> Fault {
    Fault {
        kind: FaultKind::WrongTarget,
        ..refusal(Quantity::TargetKind, index, given, [allowed; 2])
    }
}
