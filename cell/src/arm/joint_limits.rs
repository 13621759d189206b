//! What a file says of the limits of the joints.

use std::sync::Mutex;

use controller_core::arm::{ArmModel, ArmParameters, JointLimits};
use controller_core::joint::DOF;
use controller_core::law::limits::own_joint_limits;

use crate::invalid::Invalid;
use crate::keys::keys;
use crate::ranges::{JOINT_ACCELERATION, JOINT_GAIN, MARGIN_DEG, SPEED_SHARE};

/// What joints without own limits get.
const BY_THE_ARM: &str = "by the arm's table, or a [rule](limits.md)";

keys! {
    /// Limits of the joints, each in the place of what the arm says or a rule makes of it.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct JointLimitsSpec {
        /// alpha: most that is asked of a joint.
        pub acceleration: Option<[f64; DOF]> = None => BY_THE_ARM, "rad/s2", JOINT_ACCELERATION;
        /// A: braking before the end of a range.
        pub braking: Option<[f64; DOF]> = None => BY_THE_ARM, "rad/s2", JOINT_ACCELERATION;
        /// kv: how fast a speed comes to what it may be.
        pub speed_gain: Option<[f64; DOF]> = None => BY_THE_ARM, "1/s", JOINT_GAIN;
        /// k: speed towards an end per way to it.
        pub position_gain: Option<f64> = None => BY_THE_ARM, "1/s", JOINT_GAIN;
        /// Way that is kept before the end of a range.
        pub margin_deg: Option<f64> = None => BY_THE_ARM, "deg", MARGIN_DEG;
        /// Share of the speed limit that is used.
        pub speed_share: Option<f64> = None => BY_THE_ARM, "", SPEED_SHARE;
    }
}

impl JointLimitsSpec {
    /// # Errors
    /// A number outside its range.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.check_keys()
    }

    /// Of this arm, whatever the cycle; nothing of tables that make no arm.
    #[must_use]
    pub fn of_arm(&self, arm: &ArmParameters) -> Option<JointLimits> {
        if let Ok(complete) = self.complete() {
            return Some(complete);
        }
        let own = own(arm)?;
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

/// Arms that were asked last, with what they said: the rule takes milliseconds, and a run asks
/// often.
static ASKED: Mutex<Vec<(ArmParameters, JointLimits)>> = Mutex::new(Vec::new());

/// So many are remembered.
const REMEMBERED: usize = 8;

/// What the arm says of itself, or the rule; nothing of tables that make no arm.
fn own(arm: &ArmParameters) -> Option<JointLimits> {
    if let Some(limits) = arm.limits {
        return Some(limits);
    }
    // A panic elsewhere leaves a list that is whole.
    let mut asked = ASKED
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some((_, limits)) = asked.iter().find(|(known, _)| known == arm) {
        return Some(*limits);
    }
    let limits = own_joint_limits(arm, &ArmModel::<f64>::new(arm).ok()?);
    if asked.len() == REMEMBERED {
        asked.remove(0);
    }
    asked.push((*arm, limits));
    Some(limits)
}
