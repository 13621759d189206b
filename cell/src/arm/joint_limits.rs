//! What a file says of the limits of the joints.

use controller_core::arm::{ArmModel, ArmParameters, JointLimits};
use controller_core::joint::DOF;
use controller_core::law::limits::joint_limits;
use serde::Deserialize;

use crate::invalid::Invalid;
use crate::ranges::{JOINT_ACCELERATION, JOINT_GAIN, MARGIN_DEG, SPEED_SHARE};

/// Limits of the joints, each in the place of what the arm says or a rule makes of it.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointLimitsSpec {
    /// alpha \[rad/s2\].
    pub acceleration: Option<[f64; DOF]>,
    /// A \[rad/s2\].
    pub braking: Option<[f64; DOF]>,
    /// kv \[1/s\].
    pub speed_gain: Option<[f64; DOF]>,
    /// k \[1/s\].
    pub position_gain: Option<f64>,
    /// Before the end of a range \[deg\].
    pub margin_deg: Option<f64>,
    /// Share of the speed limit.
    pub speed_share: Option<f64>,
}

impl JointLimitsSpec {
    /// # Errors
    /// A number outside its range.
    pub fn validate(&self) -> Result<(), Invalid> {
        for (name, range, values) in [
            ("acceleration", JOINT_ACCELERATION, &self.acceleration),
            ("braking", JOINT_ACCELERATION, &self.braking),
            ("speed_gain", JOINT_GAIN, &self.speed_gain),
        ] {
            for &value in values.iter().flatten() {
                range.check(name, value)?;
            }
        }
        for (name, range, value) in [
            ("position_gain", JOINT_GAIN, self.position_gain),
            ("margin_deg", MARGIN_DEG, self.margin_deg),
            ("speed_share", SPEED_SHARE, self.speed_share),
        ] {
            if let Some(value) = value {
                range.check(name, value)?;
            }
        }
        Ok(())
    }

    /// Of this arm, in cycles of `cycle_s` \[s\]; nothing of tables that make no arm.
    #[must_use]
    pub fn of_arm(&self, arm: &ArmParameters, cycle_s: f64) -> Option<JointLimits> {
        let model = ArmModel::<f64>::new(arm).ok()?;
        let own = joint_limits(arm, &model, cycle_s, 0);
        Some(JointLimits {
            acceleration: self.acceleration.unwrap_or(own.acceleration),
            braking: self.braking.unwrap_or(own.braking),
            speed_gain: self.speed_gain.unwrap_or(own.speed_gain),
            position_gain: self.position_gain.unwrap_or(own.position_gain),
            margin: self.margin_deg.map_or(own.margin, f64::to_radians),
            speed_share: self.speed_share.unwrap_or(own.speed_share),
        })
    }

    /// The limits where every key is given.
    ///
    /// # Errors
    /// The first key that is missing.
    pub fn complete(&self) -> Result<JointLimits, Invalid> {
        let missing =
            |key: &str| Invalid::new(key, "missing", "every key of joint_limits, or none");
        Ok(JointLimits {
            acceleration: self.acceleration.ok_or_else(|| missing("acceleration"))?,
            braking: self.braking.ok_or_else(|| missing("braking"))?,
            speed_gain: self.speed_gain.ok_or_else(|| missing("speed_gain"))?,
            position_gain: self.position_gain.ok_or_else(|| missing("position_gain"))?,
            margin: self
                .margin_deg
                .ok_or_else(|| missing("margin_deg"))?
                .to_radians(),
            speed_share: self.speed_share.ok_or_else(|| missing("speed_share"))?,
        })
    }
}
