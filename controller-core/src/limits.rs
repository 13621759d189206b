//! The last stage: a demanded torque becomes one that may reach the motors.

use crate::fault::{Fault, FaultKind, Flags, Quantity};
use crate::joint::{DOF, JointVector};
use crate::law::TorqueDemand;
use crate::measurement::{all_finite, finite};
use crate::real::Real;

/// A finite torque within the limits of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueCommand<T: Real> {
    /// Joint torque \[Nm\].
    pub torque: JointVector<T>,
    /// Joints that were cut to their limit.
    pub saturated: Flags,
}

impl<T: Real> TorqueCommand<T> {
    /// Cuts each joint to its limit \[Nm\].
    ///
    /// # Errors
    /// A demand that is not finite.
    #[inline]
    pub fn new(demand: &TorqueDemand<T>, limit: &JointVector<T>) -> Result<Self, Fault> {
        let mut command = Self {
            torque: demand.0,
            saturated: Flags::NONE,
        };
        if !all_finite(&demand.0) {
            for (index, &torque) in (1..).zip(&demand.0) {
                finite(FaultKind::NonFiniteTorque, Quantity::Torque, index, torque)?;
            }
        }
        for index in 0..DOF {
            let torque = demand.0[index];
            let cut = torque.limited(-limit[index], limit[index]);
            command.torque[index] = cut;
            command.saturated.0 |= u8::from(cut != torque) << index;
        }
        Ok(command)
    }
}
