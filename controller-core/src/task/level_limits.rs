//! How a level behaves where it loses a direction of motion.

use crate::error::{ConfigError, LevelLimit};

/// What happens to a level near singularities and far from its target. Orientations count at
/// [`ORIENTATION_LENGTH`](crate::ranges::ORIENTATION_LENGTH) from their origin. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelLimits {
    /// z0 \[1/kg\]: below this mobility a direction is driven less than the exact law does. An
    /// arm that feels 1/z0 along it, 20 kg for 0.05, counts as heavy.
    pub drive_mobility: f64,
    /// zr \[1/kg\]: below this mobility a direction is given to the levels below, by and by.
    pub release_mobility: f64,
    /// v_err \[m/s\]: no error calls for more speed than this.
    pub error_speed: f64,
    /// vm \[m/s\]: no more speed is asked for along a direction that is lost.
    pub lost_speed: f64,
    /// zw \[1/kg\]: where joints are at their bounds, a direction with this mobility resists them
    /// as much again as the arm does.
    pub stiff_mobility: f64,
}

impl LevelLimits {
    /// Of the first level, unless a task says otherwise.
    pub const FIRST: Self = Self {
        drive_mobility: 0.05,
        release_mobility: 0.005,
        error_speed: 0.3,
        lost_speed: 0.15,
        stiff_mobility: 0.04,
    };

    /// Of the levels below it.
    pub const BELOW: Self = Self {
        drive_mobility: 0.01,
        release_mobility: 0.005,
        error_speed: 0.1,
        lost_speed: 0.03,
        stiff_mobility: 0.06,
    };

    /// By name, value and what is allowed.
    pub(super) fn validate(&self, level: usize) -> Result<(), ConfigError> {
        for (limit, value) in [
            (LevelLimit::DriveMobility, self.drive_mobility),
            (LevelLimit::ReleaseMobility, self.release_mobility),
            (LevelLimit::ErrorSpeed, self.error_speed),
            (LevelLimit::LostSpeed, self.lost_speed),
            (LevelLimit::StiffMobility, self.stiff_mobility),
        ] {
            let [min, mut max] = limit.range();
            if limit == LevelLimit::ReleaseMobility {
                // What is released is driven less, or it would be driven twice.
                max = self.drive_mobility;
            }
            if !(value >= min && value <= max) {
                return Err(ConfigError::LevelLimits {
                    level,
                    limit,
                    value,
                    allowed: [min, max],
                });
            }
        }
        Ok(())
    }
}
