//! A demanded torque becomes one that may reach the motors.

use super::control::TorqueDemand;
use crate::fault::{Fault, FaultKind, IndexSet, Quantity};
use crate::joint::{DOF, JointVector, all_finite, zeros};
use crate::real::Real;

/// A torque within the limits of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allocation<T: Real> {
    /// Joint torque \[Nm\], each joint cut to its limit; finite where `finite` is true.
    pub torque: JointVector<T>,
    /// Joints that were cut.
    pub saturated: IndexSet,
    /// Whether the demand was finite.
    pub finite: bool,
}

impl<T: Real> Allocation<T> {
    /// Nothing allocated yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            torque: zeros(),
            saturated: IndexSet::NONE,
            finite: true,
        }
    }

    /// Cuts each joint to its limit \[Nm\].
    #[inline]
    pub fn update(&mut self, demand: &TorqueDemand<T>, limit: &JointVector<T>) {
        self.finite = all_finite(&demand.0);
        let mut saturated = IndexSet::NONE;
        for index in 0..DOF {
            let torque = demand.0[index];
            let cut = torque.limited(-limit[index], limit[index]);
            self.torque[index] = cut;
            saturated.0 |= u8::from(cut != torque) << index;
        }
        self.saturated = saturated;
    }

    /// The fault of a `demand` that was not finite.
    #[must_use]
    pub fn fault(&self, demand: &TorqueDemand<T>) -> Option<Fault> {
        if self.finite {
            return None;
        }
        let mut joints = (1..).zip(&demand.0);
        let (index, value) = joints
            .find(|(_, torque)| !torque.finite())
            .map_or((0, f64::NAN), |(index, torque)| (index, torque.to_f64()));
        Some(Fault {
            kind: FaultKind::NonFiniteTorque,
            quantity: Quantity::Torque,
            index,
            value,
            min: f64::MIN,
            max: f64::MAX,
        })
    }
}

impl<T: Real> Default for Allocation<T> {
    fn default() -> Self {
        Self::new()
    }
}
