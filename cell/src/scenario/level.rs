//! One task level of a scenario.

use controller_core::{Axes, Task, TaskGains};
use serde::Deserialize;

use super::arm::EquippedArm;
use super::near::LevelLimitsSpec;
use super::point::PointSpec;
use super::reference::ReferenceSpec;
use crate::invalid::Invalid;
use crate::ranges::GAIN;

/// What a level tracks.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum TaskSpec {
    /// The position of the point.
    #[default]
    Position,
    /// The orientation of the frame that turns with the point ([`PointSpec::frame`]).
    Orientation,
}

/// One task level.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelSpec {
    /// Position or orientation.
    #[serde(default)]
    pub task: TaskSpec,
    /// Controlled point.
    pub point: PointSpec,
    /// Controlled base-plate axes, such as "xyz".
    pub axes: String,
    /// K_p \[1/s2\].
    pub stiffness: AxisGain,
    /// K_d \[1/s\].
    pub damping: AxisGain,
    /// What happens near singularities and far from the target.
    #[serde(default)]
    pub limits: Option<LevelLimitsSpec>,
    /// Motion of the point.
    pub reference: ReferenceSpec,
}

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
    pub(super) fn validate(&self, arm: &EquippedArm) -> Result<(), Invalid> {
        self.point.validate(arm)?;
        let Some(axes) = Axes::from_name(&self.axes) else {
            return Err(Invalid::new(
                "axes",
                &self.axes,
                "letters of xyz in this order, such as xyz, xy, z",
            ));
        };
        for (name, gain) in [("stiffness", &self.stiffness), ("damping", &self.damping)] {
            if let AxisGain::PerAxis(values) = gain
                && values.len() != axes.count()
            {
                let allowed = format!("1 or {} for axes \"{}\"", axes.count(), self.axes);
                return Err(Invalid::new(
                    name,
                    format_args!("{} values", values.len()),
                    allowed,
                ));
            }
            for value in gain.values() {
                GAIN.check(name, value)?;
            }
        }
        if self.reference.is_rotation() == Some(self.task != TaskSpec::Orientation) {
            let (given, allowed) = match self.task {
                TaskSpec::Position => (
                    "swing",
                    "hold, move, there-and-back, circle, spiral for a position",
                ),
                TaskSpec::Orientation => ("a motion of a point", "hold, swing for an orientation"),
            };
            return Err(Invalid::new("reference", given, allowed));
        }
        if let Some(limits) = &self.limits {
            limits
                .validate()
                .map_err(|error| error.in_table("limits"))?;
        }
        self.reference
            .validate()
            .map_err(|error| error.in_table("reference"))
    }

    /// The core's task for `arm`, at the place `place`, counted from 0. The level must be valid.
    #[must_use]
    pub fn task(&self, place: usize, arm: &EquippedArm) -> Task {
        let axes = Axes::from_name(&self.axes).unwrap_or(Axes::XYZ);
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
        let gains = TaskGains::diagonal(spread(&self.stiffness), spread(&self.damping));
        let task = match self.task {
            TaskSpec::Position => Task::position(self.point.resolve(arm), axes, gains),
            TaskSpec::Orientation => Task::orientation(self.point.frame(arm), axes, gains),
        };
        Task {
            limits: self.limits.map(|limits| limits.of_level(place)),
            ..task
        }
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

impl AxisGain {
    fn values(&self) -> Vec<f64> {
        match self {
            Self::Uniform(value) => vec![*value],
            Self::PerAxis(values) => values.clone(),
        }
    }
}
