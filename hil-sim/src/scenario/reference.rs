//! Reference motions in files.

use controller_core::trajectory::{Plane, Trajectory};
use serde::Deserialize;

use crate::invalid::{Invalid, in_range, positive};

/// Motion of a level's point about where it is at the start.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ReferenceSpec {
    /// Rest.
    Hold,
    /// Straight move, then rest.
    Move {
        /// Displacement \[m\].
        by_m: [f64; 3],
        /// Time of the move \[s\].
        duration_s: f64,
    },
    /// A circle that reaches its radius in `growth_s`.
    Circle(Turn),
    /// A spiral: a circle whose radius takes all of `growth_s` to grow.
    Spiral(Turn),
}

/// Turning in a plane.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// Plane, first axis first.
    pub plane: PlaneSpec,
    /// Radius in the end \[m\].
    pub radius_m: f64,
    /// Time of one turn \[s\].
    pub period_s: f64,
    /// Time in which the radius grows \[s\].
    pub growth_s: f64,
}

/// A plane of two base-plate axes.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaneSpec {
    /// x, y.
    Xy,
    /// x, z.
    Xz,
    /// y, z.
    Yz,
}

impl ReferenceSpec {
    /// Checks the ranges.
    ///
    /// # Errors
    /// What is out of range.
    pub fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Hold => Ok(()),
            Self::Move { by_m, duration_s } => {
                positive("duration_s", *duration_s, 3600.0)?;
                by_m.iter()
                    .try_for_each(|&x| in_range("by_m", x, -2.0, 2.0).map(drop))
            }
            Self::Circle(turn) | Self::Spiral(turn) => {
                in_range("radius_m", turn.radius_m, 0.0, 2.0)?;
                in_range("period_s", turn.period_s, 0.05, 3600.0)?;
                in_range("growth_s", turn.growth_s, 0.05, 3600.0).map(drop)
            }
        }
    }

    /// The core's trajectory.
    #[must_use]
    pub fn trajectory(&self) -> Trajectory<f64> {
        match self {
            Self::Hold => Trajectory::Hold,
            Self::Move { by_m, duration_s } => Trajectory::Move {
                by: (*by_m).into(),
                duration_s: *duration_s,
            },
            Self::Circle(turn) | Self::Spiral(turn) => Trajectory::Turn {
                plane: match turn.plane {
                    PlaneSpec::Xy => Plane::Xy,
                    PlaneSpec::Xz => Plane::Xz,
                    PlaneSpec::Yz => Plane::Yz,
                },
                radius_m: turn.radius_m,
                period_s: turn.period_s,
                growth_s: turn.growth_s,
            },
        }
    }
}
