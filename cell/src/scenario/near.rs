//! What a scenario says of the law near limits.

use controller_core::task::LevelLimits;
use controller_core::{Controller, MakeController};
use serde::Deserialize;

use crate::invalid::Invalid;
use crate::ranges::{LEVEL_SPEED_M_S, MOBILITY};

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

/// Limits of a level, each in the place of what its rank calls for.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelLimitsSpec {
    /// z0 \[1/kg\].
    pub drive_mobility: Option<f64>,
    /// zr \[1/kg\].
    pub release_mobility: Option<f64>,
    /// v_err \[m/s\].
    pub error_speed_m_s: Option<f64>,
    /// vm \[m/s\].
    pub lost_speed_m_s: Option<f64>,
    /// zw \[1/kg\].
    pub stiff_mobility: Option<f64>,
}

impl LevelLimitsSpec {
    /// # Errors
    /// A number outside its range.
    pub(super) fn validate(&self) -> Result<(), Invalid> {
        for (name, range, value) in [
            ("drive_mobility", MOBILITY, self.drive_mobility),
            ("release_mobility", MOBILITY, self.release_mobility),
            ("error_speed_m_s", LEVEL_SPEED_M_S, self.error_speed_m_s),
            ("lost_speed_m_s", LEVEL_SPEED_M_S, self.lost_speed_m_s),
            ("stiff_mobility", MOBILITY, self.stiff_mobility),
        ] {
            if let Some(value) = value {
                range.check(name, value)?;
            }
        }
        Ok(())
    }

    /// Of the level at this place, counted from 0.
    pub(super) fn of_level(&self, place: usize) -> LevelLimits {
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
