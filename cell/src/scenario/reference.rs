//! Reference motions in files.

use controller_core::Target;
use controller_core::joint::Vector3;
use controller_core::task::orientation::{self, Quaternion};
use controller_core::task::trajectory::{Plane, Rotation, Trajectory};
use serde::Deserialize;

use super::stroke::Stroke;
use crate::invalid::Invalid;
use crate::ranges::{AXIS_LENGTH, DURATION_S, OFFSET_M, PERIOD_S, RADIUS_M, SWING_DEG};

/// Motion of a level's point about where it is at the start; in files a table that says its
/// kind.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum ReferenceSpec {
    /// Rest.
    Hold {},
    /// Straight move, then rest.
    Move {
        /// Displacement \[m\].
        by_m: [f64; 3],
        /// Time of the move \[s\].
        duration_s: f64,
    },
    /// Straight move, rest at its end, and back.
    ThereAndBack(ThereAndBack),
    /// A circle that reaches its radius in `growth_s`.
    Circle(Turn),
    /// The same circle, under the name for a radius that grows until the end.
    Spiral(Turn),
    /// An orientation that turns to and fro about an axis.
    Swing(Swing),
}

/// A straight move, there and back.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThereAndBack {
    /// Displacement \[m\] of the far end.
    pub by_m: [f64; 3],
    /// When it starts \[s\].
    #[serde(default)]
    pub from_s: f64,
    /// Time of one way \[s\].
    pub duration_s: f64,
    /// Time of the ramps of an even speed \[s\]; none: a quintic blend.
    pub ramp_s: Option<f64>,
    /// Rest at the far end \[s\].
    #[serde(default)]
    pub hold_s: f64,
}

/// Turning to and fro about an axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Swing {
    /// Axis, normalised when read.
    pub axis: [f64; 3],
    /// Of which frame it is one.
    #[serde(default)]
    pub axis_of: AxisOf,
    /// Largest angle \[deg\].
    pub angle_deg: f64,
    /// Time of one swing \[s\].
    pub period_s: f64,
    /// Time in which the angle grows \[s\].
    pub growth_s: f64,
}

/// The frame of the axis of a swing.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum AxisOf {
    /// The base plate.
    #[default]
    BasePlate,
    /// The frame that swings, such as that of the tool.
    Own,
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
            Self::Hold {} => Ok(()),
            Self::Move { by_m, duration_s } => {
                DURATION_S.check("duration_s", *duration_s)?;
                by_m.iter()
                    .try_for_each(|&x| OFFSET_M.check("by_m", x).map(drop))
            }
            Self::ThereAndBack(motion) => {
                motion.stroke().validate()?;
                motion
                    .by_m
                    .iter()
                    .try_for_each(|&x| OFFSET_M.check("by_m", x).map(drop))
            }
            Self::Circle(turn) | Self::Spiral(turn) => {
                RADIUS_M.check("radius_m", turn.radius_m)?;
                PERIOD_S.check("period_s", turn.period_s)?;
                PERIOD_S.check("growth_s", turn.growth_s).map(drop)
            }
            Self::Swing(swing) => {
                let norm = Vector3::from(swing.axis).norm();
                AXIS_LENGTH.check("axis length", norm)?;
                SWING_DEG.check("angle_deg", swing.angle_deg)?;
                PERIOD_S.check("period_s", swing.period_s)?;
                PERIOD_S.check("growth_s", swing.growth_s).map(drop)
            }
        }
    }

    /// Whether it is for orientations; none where it is for both kinds.
    #[must_use]
    pub fn is_rotation(&self) -> Option<bool> {
        match self {
            Self::Hold {} => None,
            Self::Swing(_) => Some(true),
            Self::Move { .. } | Self::ThereAndBack(_) | Self::Circle(_) | Self::Spiral(_) => {
                Some(false)
            }
        }
    }

    /// Target at time `t_s` from where the level is at the start. A motion that does not
    /// fit the level, which no valid scenario has, rests there.
    #[must_use]
    pub fn sample(&self, origin: &Target<f64>, t_s: f64) -> Target<f64> {
        match (self.trajectory(), self, origin) {
            (Some(trajectory), _, Target::Position { x, .. }) => trajectory.sample(x, t_s),
            (_, Self::ThereAndBack(motion), Target::Position { x, .. }) => motion.sample(x, t_s),
            (_, Self::Swing(swing), Target::Orientation { q, .. }) => {
                swing.rotation(q).sample(q, t_s)
            }
            _ => *origin,
        }
    }

    /// The motion of a point; none for others and for rest.
    fn trajectory(&self) -> Option<Trajectory<f64>> {
        match self {
            Self::Hold {} | Self::ThereAndBack(_) | Self::Swing(_) => None,
            Self::Move { by_m, duration_s } => Some(Trajectory::Move {
                by: (*by_m).into(),
                duration_s: *duration_s,
            }),
            Self::Circle(turn) | Self::Spiral(turn) => Some(turn.trajectory()),
        }
    }
}

impl ThereAndBack {
    /// When it goes and comes back.
    #[must_use]
    pub fn stroke(&self) -> Stroke {
        Stroke {
            from_s: self.from_s,
            duration_s: self.duration_s,
            ramp_s: self.ramp_s,
            hold_s: self.hold_s,
        }
    }

    fn sample(&self, origin: &Vector3<f64>, t_s: f64) -> Target<f64> {
        let by = Vector3::from(self.by_m);
        let [b, db, ddb] = self.stroke().share(t_s);
        Target::Position {
            x: origin + by * b,
            dx: by * db,
            ddx: by * ddb,
        }
    }
}

impl Swing {
    /// From the orientation `start`.
    fn rotation(&self, start: &Quaternion<f64>) -> Rotation<f64> {
        let axis = Vector3::from(self.axis).normalize();
        Rotation::Swing {
            axis: match self.axis_of {
                AxisOf::BasePlate => axis,
                AxisOf::Own => in_base_plate(start, &axis),
            },
            amplitude_rad: self.angle_deg.to_radians(),
            period_s: self.period_s,
            growth_s: self.growth_s,
        }
    }
}

/// A direction of a frame at `orientation`, in base-plate axes; of unit length.
fn in_base_plate(orientation: &Quaternion<f64>, direction: &Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = (*direction).into();
    let back = Quaternion::from([
        orientation[0],
        -orientation[1],
        -orientation[2],
        -orientation[3],
    ]);
    let turned = orientation::product(orientation, &Quaternion::from([0.0, x, y, z]));
    let turned = orientation::product(&turned, &back);
    Vector3::new(turned[1], turned[2], turned[3]).normalize()
}

impl Turn {
    fn trajectory(&self) -> Trajectory<f64> {
        Trajectory::Turn {
            plane: match self.plane {
                PlaneSpec::Xy => Plane::Xy,
                PlaneSpec::Xz => Plane::Xz,
                PlaneSpec::Yz => Plane::Yz,
            },
            radius_m: self.radius_m,
            period_s: self.period_s,
            growth_s: self.growth_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// A frame turned about its own axis is q r, about the base plate's r q.
    #[test]
    fn a_swing_is_about_an_axis_of_the_base_plate_or_its_own() {
        let start = orientation::product(
            &orientation::about_axis(&Vector3::z(), FRAC_PI_2),
            &orientation::about_axis(&Vector3::x(), 0.7),
        );
        let swing = |axis_of| {
            ReferenceSpec::Swing(Swing {
                axis: [0.0, 3.0, 4.0],
                axis_of,
                angle_deg: 20.0,
                period_s: 4.0,
                growth_s: 0.5,
            })
        };
        // A quarter of a swing: the whole angle.
        let turn = orientation::about_axis(&Vector3::new(0.0, 0.6, 0.8), 20_f64.to_radians());
        for (axis_of, expected) in [
            (AxisOf::BasePlate, orientation::product(&turn, &start)),
            (AxisOf::Own, orientation::product(&start, &turn)),
        ] {
            let Target::Orientation { q, .. } =
                swing(axis_of).sample(&Target::orientation(start), 1.0)
            else {
                panic!("an orientation");
            };
            assert!(orientation::chord(&q, &expected).norm() < 1e-15, "{q}");
        }
    }
}
