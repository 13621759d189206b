//! Reference motions in files.

use controller_core::Target;
use controller_core::joint::Vector3;
use controller_core::task::orientation::{self, Quaternion};
use controller_core::task::trajectory::{Plane, Rotation, Trajectory};
use serde::Deserialize;

use super::stroke::Stroke;
use super::task::TaskSpec;
use crate::invalid::Invalid;
use crate::keys::allowed::{And, Choice, Length, Said};
use crate::keys::words::plain_choice;
use crate::keys::{Key, keys};
use crate::ranges::{AXIS_LENGTH, DURATION_S, OFFSET_M, PERIOD_S, RADIUS_M, SWING_DEG, TIME_S};

/// Motion of a level's point about where it is at the start; in files a table that says its
/// kind.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum ReferenceSpec {
    /// Rest.
    Hold {},
    /// Straight move, then rest.
    Move(Straight),
    /// Straight move, rest at its end, and back.
    ThereAndBack(ThereAndBack),
    /// A circle that reaches its radius in `growth_s`.
    Circle(Turn),
    /// The same circle, under the name for a radius that grows until the end.
    Spiral(Turn),
    /// An orientation that turns to and fro about an axis.
    Swing(Swing),
}

keys! {
    /// A straight move.
    #[derive(Clone, Debug)]
    pub struct Straight {
        /// Displacement.
        pub by_m: [f64; 3], "m", OFFSET_M;
        /// Time of the move, a quintic blend.
        pub duration_s: f64, "s", DURATION_S;
    }
}

keys! {
    /// A straight move, there and back.
    #[derive(Clone, Debug)]
    pub struct ThereAndBack {
        /// Displacement of the far end.
        pub by_m: [f64; 3], "m", OFFSET_M;
        /// When it starts.
        pub from_s: f64 = 0.0, "s", TIME_S;
        /// Time of one way.
        pub duration_s: f64, "s", And(DURATION_S, "at least twice `ramp_s`");
        /// Ramps of the speed along a cosine, even between them.
        pub ramp_s: Option<f64> = None => "a quintic blend", "s",
            Said("above 0, at most half of `duration_s`");
        /// Rest at the far end.
        pub hold_s: f64 = 0.0, "s", TIME_S;
    }
}

keys! {
    /// Turning to and fro about an axis.
    #[derive(Clone, Debug)]
    pub struct Swing {
        /// Axis, normalised when read.
        pub axis: [f64; 3], "", Length(AXIS_LENGTH);
        /// Of what the axis is one: of the base plate, or of the frame that swings, as it is at
        /// the start.
        pub axis_of: AxisOf = AxisOf::BasePlate, "", Choice;
        /// Largest angle.
        pub angle_deg: f64, "deg", SWING_DEG;
        /// Time of one swing.
        pub period_s: f64, "s", PERIOD_S;
        /// Time in which the angle grows.
        pub growth_s: f64, "s", PERIOD_S;
    }
}

plain_choice!(AxisOf);

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

keys! {
    /// Turning in a plane.
    #[derive(Clone, Debug)]
    pub struct Turn {
        /// It turns from the first base-plate axis to the second.
        pub plane: PlaneSpec, "", Choice;
        /// Radius in the end.
        pub radius_m: f64, "m", RADIUS_M;
        /// Time of one turn.
        pub period_s: f64, "s", PERIOD_S;
        /// Time in which the radius grows.
        pub growth_s: f64, "s", PERIOD_S;
    }
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

/// A kind of reference.
pub(crate) struct Kind {
    /// Its word.
    pub word: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
    /// Tasks that it is for.
    pub tasks: &'static [TaskSpec],
}

/// All of them.
pub(crate) const KINDS: [Kind; 6] = {
    const fn of_points(word: &'static str, keys: &'static [Key]) -> Kind {
        let tasks = &[TaskSpec::Position];
        Kind { word, keys, tasks }
    }
    [
        Kind {
            word: "hold",
            keys: &[],
            tasks: &[TaskSpec::Position, TaskSpec::Orientation],
        },
        of_points("move", Straight::KEYS),
        of_points("there-and-back", ThereAndBack::KEYS),
        of_points("circle", Turn::KEYS),
        of_points("spiral", Turn::KEYS),
        Kind {
            word: "swing",
            keys: Swing::KEYS,
            tasks: &[TaskSpec::Orientation],
        },
    ]
};

impl ReferenceSpec {
    /// Checks the ranges.
    ///
    /// # Errors
    /// What is out of range.
    pub fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Hold {} => Ok(()),
            Self::Move(straight) => straight.check_keys(),
            Self::ThereAndBack(motion) => {
                motion.check_keys()?;
                motion.stroke().validate()
            }
            Self::Circle(turn) | Self::Spiral(turn) => turn.check_keys(),
            Self::Swing(swing) => swing.check_keys(),
        }
    }

    fn kind(&self) -> &'static Kind {
        let [hold, straight, there_and_back, circle, spiral, swing] = &KINDS;
        match self {
            Self::Hold {} => hold,
            Self::Move(_) => straight,
            Self::ThereAndBack(_) => there_and_back,
            Self::Circle(_) => circle,
            Self::Spiral(_) => spiral,
            Self::Swing(_) => swing,
        }
    }

    /// Checks that it is a motion of what `task` tracks.
    pub(super) fn fits(&self, task: TaskSpec) -> Result<(), Invalid> {
        let kind = self.kind();
        if kind.tasks.contains(&task) {
            return Ok(());
        }
        let fitting = KINDS.iter().filter(|kind| kind.tasks.contains(&task));
        let words: Vec<_> = fitting.map(|kind| kind.word).collect();
        let tracked = match task {
            TaskSpec::Position => "a position",
            TaskSpec::Orientation => "an orientation",
        };
        let allowed = format!("{} for {tracked}", words.join(", "));
        Err(Invalid::new("reference", kind.word, allowed))
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
            Self::Move(straight) => Some(Trajectory::Move {
                by: straight.by_m.into(),
                duration_s: straight.duration_s,
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
