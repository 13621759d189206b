//! What is drawn for a run, in one list; docs/limits-study.md shows it.

use core::fmt;

use controller_core::joint::Vector3;

use crate::plant::Rng;
use crate::plant::noise::stream;

/// A number that is drawn for every run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Of which runs.
    pub runs: &'static str,
    /// What it is.
    pub what: &'static str,
    /// From what.
    pub drawn: Drawn,
    /// Its unit.
    pub unit: &'static str,
}

/// What a number is drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drawn {
    /// Evenly between two ends.
    Within([f64; 2]),
    /// The same, and either sign.
    Mirrored([f64; 2]),
    /// One of these.
    OneOf(&'static [f64]),
}

impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within([from, to]) => write!(f, "{from} to {to}"),
            Self::Mirrored([from, to]) => write!(f, "{from} to {to}, either sign"),
            Self::OneOf(values) => {
                let values: Vec<_> = values.iter().map(ToString::to_string).collect();
                write!(f, "one of {}", values.join(", "))
            }
        }
    }
}

macro_rules! parameters {
    ($($name:ident = $runs:literal, $what:literal, $drawn:expr, $unit:literal;)*) => {
        $(
            #[doc = $what]
            pub const $name: Parameter = Parameter {
                runs: $runs,
                what: $what,
                drawn: $drawn,
                unit: $unit,
            };
        )*
        /// All of them, in the order of the document.
        pub const ALL: &[Parameter] = &[$($name),*];
    };
}

use Drawn::{Mirrored, OneOf, Within};

parameters! {
    START_1 = "passes", "start, joint 1", Within([-60.0, 60.0]), "deg";
    START_2 = "passes", "start, joint 2", Mirrored([10.0, 50.0]), "deg";
    START_3 = "passes", "start, joint 3", Within([-40.0, 40.0]), "deg";
    START_4 = "passes", "start, joint 4", Within([-100.0, -60.0]), "deg";
    START_5 = "passes", "start, joint 5", Within([-60.0, 60.0]), "deg";
    START_6 = "passes", "start, joint 6", Mirrored([20.0, 70.0]), "deg";
    START_7 = "passes", "start, joint 7", Within([-60.0, 60.0]), "deg";
    OBLIQUE = "beyond reach", "slant of the way, as a share of a random vector across the ray",
        Within([0.0, 0.9]), "1";
    BEYOND = "beyond reach", "how far the way ends beyond the straight arm",
        Within([0.005, 0.06]), "m";
    BESIDE = "over the shoulder", "slant: how far it would pass beside the axis of joint 1",
        Within([-0.02, 0.02]), "m";
    LINE = "long line", "length", Within([0.3, 0.8]), "m";
    WRIST_1 = "wrist", "joint 1", Within([-0.5, 0.5]), "rad";
    WRIST_2 = "wrist", "joint 2", OneOf(&[0.5, 20.0, 35.0]), "deg";
    WRIST_3 = "wrist", "joint 3", Within([-0.3, 0.3]), "rad";
    WRIST_4 = "wrist", "joint 4", Within([-95.0, -70.0]), "deg";
    WRIST_5 = "wrist", "joint 5", OneOf(&[0.0, 45.0, 80.0, 88.0, 90.0, -90.0]), "deg";
    WRIST_5_OFF = "wrist", "joint 5, added", Within([-1.0, 1.0]), "deg";
    WRIST_6 = "wrist", "joint 6, which goes to its opposite", Within([25.0, 45.0]), "deg";
    WRIST_7 = "wrist", "joint 7", Within([-0.5, 0.5]), "rad";
    WRIST_4_MOVE = "wrist", "how far joint 4 is moved", Within([-0.2, 0.2]), "rad";
    WRIST_TIME = "wrist", "time of a way", Within([1.0, 2.0]), "s";
    RANDOM_START = "random", "start of every joint, of half its range", Within([-0.85, 0.85]), "1";
    RANDOM_GOAL = "random", "posture of each of two goals, of half the range of every joint",
        Within([-1.0, 1.0]), "1";
    RANDOM_POSTURE = "random", "q_d of every joint, of half its range", Within([-1.15, 1.15]), "1";
    RANDOM_TIME = "random", "time of each of two ways", Within([0.35, 0.6]), "s";
    PUSH_3 = "push", "joint 3, added to the start", Within([-0.3, 0.3]), "rad";
    PUSH_FORCE = "push", "force at the elbow, its direction random and flat", Within([50.0, 100.0]), "N";
}

/// The reach \[m\] of the arm whose lengths stand in this module; those of others are in
/// proportion.
pub const REACH_M: f64 = 0.868;

/// Speed of the passes between their ramps \[m/s\], and time of a ramp \[s\].
pub const SPEED: f64 = 0.3;
/// See [`SPEED`].
pub const RAMP_S: f64 = 0.15;

/// Numbers for one run.
#[derive(Clone, Debug)]
pub struct Draw(Rng);

impl Draw {
    /// Of the run `number` of the set with the seed `seed`.
    #[must_use]
    pub fn new(seed: u64, number: usize) -> Self {
        Self(Rng::new(seed + number as u64, stream::STUDY))
    }

    /// One value, in the unit of the parameter.
    pub fn value(&mut self, parameter: &Parameter) -> f64 {
        match parameter.drawn {
            Within([from, to]) => self.within(from, to),
            Mirrored([from, to]) => self.within(from, to) * self.0.sign(),
            OneOf(values) => {
                let index = (self.0.uniform() * values.len() as f64) as usize;
                values[index.min(values.len() - 1)]
            }
        }
    }

    /// The same of an angle \[deg\], in rad.
    pub fn angle(&mut self, parameter: &Parameter) -> f64 {
        self.value(parameter).to_radians()
    }

    /// Evenly between two ends.
    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.uniform()
    }

    /// Three numbers of mean 0 and standard deviation 1.
    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.0.gaussian())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_shows_every_parameter() {
        let text = include_str!("../../../../docs/limits-study.md");
        let row = |p: &Parameter| format!("| {} | {} | {} | {} |", p.runs, p.what, p.drawn, p.unit);
        let rows: Vec<_> = ALL.iter().map(row).collect();
        let shown: Vec<_> = text
            .lines()
            .skip_while(|line| *line != "| runs | drawn | from | unit |")
            .skip(2)
            .take_while(|line| line.starts_with('|'))
            .collect();
        assert_eq!(shown, rows);
    }

    #[test]
    fn values_are_from_where_they_are_drawn() {
        let mut draw = Draw::new(1, 0);
        for parameter in ALL {
            for _ in 0..1000 {
                let value = draw.value(parameter);
                let inside = match parameter.drawn {
                    Within([from, to]) => (from..=to).contains(&value),
                    Mirrored([from, to]) => (from..=to).contains(&value.abs()),
                    OneOf(values) => values.contains(&value),
                };
                assert!(inside, "{}: {value}", parameter.what);
            }
        }
    }
}
