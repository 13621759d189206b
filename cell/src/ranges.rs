//! What files and options may ask for, declared once for validation, help and messages.
//! The core's own ranges are in [`controller_core::ranges`].

use std::fmt;
use std::str::FromStr;

use controller_core::joint::DOF;
use controller_core::ranges::{
    CHANGE_RANGE_S, CYCLE_RANGE_S, DEAD_CYCLES_MAX, GRAVITY_MAX, JOINT_LIMIT_RANGE,
    LEVEL_SPEED_RANGE, MASS_MIN, MAX_LEVELS, MAX_ROWS, MOBILITY_RANGE, QUATERNION_NORMS,
    STALE_RANGE_S,
};

use crate::invalid::Invalid;

/// Numbers from one to another, as text "0.1 to 20" or "above 0, at most 3600".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range<T> {
    /// The least number, or the one that all are above.
    pub min: T,
    /// The largest number.
    pub max: T,
    above: bool,
}

/// What ranges are of.
pub trait Number: Copy + PartialOrd + fmt::Display + fmt::LowerExp + FromStr {}

impl<T: Copy + PartialOrd + fmt::Display + fmt::LowerExp + FromStr> Number for T {}

impl<T> Range<T> {
    /// Both ends included.
    pub const fn new(min: T, max: T) -> Self {
        let above = false;
        Self { min, max, above }
    }

    /// All above `min`.
    pub const fn above(min: T, max: T) -> Self {
        let above = true;
        Self { min, max, above }
    }
}

impl<T: Number> Range<T> {
    /// Whether `value` is one of the numbers; NaN is not.
    pub fn contains(&self, value: T) -> bool {
        let high_enough = value > self.min || (value == self.min && !self.above);
        high_enough && value <= self.max
    }

    /// `value` if it is one of the numbers.
    ///
    /// # Errors
    /// Names `thing`, the value and the range.
    pub fn check(&self, thing: impl fmt::Display, value: T) -> Result<T, Invalid> {
        if self.contains(value) {
            return Ok(value);
        }
        // Not with hundreds of zeros.
        let (full, brief) = (value.to_string(), format!("{value:e}"));
        let shown = if full.len() > 20 { brief } else { full };
        Err(Invalid::new(thing, shown, self))
    }
}

impl Range<f64> {
    /// The same of angles in rad, to a thousandth.
    #[must_use]
    pub fn in_radians(self) -> Self {
        let radians = |degrees: f64| (degrees.to_radians() * 1e3).trunc() / 1e3;
        Self {
            min: radians(self.min),
            max: radians(self.max),
            ..self
        }
    }
}

impl<T: fmt::Display> fmt::Display for Range<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min, max, above } = self;
        if *above {
            write!(f, "above {min}, at most {max}")
        } else {
            write!(f, "{min} to {max}")
        }
    }
}

const DURATION_MAX_S: f64 = 3600.0;

/// Largest gain a file may ask for; far beyond any use, far below overflow.
const GAIN_MAX: f64 = 1e6;

/// Length of an experiment, of a move, of a push by hand \[s\].
pub const DURATION_S: Range<f64> = Range::above(0.0, DURATION_MAX_S);

/// Time that a change of tasks or gains takes \[s\].
pub const CHANGE_S: Range<f64> = Range::new(CHANGE_RANGE_S[0], CHANGE_RANGE_S[1]);

/// Age from which on a reference is too old \[s\].
pub const STALE_S: Range<f64> = Range::new(STALE_RANGE_S[0], STALE_RANGE_S[1]);

/// Start and end of a contact \[s\].
pub const TIME_S: Range<f64> = Range::new(0.0, DURATION_MAX_S);

/// Control cycle \[ms\].
pub const CYCLE_MS: Range<f64> = Range::new(CYCLE_RANGE_S[0] * 1e3, CYCLE_RANGE_S[1] * 1e3);

/// Cycles between a torque and its effect.
pub const DEAD_CYCLES: Range<u8> = Range::new(0, DEAD_CYCLES_MAX);

/// Seed of everything that is drawn.
pub const SEED: Range<u64> = Range::new(0, u64::MAX);

/// Time that a program waits for the other \[s\].
pub const WAIT_S: Range<f64> = Range::above(0.0, 1e6);

/// Length of a scenario's name, which is also that of a folder.
pub const NAME_LETTERS: Range<usize> = Range::new(1, 64);

/// Number of task levels.
pub const LEVELS: Range<usize> = Range::new(1, MAX_LEVELS);

/// Number of rows of all levels together.
pub const ROWS: Range<usize> = Range::new(1, MAX_ROWS);

/// The same of the exact law.
pub const EXACT_ROWS: Range<usize> = Range::new(1, controller_core::ranges::EXACT_ROWS);

/// Number of a link.
pub const LINK: Range<usize> = Range::new(1, DOF);

/// A coordinate of a point in its link's frame, or of a move \[m\].
pub const OFFSET_M: Range<f64> = Range::new(-2.0, 2.0);

/// Roll, pitch or yaw \[deg\].
pub const ANGLE_DEG: Range<f64> = Range::new(-360.0, 360.0);

/// A length of an arm's table, a coordinate of its centres of mass and frames \[m\].
pub const LENGTH_M: Range<f64> = Range::new(-10.0, 10.0);

/// Mass of a link \[kg\].
pub const LINK_MASS_KG: Range<f64> = Range::new(MASS_MIN, 1000.0);

/// Gravitational acceleration \[m/s2\].
pub const GRAVITY_M_S2: Range<f64> = Range::new(0.0, GRAVITY_MAX);

/// An end of the range of a joint \[deg\]: with an offset of a turn and the margin beyond the
/// range the core's 100 turns.
pub const POSITION_DEG: Range<f64> = Range::new(-35_600.0, 35_600.0);

/// Largest speed of a joint \[deg/s\].
pub const JOINT_SPEED_DEG_S: Range<f64> = Range::above(0.0, 1e5);

/// Largest torque of a joint \[Nm\].
pub const TORQUE_NM: Range<f64> = Range::above(0.0, 1e5);

/// Largest change of the torque of a joint \[Nm/s\].
pub const TORQUE_RATE_NM_S: Range<f64> = Range::above(0.0, 1e9);

/// Inertia of a rotor as its joint feels it \[kg m2\].
pub const ROTOR_KG_M2: Range<f64> = Range::new(0.0, 100.0);

/// Coulomb friction of a joint \[Nm\].
pub const COULOMB_NM: Range<f64> = Range::new(0.0, 1e4);

/// Viscous friction of a joint \[Nms/rad\].
pub const VISCOUS_NMS: Range<f64> = Range::new(0.0, 1e4);

/// Speed within which Coulomb friction changes its sign \[rad/s\].
pub const SMOOTHING_RAD_S: Range<f64> = Range::above(0.0, 10.0);

/// A deceleration near the end of a range \[rad/s2\].
pub const DECELERATION_RAD_S2: Range<f64> = Range::above(0.0, 1e5);

/// A speed that is taken off near the end of a range \[rad/s\].
pub const APPROACH_MARGIN_RAD_S: Range<f64> = Range::new(0.0, 100.0);

/// Number of points of an arm that have a name, without the flange.
pub const POINTS: Range<usize> = Range::new(0, 32);

/// Number of postures of the sampling bound.
pub const DAMPING_POSTURES: Range<usize> = Range::new(0, 64);

/// Mass of a tool \[kg\].
pub const TOOL_MASS_KG: Range<f64> = Range::new(MASS_MIN, 100.0);

/// A moment or product of inertia of a tool \[kg m2\].
pub const INERTIA_KG_M2: Range<f64> = Range::new(-100.0, 100.0);

/// Gains that act on tasks and joints, and of the observer; of K_p \[1/s2\], K_d \[1/s\],
/// K_q \[Nm/rad\], D \[Nms/rad\], c and K_I \[1/s\].
pub const GAIN: Range<f64> = Range::above(0.0, GAIN_MAX);

/// A mobility at which something changes \[1/kg\].
pub const MOBILITY: Range<f64> = Range::new(MOBILITY_RANGE[0], MOBILITY_RANGE[1]);

/// A speed that a level is held to \[m/s\].
pub const LEVEL_SPEED_M_S: Range<f64> = Range::new(LEVEL_SPEED_RANGE[0], LEVEL_SPEED_RANGE[1]);

/// An acceleration that a joint is held to \[rad/s2\].
pub const JOINT_ACCELERATION: Range<f64> = Range::new(JOINT_LIMIT_RANGE[0], JOINT_LIMIT_RANGE[1]);

/// A gain with which a joint is kept within its bounds \[1/s\].
pub const JOINT_GAIN: Range<f64> = Range::new(JOINT_LIMIT_RANGE[0], JOINT_LIMIT_RANGE[1]);

/// Before the end of a range \[deg\].
pub const MARGIN_DEG: Range<f64> = Range::new(0.0, 11.0);

/// Share of a speed limit.
pub const SPEED_SHARE: Range<f64> = Range::new(0.1, 1.0);

/// K of (14) \[1/s\].
pub const RATE_GAIN: Range<f64> = Range::new(0.0, GAIN_MAX);

/// Radius of a circle \[m\].
pub const RADIUS_M: Range<f64> = Range::new(0.0, 2.0);

/// Period of a motion, and time in which it grows \[s\].
pub const PERIOD_S: Range<f64> = Range::new(0.05, DURATION_MAX_S);

/// Length of an axis, which is normalised.
pub const AXIS_LENGTH: Range<f64> = Range::new(1e-3, 1e3);

/// Largest angle of a swing \[deg\].
pub const SWING_DEG: Range<f64> = Range::new(-350.0, 350.0);

/// A coordinate of a scripted force \[N\].
pub const FORCE_N: Range<f64> = Range::new(-1e4, 1e4);

/// Stiffness of a hand \[N/m\].
pub const HAND_STIFFNESS_N_M: Range<f64> = Range::above(0.0, 1e5);

/// Damping of a hand \[Ns/m\].
pub const HAND_DAMPING_NS_M: Range<f64> = Range::new(0.0, 1e4);

/// Travel of a hand \[m\].
pub const HAND_TRAVEL_M: Range<f64> = Range::new(-1.0, 1.0);

/// Norm of a quaternion, which is normalised.
pub const QUATERNION_NORM: Range<f64> = Range::new(QUATERNION_NORMS[0], QUATERNION_NORMS[1]);

/// Acceptance limit \[mm\], \[mrad\].
pub const LIMIT: Range<f64> = Range::above(0.0, 1e9);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_refuse_what_is_not_a_number() {
        assert!(!SWING_DEG.contains(f64::NAN));
        assert!(!DURATION_S.contains(f64::INFINITY) && !DURATION_S.contains(0.0));
        assert!(TIME_S.contains(0.0) && TIME_S.contains(3600.0));
        for (value, shown) in [(-1.0, "-1"), (1e300, "1e300"), (f64::NAN, "NaN")] {
            let error = DURATION_S.check("--duration", value).expect_err(shown);
            assert_eq!(
                error.to_string(),
                format!("--duration: {shown}; allowed: above 0, at most 3600")
            );
        }
        let error = DEAD_CYCLES.check("dead_cycles", 9).expect_err("9");
        assert_eq!(error.to_string(), "dead_cycles: 9; allowed: 0 to 8");
    }
}
