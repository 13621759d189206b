//! The controller: what is known before the first cycle, validated once.

use super::brake::brake_rate;
use super::config::ControllerConfig;
use super::measurement::believe_posture;
use super::stages::Law;
use crate::arm::{ArmModel, ArmParameters};
use crate::error::ConfigError;
use crate::fault::Fault;
use crate::joint::JointVector;
use crate::law::limits::bounds::JointBounds;
use crate::law::limits::joint_limits;
use crate::law::null_space::{Compliance, Posture};
use crate::law::sampling::DampingRate;
use crate::real::Real;
use crate::task::Levels;

/// The immutable part: arm, tasks, gains and limits, validated once and converted to
/// the precision of the cycle. One controller can drive any number of [`State`](super::State)s.
#[derive(Clone, Debug)]
pub struct Controller<T: Real> {
    pub(super) arm: ArmModel<T>,
    pub(super) law: Law<T>,
    pub(super) levels: Levels<T>,
    /// Of the law within limits.
    pub(super) bounds: JointBounds<T>,
    pub(super) compliance: Compliance<T>,
    pub(super) observer_gain: JointVector<T>,
    pub(super) cycle_s: T,
    pub(super) dead_cycles: u8,
    /// Largest change of the torque in a cycle that runs \[Nm\].
    pub(super) torque_step: JointVector<T>,
    /// The same in a cycle that brakes \[Nm\].
    pub(super) brake_step: JointVector<T>,
    /// c of the brake \[1/s\].
    pub(super) brake_rate: T,
    fastest_mode: DampingRate,
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
            let mut controller = Self::converted(model, config, fastest_mode, Law::within_limits());
            let limits = joint_limits(arm, model, config.cycle_s, config.dead_cycles);
            controller.bounds = JointBounds::new(model, &limits);
            controller
        })
    }

    /// The exact law of the paper: singularities, ranges and speed limits are not its
    /// business; torques are cut joint by joint. An image that makes controllers in one way
    /// only has the other law not in it.
    ///
    /// # Errors
    /// [`ConfigError`] names the first thing that cannot be.
    pub fn exact(arm: &ArmParameters, config: &ControllerConfig) -> Result<Self, ConfigError> {
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

    /// The exact law, without a check.
    pub(super) fn exactly(
        arm: &ArmModel<T>,
        config: &ControllerConfig,
        fastest_mode: DampingRate,
    ) -> Self {
        let mut controller = Self::converted(arm, config, fastest_mode, Law::exact());
        controller.levels.follow_every_error();
        controller
    }

    /// No check, no bounds of joints. Behind a call, so that the parts are made in the place of
    /// the result and nowhere else.
    #[inline(never)]
    fn converted(
        arm: &ArmModel<T>,
        config: &ControllerConfig,
        fastest_mode: DampingRate,
        law: Law<T>,
    ) -> Self {
        let cycle_s = T::from_f64(config.cycle_s);
        Self {
            arm: *arm,
            law,
            levels: Levels::new(&config.tasks, arm),
            bounds: JointBounds::none(),
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

    /// The arm.
    #[must_use]
    pub fn arm(&self) -> &ArmModel<T> {
        &self.arm
    }

    /// Whether its law is the one within limits.
    #[must_use]
    pub fn has_limits(&self) -> bool {
        self.law.limits
    }

    /// Number of levels: so many targets a [`Reference`](crate::Reference) needs.
    #[must_use]
    pub fn level_count(&self) -> usize {
        self.levels.as_slice().len()
    }

    /// Whether a cycle would believe that the arm is at `q` \[rad\]: within the range of every
    /// joint and [`POSITION_MARGIN`](crate::ranges::POSITION_MARGIN).
    ///
    /// # Errors
    /// The fault that it would end in.
    pub fn believe_posture(&self, q: &JointVector<T>) -> Result<(), Fault> {
        believe_posture(&self.arm, q)
    }

    /// Compliance of what the tasks leave.
    #[must_use]
    pub fn compliance(&self) -> &Compliance<T> {
        &self.compliance
    }

    /// The fastest null-space mode that the damping makes anywhere.
    #[must_use]
    pub fn fastest_mode(&self) -> DampingRate {
        self.fastest_mode
    }
}
