//! The last stage: a demanded torque becomes one that may reach the motors.

use crate::fault::{Fault, FaultKind, Flags, Quantity};
use crate::joint::JointVector;
use crate::law::TorqueDemand;
use crate::measurement::finite;
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
        for (index, (torque, &limit)) in command.torque.iter_mut().zip(limit).enumerate() {
            finite(
                FaultKind::NonFiniteTorque,
                Quantity::Torque,
                index as u8 + 1,
                *torque,
            )?;
            let cut = torque.limited(-limit, limit);
            command.saturated.set_if(index, cut != *torque);
            *torque = cut;
        }
        Ok(command)
    }
}
