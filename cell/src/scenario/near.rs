//! What a scenario says of the law near limits.

use controller_core::task::LevelLimits;
use controller_core::{Controller, MakeController};
use serde::Deserialize;

use crate::invalid::Invalid;
use crate::keys::allowed::And;
use crate::keys::keys;
use crate::keys::words::plain_choice;
use crate::ranges::{LEVEL_SPEED_M_S, MOBILITY, Range};

/// Which law the controller has.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum LawSpec {
    /// The law within limits.
    #[default]
    WithinLimits,
    /// The law of the paper alone.
    Exact,
}

impl LawSpec {
    /// What makes a controller with this law.
    #[must_use]
    pub fn maker(self) -> MakeController<f64> {
        match self {
            Self::WithinLimits => Controller::new,
            Self::Exact => Controller::exact,
        }
    }
}

plain_choice!(LawSpec);

/// What a level without own limits gets.
const BY_PRIORITY: &str = "by its [priority](limits.md)";

/// What is released is driven less, or it would be driven twice.
const LEAST_DRIVE: &str = "at least `release_mobility`";
const MOST_RELEASE: &str = "at most `drive_mobility`";

keys! {
    /// Limits of a level, each in the place of what its rank calls for.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct LevelLimitsSpec {
        /// z0: below this mobility a direction is driven less than the exact law does.
        pub drive_mobility: Option<f64> = None => BY_PRIORITY, "1/kg", And(MOBILITY, LEAST_DRIVE);
        /// zr: below this mobility a direction is given to the levels below.
        pub release_mobility: Option<f64> = None => BY_PRIORITY, "1/kg", And(MOBILITY, MOST_RELEASE);
        /// v_err: no error calls for more speed than this.
        pub error_speed_m_s: Option<f64> = None => BY_PRIORITY, "m/s", LEVEL_SPEED_M_S;
        /// vm: no more speed is asked for along a direction that is lost.
        pub lost_speed_m_s: Option<f64> = None => BY_PRIORITY, "m/s", LEVEL_SPEED_M_S;
        /// zw: where joints are at their bounds, a direction with this mobility resists them as
        /// much again as the arm does.
        pub stiff_mobility: Option<f64> = None => BY_PRIORITY, "1/kg", MOBILITY;
    }
}

impl LevelLimitsSpec {
    /// Of the level at this place, counted from 0.
    ///
    /// # Errors
    /// A number outside its range; a release above the drive.
    pub fn validate(&self, place: usize) -> Result<(), Invalid> {
        self.check_keys()?;
        // What is not given is not to blame.
        let limits = self.of_level(place);
        let (drive, release) = (limits.drive_mobility, limits.release_mobility);
        let checked = match self.release_mobility {
            Some(_) => Range::new(MOBILITY.min, drive).check("release_mobility", release),
            None => Range::new(release, MOBILITY.max).check("drive_mobility", drive),
        };
        checked.map(drop)
    }

    /// Of the level at this place, counted from 0.
    #[must_use]
    pub fn of_level(&self, place: usize) -> LevelLimits {
        let LevelLimits {
            drive_mobility,
            release_mobility,
            error_speed,
            lost_speed,
            stiff_mobility,
        } = match place {
            0 => LevelLimits::FIRST,
            _ => LevelLimits::BELOW,
        };
        LevelLimits {
            drive_mobility: self.drive_mobility.unwrap_or(drive_mobility),
            release_mobility: self.release_mobility.unwrap_or(release_mobility),
            error_speed: self.error_speed_m_s.unwrap_or(error_speed),
            lost_speed: self.lost_speed_m_s.unwrap_or(lost_speed),
            stiff_mobility: self.stiff_mobility.unwrap_or(stiff_mobility),
        }
    }
}
