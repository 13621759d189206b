//! What a cycle may begin with: a measurement that can be true, a reference that can be
//! meant.

use super::data::Input;
use super::measurement::{believe, within};
use crate::arm::ArmModel;
use crate::fault::{Fault, FaultKind, ORIENTATION_CODE, POSITION_CODE, Quantity};
use crate::joint::{DOF, JointVector, Vector3};
use crate::ranges::{POSTURE_FACTOR, QUATERNION_NORMS, TARGET_ACCELERATION_MAX, TARGET_SPEED_MAX};
use crate::real::Real;
use crate::task::{Level, LevelPoint, Levels, Reference, Target};

/// Whether a cycle may run: no fault is `latched`, the measurement is believed and the
/// reference usable.
///
/// # Errors
/// The latched fault, or the first quantity that cannot be.
#[inline(always)]
pub(crate) fn admit<T: Real>(
    latched: Option<Fault>,
    arm: &ArmModel<T>,
    levels: &Levels<T>,
    cycle_s: T,
    input: &Input<'_, T>,
) -> Result<(), Fault> {
    match latched {
        Some(fault) => Err(fault),
        None => believe(arm, cycle_s, input.measurement)
            .and_then(|()| usable(input.reference, levels, arm)),
    }
}

/// Checks that a reference has one target per slot, of the kind of its task, and that
/// an arm can be meant by its numbers: [`crate::ranges`] has their bounds.
///
/// # Errors
/// The first target or posture that is not so.
fn usable<T: Real>(
    reference: &Reference<T>,
    levels: &Levels<T>,
    arm: &ArmModel<T>,
) -> Result<(), Fault> {
    usable_targets(reference, levels)?;
    let ([least, greatest], beyond) = (arm.position_range(), beyond_range(arm));
    let mut usable = true;
    for i in 0..DOF {
        let q_d = reference.posture[i];
        usable &= (q_d >= least[i] - beyond[i]) & (q_d <= greatest[i] + beyond[i]);
    }
    if usable {
        return Ok(());
    }
    usable_posture(&reference.posture, arm)
}

/// How far q_d may be beyond a range \[rad\].
#[inline(always)]
fn beyond_range<T: Real>(arm: &ArmModel<T>) -> JointVector<T> {
    let [least, greatest] = arm.position_range();
    (greatest - least) * T::from_f64((POSTURE_FACTOR - 1.0) / 2.0)
}

/// The part of [`usable`] that is about targets.
#[inline(always)]
fn usable_targets<T: Real>(reference: &Reference<T>, levels: &Levels<T>) -> Result<(), Fault> {
    let targets = reference.targets();
    let count = levels.slots();
    if targets.len() != count {
        return Err(refusal(
            Quantity::TargetCount,
            0,
            targets.len() as f64,
            [count as f64; 2],
        ));
    }
    // Of a slot without a level in force a target says nothing.
    for level in levels.in_order() {
        let Some(target) = targets.get(level.slot) else {
            continue;
        };
        usable_target(level, target, levels.shoulder())?;
    }
    Ok(())
}

/// The same of one level.
#[inline(always)]
pub(crate) fn usable_target<T: Real>(
    level: &Level<T>,
    target: &Target<T>,
    shoulder: &Vector3<T>,
) -> Result<(), Fault> {
    let index = level.slot as u8 + 1;
    match (target, &level.tracked) {
        (Target::Hold, _) => {}
        (Target::Position { x, dx, ddx }, LevelPoint::Position(..)) => {
            let ([speed, _], [acceleration, _]) = (TARGET_SPEED_MAX, TARGET_ACCELERATION_MAX);
            let reach = level.reach;
            bounded(Quantity::TargetDistance, index, &(x - shoulder), reach)?;
            bounded(Quantity::TargetSpeed, index, dx, T::from_f64(speed))?;
            let most = T::from_f64(acceleration);
            bounded(Quantity::TargetAcceleration, index, ddx, most)?;
        }
        (Target::Orientation { q, w, dw }, LevelPoint::Orientation(..)) => {
            let ([_, speed], [_, acceleration]) = (TARGET_SPEED_MAX, TARGET_ACCELERATION_MAX);
            let [low, high] = QUATERNION_NORMS.map(|norm| T::from_f64(norm * norm));
            within(Quantity::Orientation, index, q.dot(q), low, high)?;
            bounded(Quantity::TargetAngularSpeed, index, w, T::from_f64(speed))?;
            let most = T::from_f64(acceleration);
            bounded(Quantity::TargetAngularAcceleration, index, dw, most)?;
        }
        (Target::Position { .. }, LevelPoint::Orientation(..)) => {
            return Err(wrong_kind(index, POSITION_CODE, ORIENTATION_CODE));
        }
        (Target::Orientation { .. }, LevelPoint::Position(..)) => {
            return Err(wrong_kind(index, ORIENTATION_CODE, POSITION_CODE));
        }
    }
    Ok(())
}

/// Whether `vector` is at most `most` long.
#[inline(always)]
fn bounded<T: Real>(
    quantity: Quantity,
    index: u8,
    vector: &Vector3<T>,
    most: T,
) -> Result<(), Fault> {
    // False for NaN as well.
    if vector.dot(vector) <= most * most {
        return Ok(());
    }
    Err(too_long(quantity, index, vector, most))
}

#[cold]
#[inline(never)]
fn too_long<T: Real>(quantity: Quantity, index: u8, vector: &Vector3<T>, most: T) -> Fault {
    let mut largest = T::ZERO;
    for x in vector {
        largest = largest.most(x.magnitude());
    }
    let scaled = vector / largest;
    let length = if largest.finite() {
        largest * scaled.dot(&scaled).square_root()
    } else {
        largest
    };
    refusal(quantity, index, length.to_f64(), [0.0, most.to_f64()])
}

#[cold]
#[inline(never)]
pub(crate) fn usable_posture<T: Real>(
    posture: &JointVector<T>,
    arm: &ArmModel<T>,
) -> Result<(), Fault> {
    let ([least, greatest], beyond) = (arm.position_range(), beyond_range(arm));
    let (least, greatest) = (least - beyond, greatest + beyond);
    for (joint, (&value, (&min, &max))) in
        (1..).zip(posture.iter().zip(least.iter().zip(&greatest)))
    {
        within(Quantity::PostureReference, joint, value, min, max)?;
    }
    Ok(())
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
