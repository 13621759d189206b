//! One cycle laid open, for whoever looks and does not move.

use super::config::ControllerConfig;
use super::construction::check_exact_rows;
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
/// [`Controller`] would refuse can be looked at. It has no fault.
#[derive(Clone, Debug)]
pub struct Inspection<T: Real> {
    controller: Controller<T>,
}

impl<T: Real> Inspection<T> {
    /// Of the exact law. Checks the arm and the number of levels and rows, nothing else.
    /// `observer_gain` is K_I \[1/s\].
    ///
    /// # Errors
    /// [`ConfigError`] of the arm, of the levels or of their rows.
    pub fn new(
        arm: &ArmParameters,
        tasks: &[Task],
        null_space: &NullSpace,
        observer_gain: [f64; DOF],
    ) -> Result<Self, ConfigError> {
        let config = config(tasks, null_space, observer_gain)?;
        check_exact_rows(&config.tasks)?;
        let controller = Controller::exactly(&ArmModel::new(arm)?, &config, UNKNOWN);
        Ok(Self { controller })
    }

    /// Of the law within limits, in cycles of `cycle_s` \[s\] with `dead_cycles`, with the same
    /// checks.
    ///
    /// # Errors
    /// [`ConfigError`] of the arm, of the levels or of their rows.
    pub fn within_limits(
        arm: &ArmParameters,
        tasks: &[Task],
        null_space: &NullSpace,
        observer_gain: [f64; DOF],
        cycle_s: f64,
        dead_cycles: u8,
    ) -> Result<Self, ConfigError> {
        let mut config = config(tasks, null_space, observer_gain)?;
        (config.cycle_s, config.dead_cycles) = (cycle_s, dead_cycles);
        let model = ArmModel::new(arm)?;
        let controller = Controller::within_limits(arm, &model, &config, UNKNOWN);
        Ok(Self { controller })
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

/// Nobody has searched for it.
const UNKNOWN: DampingRate = DampingRate {
    rate: 0.0,
    joint: 1,
    posture: [0.0; DOF],
};

/// Without a cycle.
fn config(
    tasks: &[Task],
    null_space: &NullSpace,
    observer_gain: [f64; DOF],
) -> Result<ControllerConfig, ConfigError> {
    Ok(ControllerConfig {
        tasks: TaskSet::unvalidated(tasks)?,
        null_space: *null_space,
        observer_gain,
        cycle_s: 0.0,
        dead_cycles: 0,
    })
}
