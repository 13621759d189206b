//! An experiment as data: arm, start, task levels with their references,
//! null-space compliance, contacts and acceptance limits. The built-in scenarios are TOML files
//! like any other.

mod arm;
mod contact;
mod hand;
mod level;
mod limits;
mod metric;
mod near;
mod point;
mod push;
mod reference;
mod session;
mod stroke;

use std::path::Path;

use controller_core::gain::diagonal;
use controller_core::joint::{DOF, JointVector};
use controller_core::law::null_space::{NullDamping, NullSpace, Posture};
use controller_core::{ControllerConfig, Reference, Target, TaskSet};
use serde::Deserialize;

use crate::arm::joint_limits::JointLimitsSpec;
use crate::arm::robot::Robot;
use crate::file::{self, is_path};
use crate::invalid::Invalid;
use crate::names::{MeasurementKind, Named, PlantKind, simple};
use crate::ranges::{
    CYCLE_MS, DEAD_CYCLES, DURATION_S, GAIN, LEVELS, LIMIT, RATE_GAIN, ROWS, Range,
};
use crate::reader;

pub use arm::{EquippedArm, Mount, TOOL_POINT, ToolSpec};
pub use contact::Interval;
pub use hand::{Direction, Hand};
pub use level::{AxisGain, LevelSpec, TaskSpec};
pub use limits::NEAR_LIMITS;
pub use metric::{Metric, Unit};
pub use near::{LawSpec, LevelLimitsSpec};
pub use point::PointSpec;
pub use push::Push;
pub use reference::{AxisOf, ReferenceSpec};
pub use session::ScenarioSource;
pub use stroke::Stroke;

/// The scenarios that come with the program: name and TOML text.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("two-level", include_str!("../scenarios/two-level.toml")),
    ("case-1", include_str!("../scenarios/case-1.toml")),
    ("case-2", include_str!("../scenarios/case-2.toml")),
    ("hand", include_str!("../scenarios/hand.toml")),
    (
        "two-level-iiwa-14",
        include_str!("../scenarios/two-level-iiwa-14.toml"),
    ),
    (
        "two-level-fr3",
        include_str!("../scenarios/two-level-fr3.toml"),
    ),
    (
        "two-level-openarm",
        include_str!("../scenarios/two-level-openarm.toml"),
    ),
];

/// Their names, in a line.
#[must_use]
pub fn built_in_names() -> String {
    names().join(", ")
}

fn names() -> Vec<&'static str> {
    BUILT_IN.iter().map(|(name, _)| *name).collect()
}

/// An experiment, as in its file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name, also of the output folder.
    pub name: String,
    /// The arm: a name, or an arm file.
    pub robot: Robot,
    /// How it is mounted; as its table says unless given.
    #[serde(default)]
    pub mount: Option<Mount>,
    /// What it carries at its flange.
    #[serde(default)]
    pub tool: Option<ToolSpec>,
    /// Which law the controller has.
    #[serde(default)]
    pub law: LawSpec,
    /// What the law may do with the joints.
    #[serde(default)]
    pub joint_limits: Option<JointLimitsSpec>,
    /// Length \[s\].
    pub duration_s: f64,
    /// Control cycle \[ms\].
    pub cycle_ms: f64,
    /// Posture at the start \[deg\], at rest; also q_d of the null space.
    pub start_deg: [f64; DOF],
    /// Task levels, highest priority first.
    #[serde(rename = "level")]
    pub levels: Vec<LevelSpec>,
    /// Compliance of what the tasks leave.
    pub null_space: NullSpaceSpec,
    /// External-torque observer.
    pub observer: ObserverSpec,
    /// Scripted pushes.
    #[serde(rename = "contact", default)]
    pub pushes: Vec<Push>,
    /// Hands of a person, which give way.
    #[serde(rename = "hand", default)]
    pub hands: Vec<Hand>,
    /// What a run must stay below.
    #[serde(rename = "limit", default)]
    pub limits: Vec<Limit>,
}

/// Compliance of the null space.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NullSpaceSpec {
    /// K_q \[Nm/rad\], diagonal.
    pub stiffness: [f64; DOF],
    /// D \[Nms/rad\], diagonal.
    pub damping: [f64; DOF],
    /// c \[1/s\] of the inertia-shaped damping D = c M that takes the place of
    /// `damping` where the loop has dead time.
    #[serde(default = "default_damping_rate")]
    pub damping_rate: f64,
    /// Where q_d comes from.
    #[serde(default)]
    pub posture: PostureSpec,
    /// K of (14) \[1/s\], for the acceleration-level controllers.
    #[serde(default = "default_rate_gain")]
    pub rate_gain: f64,
}

fn default_measurement() -> String {
    MeasurementKind::Direct.name().to_string()
}

fn default_damping_rate() -> f64 {
    10.0
}

fn default_rate_gain() -> f64 {
    10.0
}

/// Where q_d comes from.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PostureSpec {
    /// The start posture.
    #[default]
    Constant,
    /// (51) with the coupling of moving levels.
    IntegralCoupled,
    /// (51) as printed.
    IntegralUncoupled,
}

/// External-torque observer.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObserverSpec {
    /// K_I \[1/s\], every joint.
    pub gain: f64,
}

/// An acceptance limit, for one plant with or without contacts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// "ideal" or "realistic".
    pub plant: String,
    /// With contacts or without.
    pub contacts: bool,
    /// "direct", "like-fri" or "fri".
    #[serde(default = "default_measurement")]
    pub measurement: String,
    /// For runs with so many cycles of dead time.
    #[serde(default)]
    pub dead_cycles: usize,
    /// Name of the metric, such as "level1_rms_mm".
    pub metric: String,
    /// The metric passes below this.
    pub below: f64,
}

impl Scenario {
    /// The built-in scenario of this name, or the file if it looks like a path.
    ///
    /// # Errors
    /// Unknown name, unreadable file, or anything in it that cannot be used.
    pub fn find(name: &str) -> Result<Self, Invalid> {
        if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
            return Self::parse(text).map_err(|error| error.within(name));
        }
        if !is_path(name) {
            return Err(Invalid::name("scenario", name, &names()));
        }
        let path = Path::new(name);
        let text = file::text(path).map_err(|error| {
            Invalid::new(
                "scenario file",
                name,
                format_args!("a readable TOML file ({error})"),
            )
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse_in(&text, folder).map_err(|error| error.within(name))
    }

    /// The TOML text of a built-in scenario.
    ///
    /// # Errors
    /// Unknown name.
    pub fn built_in_text(name: &str) -> Result<&'static str, Invalid> {
        let found = BUILT_IN.iter().find(|(known, _)| *known == name);
        found
            .map(|(_, text)| *text)
            .ok_or_else(|| Invalid::name("scenario", name, &names()))
    }

    /// Reads and checks a scenario; an arm file is looked for in the working directory.
    ///
    /// # Errors
    /// The first line or key that cannot be used.
    pub fn parse(text: &str) -> Result<Self, Invalid> {
        Self::parse_in(text, Path::new(""))
    }

    /// The same of a text from `folder`, in which an arm file is looked for.
    ///
    /// # Errors
    /// The first line or key that cannot be used.
    pub fn parse_in(text: &str, folder: &Path) -> Result<Self, Invalid> {
        reader::toml(text, |scenario: &mut Self| {
            scenario.robot.find(folder)?;
            scenario.validate()
        })
    }

    /// Checks every number, name and shape that the file format leaves open.
    ///
    /// # Errors
    /// The first key that cannot be used.
    pub fn validate(&self) -> Result<(), Invalid> {
        simple("name", &self.name)?;
        let arm = &self.equipped()?;
        if let Some(limits) = &self.joint_limits {
            limits
                .validate()
                .map_err(|error| error.in_table("joint_limits"))?;
        }
        DURATION_S.check("duration_s", self.duration_s)?;
        CYCLE_MS.check("cycle_ms", self.cycle_ms)?;
        for (&angle, link) in self.start_deg.iter().zip(&arm.parameters.links) {
            // Back from radians to the number of the data sheet.
            let [min, max] = link
                .position_range
                .map(|end| (end.to_degrees() * 1e9).round() / 1e9);
            let thing = format_args!("start_deg of {}", link.name);
            Range::new(min, max).check(thing, angle)?;
        }
        let levels = self.levels.len();
        if !LEVELS.contains(levels) {
            let given = format!("{levels} levels");
            return Err(Invalid::new("level", given, LEVELS));
        }
        for (number, level) in self.levels.iter().enumerate() {
            level
                .validate(arm)
                .map_err(|error| error.in_list("level", number))?;
        }
        let rows: usize = self.levels.iter().map(|level| level.axes.len()).sum();
        if !ROWS.contains(rows) {
            let given = format!("{rows} rows together");
            return Err(Invalid::new("level", given, ROWS));
        }
        self.null_space
            .validate(arm)
            .map_err(|error| error.in_table("null_space"))?;
        GAIN.check("gain", self.observer.gain)
            .map_err(|error| error.in_table("observer"))?;
        for (number, push) in self.pushes.iter().enumerate() {
            push.validate(arm)
                .map_err(|error| error.in_list("contact", number))?;
        }
        for (number, hand) in self.hands.iter().enumerate() {
            hand.validate(arm)
                .map_err(|error| error.in_list("hand", number))?;
        }
        for (number, limit) in self.limits.iter().enumerate() {
            let place = |error: Invalid| error.in_list("limit", number);
            PlantKind::from_name(&limit.plant).map_err(place)?;
            MeasurementKind::from_name(&limit.measurement).map_err(place)?;
            Metric::parse(&limit.metric, &self.levels).map_err(place)?;
            Range::new(0, DEAD_CYCLES.max.into())
                .check("dead_cycles", limit.dead_cycles)
                .map_err(place)?;
            LIMIT.check("below", limit.below).map_err(place)?;
        }
        Ok(())
    }

    fn equipped(&self) -> Result<EquippedArm, Invalid> {
        EquippedArm::equipped(self.robot.table()?, self.mount.as_ref(), self.tool.as_ref())
    }

    /// The arm as it stands. The scenario must be valid; of one that is not, the first arm
    /// there is.
    #[must_use]
    pub fn arm(&self) -> EquippedArm {
        let mut arm = self
            .equipped()
            .unwrap_or_else(|_| EquippedArm::of(arms::ALL[0]));
        if let Some(spec) = &self.joint_limits {
            arm.parameters.limits = spec.of_arm(&arm.parameters, self.cycle_s());
        }
        arm
    }

    /// Start posture \[rad\].
    #[must_use]
    pub fn start(&self) -> JointVector<f64> {
        JointVector::from(self.start_deg.map(f64::to_radians))
    }

    /// Control cycle \[s\].
    #[must_use]
    pub fn cycle_s(&self) -> f64 {
        self.cycle_ms / 1e3
    }

    /// Number of control cycles.
    #[must_use]
    pub fn cycles(&self) -> usize {
        // A duration of whole cycles is not to lose one to rounding.
        ((self.duration_s / self.cycle_s()) + 1e-6).floor().max(1.0) as usize
    }

    /// The configuration of the controller core for a loop with `dead_cycles`
    /// cycles between measurement and torque.
    ///
    /// # Errors
    /// Tasks that the core refuses.
    pub fn controller_config(&self, dead_cycles: u8) -> Result<ControllerConfig, Invalid> {
        let arm = self.arm();
        let tasks: Vec<_> = self
            .levels
            .iter()
            .enumerate()
            .map(|(place, level)| level.task(place, &arm))
            .collect();
        Ok(ControllerConfig {
            tasks: TaskSet::new(&tasks).map_err(|error| Invalid::line(error).within(&self.name))?,
            null_space: NullSpace {
                stiffness: diagonal(self.null_space.stiffness),
                damping: if dead_cycles == 0 {
                    NullDamping::Joint(diagonal(self.null_space.damping))
                } else {
                    NullDamping::Inertia(self.null_space.damping_rate)
                },
                posture: match self.null_space.posture {
                    PostureSpec::Constant => Posture::Constant,
                    PostureSpec::IntegralCoupled => Posture::IntegralCoupled,
                    PostureSpec::IntegralUncoupled => Posture::IntegralUncoupled,
                },
            },
            observer_gain: [self.observer.gain; DOF],
            cycle_s: self.cycle_s(),
            dead_cycles,
        })
    }

    /// The reference at time `t_s`, from where the levels are at the start, with
    /// the posture q_d `posture` \[rad\].
    #[must_use]
    pub fn reference(
        &self,
        origins: &[Target<f64>],
        posture: &JointVector<f64>,
        t_s: f64,
    ) -> Reference<f64> {
        let mut reference = Reference::hold(self.levels.len(), *posture);
        let levels = self.levels.iter().zip(origins);
        for (target, (level, origin)) in reference.targets_mut().iter_mut().zip(levels) {
            *target = level.reference.sample(origin, t_s);
        }
        reference
    }
}

impl NullSpaceSpec {
    fn validate(&self, arm: &EquippedArm) -> Result<(), Invalid> {
        let gains = self.stiffness.iter().zip(&self.damping);
        for (joint, (&stiffness, &damping)) in arm.joints().iter().zip(gains) {
            GAIN.check(format_args!("stiffness of {joint}"), stiffness)?;
            GAIN.check(format_args!("damping of {joint}"), damping)?;
        }
        GAIN.check("damping_rate", self.damping_rate)?;
        RATE_GAIN.check("rate_gain", self.rate_gain).map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_scenarios_are_valid_and_bear_their_name() {
        for (name, text) in BUILT_IN {
            assert_eq!(Scenario::parse(text).expect(name).name, *name);
        }
    }

    #[test]
    fn cycles_are_whole() {
        let mut scenario = Scenario::find("two-level").unwrap();
        assert_eq!(scenario.cycles(), 10_000);
        scenario.duration_s = 0.3;
        scenario.cycle_ms = 0.1;
        assert_eq!(scenario.cycles(), 3_000);
    }
}
