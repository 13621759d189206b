//! One cycle laid open, for whoever looks and does not move.

use super::config::ControllerConfig;
use super::controller::Controller;
use super::data::{Data, Input};
use crate::arm::{ArmModel, ArmParameters};
use crate::error::ConfigError;
use crate::joint::DOF;
use crate::law::null_space::NullSpace;
use crate::law::sampling::DampingRate;
use crate::real::Real;
use crate::task::{Task, TaskSet};

/// A controller that evaluates and never steps: gains are taken as they are, what a
/// [`Controller`] would refuse can be looked at. It has no cycle time and no fault.
#[derive(Clone, Debug)]
pub struct Inspection<T: Real> {
    controller: Controller<T>,
}

impl<T: Real> Inspection<T> {
    /// Checks the arm and the number of levels and rows, nothing else. `observer_gain`
    /// is K_I \[1/s\].
    ///
    /// # Errors
    /// [`ConfigError`] of the arm, of the levels or of their rows.
    pub fn new(
        arm: &ArmParameters,
        tasks: &[Task],
        null_space: &NullSpace,
        observer_gain: [f64; DOF],
    ) -> Result<Self, ConfigError> {
        let arm = ArmModel::new(arm)?;
        let config = ControllerConfig {
            tasks: TaskSet::unvalidated(tasks)?,
            null_space: *null_space,
            observer_gain,
            cycle_s: 0.0,
            dead_cycles: 0,
        };
        let unknown = DampingRate {
            rate: 0.0,
            joint: 1,
            posture: [0.0; DOF],
        };
        Ok(Self {
            controller: Controller::exactly(&arm, &config, unknown),
        })
    }

    /// The arm.
    #[must_use]
    pub fn arm(&self) -> &ArmModel<T> {
        self.controller.arm()
    }

    /// All stages, with the product's law.
    pub fn evaluate(&self, input: &Input<'_, T>, data: &mut Data<T>) {
        self.controller.evaluate(input, data);
    }

    /// All stages with `law` in the place of the torque demand, as in
    /// [`Controller::step_with`].
    pub fn evaluate_with(
        &self,
        input: &Input<'_, T>,
        data: &mut Data<T>,
        law: impl FnOnce(&Controller<T>, &Input<'_, T>, &mut Data<T>),
    ) {
        self.controller.evaluate_with(input, data, law);
    }
}
