//! How a controller is made: arm and configuration validated, converted, and given a law.

use super::brake::brake_rate;
use super::config::ControllerConfig;
use super::controller::{Controller, Law};
use super::stages::{exact, within_limits};
use crate::arm::{ArmModel, ArmParameters};
use crate::error::ConfigError;
use crate::joint::JointVector;
use crate::law::limits::bounds::JointBounds;
use crate::law::limits::joint_limits;
use crate::law::null_space::{Compliance, Posture};
use crate::law::sampling::DampingRate;
use crate::ranges::EXACT_ROWS;
use crate::real::Real;
use crate::task::{Levels, TaskSet};

/// What makes a controller: [`Controller::new`] or [`Controller::exact`].
pub type MakeController<T> =
    fn(&ArmParameters, &ControllerConfig) -> Result<Controller<T>, ConfigError>;

/// Whether the exact law has room for what tasks take, and for what they may come to take.
///
/// # Errors
/// [`ConfigError::ExactRows`].
pub(crate) fn check_exact_rows(tasks: &TaskSet) -> Result<(), ConfigError> {
    let rows = tasks.capacity().rows;
    if rows <= EXACT_ROWS {
        Ok(())
    } else {
        Err(ConfigError::ExactRows { rows })
    }
}

impl<T: Real> Controller<T> {
    /// The law within limits ([`crate::law::limits`]). Validates arm and configuration and
    /// converts them to the precision `T`.
    ///
    /// # Errors
    /// [`ConfigError`] names the first thing that cannot be.
    pub fn new(arm: &ArmParameters, config: &ControllerConfig) -> Result<Self, ConfigError> {
        if config.null_space.posture != Posture::Constant {
            return Err(ConfigError::IntegratedPosture);
        }
        Self::made(arm, config, |model, fastest_mode| {
            Self::within_limits(arm, model, config, fastest_mode)
        })
    }

    /// The exact law of the paper: singularities, ranges and speed limits are not its
    /// business; torques are cut joint by joint. An image that makes controllers in one way
    /// only has the other law not in it.
    ///
    /// # Errors
    /// [`ConfigError`] names the first thing that cannot be.
    pub fn exact(arm: &ArmParameters, config: &ControllerConfig) -> Result<Self, ConfigError> {
        check_exact_rows(&config.tasks)?;
        Self::made(arm, config, |model, fastest_mode| {
            Self::exactly(model, config, fastest_mode)
        })
    }

    /// What `convert` makes of the model, all checks passed.
    #[inline(always)]
    fn made(
        arm: &ArmParameters,
        config: &ControllerConfig,
        convert: impl FnOnce(&ArmModel<T>, DampingRate) -> Self,
    ) -> Result<Self, ConfigError> {
        match &ArmModel::new(arm) {
            Ok(model) => match config.validate(model) {
                Ok(fastest_mode) => Ok(convert(model, fastest_mode)),
                Err(error) => Err(error),
            },
            Err(error) => Err(ConfigError::Arm(*error)),
        }
    }

    /// The law within limits, without a check.
    #[inline(always)]
    pub(super) fn within_limits(
        arm: &ArmParameters,
        model: &ArmModel<T>,
        config: &ControllerConfig,
        fastest_mode: DampingRate,
    ) -> Self {
        let limits = joint_limits(arm, model, config.cycle_s, config.dead_cycles);
        let bounds = JointBounds::new(model, &limits);
        Self::converted(model, config, fastest_mode, within_limits(), &bounds)
    }

    /// The exact law, without a check.
    pub(super) fn exactly(
        arm: &ArmModel<T>,
        config: &ControllerConfig,
        fastest_mode: DampingRate,
    ) -> Self {
        Self::converted(arm, config, fastest_mode, exact(), &JointBounds::none())
    }

    /// No check. Behind a call, so that the parts are made in the place of the result and nowhere
    /// else.
    #[inline(never)]
    fn converted(
        arm: &ArmModel<T>,
        config: &ControllerConfig,
        fastest_mode: DampingRate,
        law: Law<T>,
        bounds: &JointBounds<T>,
    ) -> Self {
        let cycle_s = T::from_f64(config.cycle_s);
        Self {
            arm: *arm,
            law,
            levels: Levels::new(&config.tasks, arm, law.limits),
            capacity: config.tasks.capacity(),
            bounds: *bounds,
            compliance: Compliance::new(&config.null_space),
            observer_gain: JointVector::from(config.observer_gain.map(T::from_f64)),
            cycle_s,
            dead_cycles: config.dead_cycles,
            torque_step: arm.torque_rate_limit() * cycle_s,
            brake_step: arm.brake_rate_limit() * cycle_s,
            brake_rate: T::from_f64(brake_rate(config.cycle_s, config.dead_cycles)),
            fastest_mode,
        }
    }
}
