//! The state to explain, as JSON.

use std::path::Path;

use controller_core::gain::diagonal;
use controller_core::joint::{DOF, Vector3};
use controller_core::law::null_space as law;
use controller_core::ranges::GAIN_MAX;
use controller_core::task::orientation::Quaternion;
use controller_core::{Axes, Target, Task, TaskGains};
use serde::Deserialize;

use crate::controllers::TorqueLaw;
use cell::arm::joint_limits::JointLimitsSpec;
use cell::arm::robot::Robot;
use cell::invalid::Invalid;
use cell::names::Named;
use cell::ranges::{CYCLE_MS, DEAD_CYCLES, EXACT_ROWS, LEVELS, QUATERNION_NORM, Range};
use cell::reader;
use cell::scenario::{EquippedArm, LawSpec, LevelLimitsSpec, Mount, PointSpec, TaskSpec, ToolSpec};

/// K_I \[1/s\].
const OBSERVER_GAIN: Range<f64> = Range::new(0.0, GAIN_MAX);

/// Interval of the observer \[s\].
const INTERVAL_S: Range<f64> = Range::above(0.0, 10.0);

/// One control cycle. SI units, base-plate frame.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// The arm: a name, or an arm file.
    pub robot: Robot,
    /// How it is mounted; as its table says unless given.
    #[serde(default)]
    pub mount: Option<Mount>,
    /// What it carries at its flange.
    #[serde(default)]
    pub tool: Option<ToolSpec>,
    /// q \[rad\].
    pub q: [f64; DOF],
    /// dq \[rad/s\].
    pub dq: [f64; DOF],
    /// r \[Nm\]; not read where `observer` is given.
    #[serde(default)]
    pub residual: [f64; DOF],
    /// Task levels, highest priority first.
    pub levels: Vec<Level>,
    /// Null-space compliance.
    pub null_space: NullSpace,
    /// Law; hierarchical unless given.
    #[serde(default)]
    pub controller: Option<String>,
    /// Whether that one is within limits; unless given it is.
    #[serde(default)]
    pub law: Option<LawSpec>,
    /// Of the law within limits: what it may do with the joints.
    #[serde(default)]
    pub joint_limits: Option<JointLimitsSpec>,
    /// Of the law within limits: its cycle \[ms\].
    #[serde(default = "default_cycle_ms")]
    pub cycle_ms: f64,
    /// Of the law within limits: cycles between measurement and torque.
    #[serde(default)]
    pub dead_cycles: u8,
    /// Of the law within limits: what it remembers of the previous cycle.
    #[serde(default)]
    pub before: Option<Before>,
    /// Asks for an observer step before the law.
    #[serde(default)]
    pub observer: Option<ObserverStep>,
}

/// A task level: desired motion and diagonal gains, one entry per axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Position or orientation.
    #[serde(default)]
    pub task: TaskSpec,
    /// Controlled point.
    pub point: PointSpec,
    /// Controlled axes, such as "xyz".
    pub axes: String,
    /// x_d \[m\]; of an orientation the quaternion w, x, y, z.
    pub x: Vec<f64>,
    /// dx_d \[m/s\].
    pub dx: Vec<f64>,
    /// ddx_d \[m/s2\].
    pub ddx: Vec<f64>,
    /// K_p \[1/s2\].
    pub kp: Vec<f64>,
    /// K_d \[1/s\].
    pub kd: Vec<f64>,
    /// Of the law within limits: near singularities and far from the target.
    #[serde(default)]
    pub limits: Option<LevelLimitsSpec>,
}

/// Null-space compliance, diagonal.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NullSpace {
    /// q_d \[rad\].
    pub q_d: [f64; DOF],
    /// K_q \[Nm/rad\].
    pub stiffness: [f64; DOF],
    /// D \[Nms/rad\].
    pub damping: [f64; DOF],
    /// c \[1/s\] of D = c M in the place of `damping`.
    #[serde(default)]
    pub damping_rate: Option<f64>,
    /// K of (14) \[1/s\], for the acceleration-level controllers.
    #[serde(default = "default_rate_gain")]
    pub rate_gain: [f64; DOF],
}

fn default_rate_gain() -> [f64; DOF] {
    [10.0; DOF]
}

fn default_cycle_ms() -> f64 {
    2.0
}

/// What the law within limits remembers of the previous cycle; each key unless given: nothing.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Before {
    /// Torque \[Nm\] that acted, from which the next one may not differ by more than the rate
    /// limit.
    #[serde(default)]
    pub torque: Option<[f64; DOF]>,
    /// dev \[m/s2\] of each level.
    #[serde(default)]
    pub disturbance: Vec<f64>,
    /// x of the way out.
    #[serde(default)]
    pub way_out: Option<[f64; DOF]>,
}

/// What the observer remembers of the previous cycle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObserverStep {
    /// p \[Nms\].
    pub momentum_prev: [f64; DOF],
    /// u = tau + C^T dq - g \[Nm\].
    pub input_prev: [f64; DOF],
    /// r \[Nm\].
    pub residual_prev: [f64; DOF],
    /// K_I \[1/s\].
    pub gain: [f64; DOF],
    /// Interval \[s\].
    pub h: f64,
}

impl Input {
    /// Reads and checks a state from `folder`, in which an arm file is looked for.
    ///
    /// # Errors
    /// The first field that cannot be used, by its path.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, Invalid> {
        if text.trim().is_empty() {
            let allowed = "a JSON object, as in docs/explain.md";
            return Err(Invalid::new("state", "empty", allowed));
        }
        reader::json(text, |state: &mut Self| {
            state.robot.find(folder)?;
            state.validate()
        })
    }

    fn validate(&self) -> Result<(), Invalid> {
        let arm = self.arm()?;
        for (&q, link) in self.q.iter().zip(&arm.parameters.links) {
            let [min, max] = link.position_range;
            Range::new(min, max).check(format_args!("q of {}", link.name), q)?;
        }
        if let Some(name) = &self.controller {
            TorqueLaw::from_name(name)?;
        }
        if self.law == Some(LawSpec::WithinLimits) && !self.is_within_limits() {
            let allowed = "exact with a controller other than hierarchical";
            return Err(Invalid::new("law", "within-limits", allowed));
        }
        CYCLE_MS.check("cycle_ms", self.cycle_ms)?;
        DEAD_CYCLES.check("dead_cycles", self.dead_cycles)?;
        if let Some(limits) = &self.joint_limits {
            limits
                .validate()
                .map_err(|error| error.in_table("joint_limits"))?;
        }
        if self.levels.is_empty() {
            return Err(Invalid::new("levels", "none", LEVELS));
        }
        let mut rows = 0;
        for (index, level) in self.levels.iter().enumerate() {
            rows += level
                .validate(index, &arm)
                .map_err(|error| error.in_list("levels", index))?;
        }
        if !EXACT_ROWS.contains(rows) {
            let given = format!("{rows} rows together");
            return Err(Invalid::new("levels", given, EXACT_ROWS));
        }
        let disturbances = self.before.as_ref();
        let disturbances = disturbances.map_or(0, |before| before.disturbance.len());
        if disturbances > self.levels.len() {
            let given = format!("{disturbances} values");
            let allowed = format!("at most {}, one per level", self.levels.len());
            return Err(Invalid::new("disturbance", given, allowed).in_table("before"));
        }
        if let Some(observer) = &self.observer {
            observer
                .validate()
                .map_err(|error| error.in_table("observer"))?;
        }
        Ok(())
    }

    /// The arm as it stands.
    ///
    /// # Errors
    /// What of robot, mount and tool cannot be used.
    pub fn arm(&self) -> Result<EquippedArm, Invalid> {
        let (mount, tool) = (self.mount.as_ref(), self.tool.as_ref());
        let mut arm = EquippedArm::equipped(self.robot.table()?, mount, tool)?;
        if let Some(limits) = &self.joint_limits {
            arm.parameters.limits = limits.of_arm(&arm.parameters);
        }
        Ok(arm)
    }

    /// Whether the law is the one within limits.
    #[must_use]
    pub fn is_within_limits(&self) -> bool {
        self.law != Some(LawSpec::Exact) && self.controller() == TorqueLaw::Hierarchical
    }

    /// What the tasks leave free.
    #[must_use]
    pub fn compliance(&self) -> law::NullSpace {
        let NullSpace {
            stiffness,
            damping,
            damping_rate,
            ..
        } = &self.null_space;
        law::NullSpace {
            stiffness: diagonal(*stiffness),
            damping: match damping_rate {
                Some(rate) => law::NullDamping::Inertia(*rate),
                None => law::NullDamping::Joint(diagonal(*damping)),
            },
            posture: law::Posture::Constant,
        }
    }

    /// The law.
    #[must_use]
    pub fn controller(&self) -> TorqueLaw {
        let name = self.controller.as_deref().unwrap_or("hierarchical");
        TorqueLaw::from_name(name).unwrap_or(TorqueLaw::Hierarchical)
    }

    /// The core's tasks for `arm` and their targets.
    #[must_use]
    pub fn tasks(&self, arm: &EquippedArm) -> (Vec<Task>, Vec<Target<f64>>) {
        let levels = self.levels.iter().enumerate();
        levels.map(|(place, level)| level.task(place, arm)).unzip()
    }
}

impl ObserverStep {
    fn validate(&self) -> Result<(), Invalid> {
        for gain in self.gain {
            OBSERVER_GAIN.check("gain", gain)?;
        }
        INTERVAL_S.check("h", self.h).map(drop)
    }
}

impl Level {
    /// Checks point, axes and shapes; gives the number of rows.
    fn validate(&self, place: usize, arm: &EquippedArm) -> Result<usize, Invalid> {
        self.point.validate(arm)?;
        if let Some(limits) = &self.limits {
            limits
                .validate(place)
                .map_err(|error| error.in_table("limits"))?;
        }
        let Some(axes) = Axes::from_name(&self.axes) else {
            return Err(Invalid::new(
                "axes",
                format_args!("'{}'", self.axes),
                "letters of xyz in this order, such as xyz, xy, z",
            ));
        };
        let rows = axes.count();
        let coordinates = if self.task == TaskSpec::Orientation {
            4
        } else {
            rows
        };
        for (name, values, count) in [
            ("x", &self.x, coordinates),
            ("dx", &self.dx, rows),
            ("ddx", &self.ddx, rows),
            ("kp", &self.kp, rows),
            ("kd", &self.kd, rows),
        ] {
            if values.len() != count {
                let allowed = format!("{count} for axes \"{}\"", self.axes);
                return Err(Invalid::new(
                    name,
                    format_args!("{} values", values.len()),
                    allowed,
                ));
            }
        }
        if self.task == TaskSpec::Orientation {
            let norm = self.x.iter().map(|x| x * x).sum::<f64>().sqrt();
            QUATERNION_NORM.check("norm of x", norm)?;
        }
        Ok(rows)
    }

    fn task(&self, place: usize, arm: &EquippedArm) -> (Task, Target<f64>) {
        let axes = Axes::from_name(&self.axes).unwrap_or(Axes::XYZ);
        let spread = |values: &[f64]| {
            let mut values = values.iter();
            axes.flags().map(|on| {
                if on {
                    *values.next().unwrap_or(&0.0)
                } else {
                    0.0
                }
            })
        };
        let gains = TaskGains::diagonal(spread(&self.kp), spread(&self.kd));
        let vector = |values: &[f64]| Vector3::from(spread(values));
        let (task, target) = match self.task {
            TaskSpec::Position => (
                Task::position(self.point.resolve(arm), axes, gains),
                Target::Position {
                    x: vector(&self.x),
                    dx: vector(&self.dx),
                    ddx: vector(&self.ddx),
                },
            ),
            TaskSpec::Orientation => (
                Task::orientation(self.point.frame(arm), axes, gains),
                Target::Orientation {
                    q: Quaternion::from_iterator(self.x.iter().copied().chain([0.0; 4]).take(4)),
                    w: vector(&self.dx),
                    dw: vector(&self.ddx),
                },
            ),
        };
        let limits = self.limits.map(|limits| limits.of_level(place));
        (Task { limits, ..task }, target)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_says_the_ranges() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/explain.md");
        let text = std::fs::read_to_string(path).expect("the document");
        for row in [
            format!("| `gain` | 7 | 1/s | K_I, {OBSERVER_GAIN} |"),
            format!("| `h` | 1 | s | interval, {INTERVAL_S} |"),
        ] {
            assert!(text.contains(&row), "docs/explain.md has to contain {row}");
        }
    }
}
