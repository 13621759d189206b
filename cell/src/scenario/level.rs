//! One task level of a scenario.

use controller_core::{Axes, Task, TaskGains};
use serde::Deserialize;

use super::arm::EquippedArm;
use super::near::LevelLimitsSpec;
use super::point::{POINT, PointSpec};
use super::reference::ReferenceSpec;
use super::stale::StaleSpec;
use super::task::TaskSpec;
use crate::invalid::Invalid;
use crate::keys::allowed::{And, AxesOf, Choice, Said};
use crate::keys::keys;
use crate::keys::numbers::Numbers;
use crate::ranges::GAIN;

keys! {
    /// One task level.
    #[derive(Clone, Debug)]
    pub struct LevelSpec {
        /// What is tracked: the position of the point, or the orientation of the frame that turns
        /// with it, which is that of flange or tool for the points of these names, else the DH
        /// frame of the point's link.
        pub task: TaskSpec = TaskSpec::Position, "", Choice;
        /// Controlled point.
        pub point: PointSpec, "", Said(POINT);
        /// Controlled base-plate axes.
        pub axes: String, "", AxesOf;
        /// K_p.
        pub stiffness: AxisGain, "1/s2", And(GAIN, ONE_OR_EACH);
        /// K_d.
        pub damping: AxisGain, "1/s", And(GAIN, ONE_OR_EACH);
        /// Whether the level is not there before an [`[[event]]`](#event) adds it.
        pub absent: bool = false, "", Choice;
        /// What happens when its reference gets too old.
        pub stale: Option<StaleSpec> = None => "nothing", "", Said("a table");
        /// What happens near singularities and far from the target.
        pub limits: Option<LevelLimitsSpec> = None => "none", "", Said("a table");
        /// Motion about where the level is at the start.
        pub reference: ReferenceSpec, "", Said("a table that says its `kind`");
    }
}

/// What gains of several axes are.
const ONE_OR_EACH: &str = "one for all axes, or a list with one for each";

/// One gain for all axes of a task, or one for each.
#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, or a list with a number per axis"
)]
pub enum AxisGain {
    /// The same on every axis.
    Uniform(f64),
    /// In the order of the task's axes.
    PerAxis(Vec<f64>),
}

impl LevelSpec {
    pub(super) fn validate(&self, place: usize, arm: &EquippedArm) -> Result<(), Invalid> {
        self.point.validate(arm)?;
        self.check_keys()?;
        self.check_gain("stiffness", &self.stiffness)?;
        self.check_gain("damping", &self.damping)?;
        if let Some(stale) = &self.stale {
            stale.validate().map_err(|error| error.in_table("stale"))?;
        }
        self.reference.fits(self.task)?;
        if let Some(limits) = &self.limits {
            limits
                .validate(place)
                .map_err(|error| error.in_table("limits"))?;
        }
        self.reference
            .validate()
            .map_err(|error| error.in_table("reference"))
    }

    /// Whether a gain has a number for each axis, or one for all.
    pub(super) fn check_gain(&self, name: &str, gain: &AxisGain) -> Result<(), Invalid> {
        let count = self.axes().count();
        match gain {
            AxisGain::PerAxis(values) if values.len() != count => {
                let allowed = format!("1 or {count} for axes \"{}\"", self.axes);
                let given = format_args!("{} values", values.len());
                Err(Invalid::new(name, given, allowed))
            }
            _ => Ok(()),
        }
    }

    /// The controlled axes; all where they are not valid.
    fn axes(&self) -> Axes {
        Axes::from_name(&self.axes).unwrap_or(Axes::XYZ)
    }

    /// The core's task for `arm`, at the place `place`, counted from 0. The level must be valid.
    #[must_use]
    pub fn task(&self, place: usize, arm: &EquippedArm) -> Task {
        let (axes, gains) = (self.axes(), self.gains(&self.stiffness, &self.damping));
        let task = match self.task {
            TaskSpec::Position => Task::position(self.point.resolve(arm), axes, gains),
            TaskSpec::Orientation => Task::orientation(self.point.frame(arm), axes, gains),
        };
        Task {
            limits: self.limits.map(|limits| limits.of_level(place)),
            stale: self.stale.map(|stale| stale.of_core()),
            ..task
        }
    }

    /// Gains on the controlled axes. The level must be valid.
    #[must_use]
    pub fn gains(&self, stiffness: &AxisGain, damping: &AxisGain) -> TaskGains {
        let axes = self.axes();
        let spread = |gain: &AxisGain| match gain {
            AxisGain::Uniform(value) => [*value; 3],
            AxisGain::PerAxis(values) => {
                let mut values = values.iter();
                axes.flags().map(|on| {
                    if on {
                        *values.next().unwrap_or(&1.0)
                    } else {
                        1.0
                    }
                })
            }
        };
        TaskGains::diagonal(spread(stiffness), spread(damping))
    }

    /// "flange xyz".
    #[must_use]
    pub fn label(&self) -> String {
        match self.task {
            TaskSpec::Position => format!("{} {}", self.point.label(), self.axes),
            TaskSpec::Orientation => format!("{} about {}", self.point.label(), self.axes),
        }
    }
}

impl Numbers for AxisGain {
    fn how_many() -> String {
        String::new()
    }

    fn numbers(&self) -> &[f64] {
        match self {
            Self::Uniform(value) => value.numbers(),
            Self::PerAxis(values) => values,
        }
    }
}
