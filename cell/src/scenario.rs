//! An experiment as data: arm, start, task levels with their references,
//! null-space compliance, contacts and acceptance limits. The built-in scenarios are TOML files
//! like any other.

mod arm;
mod changes;
mod contact;
mod course;
mod event;
mod hand;
mod level;
mod limits;
mod metric;
mod near;
mod point;
mod push;
mod reference;
mod session;
mod stale;
mod stroke;
mod task;

use std::marker::PhantomData;
use std::path::Path;

use controller_core::gain::diagonal;
use controller_core::joint::{DOF, JointVector};
use controller_core::law::null_space::{NullDamping, NullSpace, Posture};
use controller_core::{Controller, ControllerConfig, Reference, Target, Task, TaskSet};
use serde::Deserialize;

use self::course::Changing;
use crate::arm::joint_limits::JointLimitsSpec;
use crate::arm::robot::Robot;
use crate::file::{self, is_path};
use crate::invalid::Invalid;
use crate::keys::allowed::{And, Choice, Count, NameOf, Said, Simple};
use crate::keys::keys;
use crate::keys::words::plain_choice;
use crate::names::{MeasurementKind, Named, PlantKind};
use crate::ranges::{
    CYCLE_MS, DEAD_CYCLES, DURATION_S, GAIN, LEVELS, LIMIT, RATE_GAIN, ROWS, Range,
};
use crate::reader;

pub use arm::{EquippedArm, Mount, TOOL_POINT, ToolSpec};
pub use changes::CHANGES;
pub use contact::Interval;
pub use course::{TimedChange, TimedTransition};
pub(crate) use event::EVENTS;
pub use event::Event;
pub use hand::{Direction, Hand};
pub use level::{AxisGain, LevelSpec};
pub use limits::NEAR_LIMITS;
pub use metric::{Metric, Unit};
pub use near::{LawSpec, LevelLimitsSpec};
pub(crate) use point::OnLink;
pub use point::PointSpec;
pub use push::Push;
pub(crate) use reference::KINDS;
pub use reference::{AxisOf, ReferenceSpec};
pub use session::{Events, ScenarioSource};
pub use stale::{AfterStaleSpec, StaleSpec};
pub use stroke::Stroke;
pub use task::TaskSpec;

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

keys! {
    /// An experiment, as in its file.
    #[derive(Clone, Debug)]
    pub struct Scenario {
        /// Name, also of the output folder.
        pub name: String, "", Simple;
        /// The arm: a table of the crate [`arms`](../arms/src/lib.rs), on the realistic plant as
        /// [plants.md](plants.md) says, or an [arm file](arms.md) from the folder of the scenario.
        pub robot: Robot, "", Said("an [arm that has a name](#arms-that-have-a-name), or an arm file such as `\"my_arm.toml\"`");
        /// How the base plate stands.
        pub mount: Option<Mount> = None => "as the arm's table says", "", Said(TABLE);
        /// What is fixed to the flange, of plant and controller.
        pub tool: Option<ToolSpec> = None => "none", "", Said(TABLE);
        /// The law of the controller ([limits.md](limits.md)); an integrated posture needs `"exact"`.
        pub law: LawSpec = LawSpec::WithinLimits, "", Choice;
        /// What the law may do with the joints.
        pub joint_limits: Option<JointLimitsSpec> = None => "by the arm", "", Said(TABLE);
        /// Length.
        pub duration_s: f64, "s", DURATION_S;
        /// Control cycle.
        pub cycle_ms: f64, "ms", CYCLE_MS;
        /// Posture at the start, at rest; also q_d of the null space.
        pub start_deg: [f64; DOF], "deg", Said("7, within the ranges of the joints");
        /// Task levels, highest priority first.
        pub levels as "level": Vec<LevelSpec>, "", And(Count(LEVELS, "levels"), ROWS_TOGETHER);
        /// Compliance of what the tasks leave.
        pub null_space: NullSpaceSpec, "", Said(TABLE);
        /// External-torque observer.
        pub observer: ObserverSpec, "", Said(TABLE);
        /// Tasks and gains that change on the way ([changing-tasks.md](changing-tasks.md)).
        pub events as "event": Vec<Event> = Vec::new() => "none", "", Said(TABLES);
        /// Scripted pushes.
        pub pushes as "contact": Vec<Push> = Vec::new() => "none", "", Said(TABLES);
        /// Hands of a person, which push and give way.
        pub hands as "hand": Vec<Hand> = Vec::new() => "none", "", Said(TABLES);
        /// Acceptance limits: what a run must stay below.
        pub limits as "limit": Vec<Limit> = Vec::new() => "none", "", Said(TABLES);
    }
}

const TABLE: &str = "a table";
const TABLES: &str = "any number of tables";
const ROWS_TOGETHER: &str = "together at most 12 axes, with the exact law 7";

keys! {
    /// Compliance of the null space.
    #[derive(Clone, Debug)]
    pub struct NullSpaceSpec {
        /// K_q, diagonal.
        pub stiffness: [f64; DOF], "Nm/rad", GAIN;
        /// D, diagonal.
        pub damping: [f64; DOF], "Nms/rad", GAIN;
        /// c of D = c M, which takes the place of `damping` in a loop with dead time and over FRI.
        pub damping_rate: f64 = 10.0, "1/s", GAIN;
        /// Where q_d comes from: the start posture, or the integral (51) with the coupling of
        /// moving levels or as printed; the integrals drift ([errata.md](errata.md), 8), and `run`
        /// says before how far.
        pub posture: PostureSpec = PostureSpec::Constant, "", Choice;
        /// K of (14), for the acceleration-level controllers.
        pub rate_gain: f64 = 10.0, "1/s", RATE_GAIN;
    }
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

plain_choice!(PostureSpec);

impl PostureSpec {
    fn of_core(self) -> Posture {
        match self {
            Self::Constant => Posture::Constant,
            Self::IntegralCoupled => Posture::IntegralCoupled,
            Self::IntegralUncoupled => Posture::IntegralUncoupled,
        }
    }
}

keys! {
    /// External-torque observer.
    #[derive(Clone, Debug)]
    pub struct ObserverSpec {
        /// K_I, of every joint.
        pub gain: f64, "1/s", GAIN;
    }
}

keys! {
    /// An acceptance limit, for one plant with or without contacts.
    #[derive(Clone, Debug)]
    pub struct Limit {
        /// Of runs on this plant.
        pub plant: String, "", NameOf::<PlantKind>(PhantomData);
        /// Of runs with contacts, or without.
        pub contacts: bool, "", Choice;
        /// Of runs in which the controller sees the arm so.
        pub measurement: String = MeasurementKind::Direct.name().to_string(), "",
            NameOf::<MeasurementKind>(PhantomData);
        /// Of runs with so many cycles of dead time.
        pub dead_cycles: usize = 0, "", Range::new(0, DEAD_CYCLES.max as usize);
        /// What is judged: error of a level as rms, as maximum, or as the plateau of the worst contact.
        pub metric: String, "",
            Said("`\"levelN_rms_mm\"`, `\"levelN_max_mm\"`, `\"levelN_plateau_mm\"`; of an orientation `_mrad`");
        /// The metric passes below this, in its own unit.
        pub below: f64, "mm, mrad", LIMIT;
    }
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
        self.check_keys()?;
        let arm = &self.equipped()?;
        if let Some(limits) = &self.joint_limits {
            limits
                .validate()
                .map_err(|error| error.in_table("joint_limits"))?;
        }
        let ranges = arm.ranges_deg();
        for ((&angle, range), joint) in self.start_deg.iter().zip(ranges).zip(arm.joints()) {
            range.check(format_args!("start_deg of {joint}"), angle)?;
        }
        for (number, level) in self.levels.iter().enumerate() {
            level
                .validate(number, arm)
                .map_err(|error| error.in_list("level", number))?;
        }
        self.changes(0)?;
        let rows: usize = self.levels.iter().map(|level| level.axes.len()).sum();
        if !ROWS.contains(rows) {
            let given = format!("{rows} rows together");
            return Err(Invalid::new("level", given, ROWS));
        }
        self.null_space
            .check_keys()
            .map_err(|error| error.in_table("null_space"))?;
        self.observer
            .check_keys()
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
            limit.check_keys().map_err(place)?;
            Metric::parse(&limit.metric, &self.levels).map_err(place)?;
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
            arm.parameters.limits = spec.of_arm(&arm.parameters);
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
            tasks: self.task_set(&tasks)?,
            null_space: NullSpace {
                stiffness: diagonal(self.null_space.stiffness),
                damping: if dead_cycles == 0 {
                    NullDamping::Joint(diagonal(self.null_space.damping))
                } else {
                    NullDamping::Inertia(self.null_space.damping_rate)
                },
                posture: self.null_space.posture.of_core(),
            },
            observer_gain: [self.observer.gain; DOF],
            cycle_s: self.cycle_s(),
            dead_cycles,
        })
    }

    /// The events in the order of their times, for a loop with `dead_cycles` cycles between
    /// measurement and torque.
    ///
    /// # Errors
    /// The first event that cannot be, after those before it.
    pub fn changes(&self, dead_cycles: u8) -> Result<Vec<TimedChange>, Invalid> {
        self.changing().changes(dead_cycles)
    }

    /// The events as `controller`, of this scenario, is to begin them, in the order of their times.
    ///
    /// # Errors
    /// An event that the core refuses, for example one of tasks of the exact law.
    pub fn transitions(
        &self,
        controller: &Controller<f64>,
    ) -> Result<Vec<TimedTransition>, Invalid> {
        let prepared = self.changing().transitions(controller);
        prepared.map_err(|error| error.within(&self.name))
    }

    fn changing(&self) -> Changing<'_> {
        Changing {
            levels: &self.levels,
            events: &self.events,
            arm: self.arm(),
            posture: self.null_space.posture.of_core(),
        }
    }

    fn task_set(&self, tasks: &[Task]) -> Result<TaskSet, Invalid> {
        let set = TaskSet::new(tasks).map_err(|error| Invalid::line(error).within(&self.name))?;
        let absent = (0..).zip(&self.levels).filter(|(_, level)| level.absent);
        Ok(absent.fold(set, |set, (slot, _)| set.without(slot)))
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
