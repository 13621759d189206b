//! The state to explain, as JSON.

use controller_core::arm::{ArmParameters, LWR_IV};
use controller_core::joint::{DOF, Vector3};
use controller_core::ranges::MAX_ROWS;
use controller_core::task::orientation::Quaternion;
use controller_core::{Axes, Target, Task, TaskGains};
use serde::Deserialize;

use crate::controllers::TorqueLaw;
use cell::invalid::{Invalid, in_range};
use cell::names::Named;
use cell::reworded::reworded;
use cell::scenario::{PointSpec, TaskSpec, joints};

/// One control cycle. SI units, base-plate frame.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Name of the arm.
    pub robot: String,
    /// q \[rad\].
    #[serde(deserialize_with = "joints")]
    pub q: [f64; DOF],
    /// dq \[rad/s\].
    #[serde(deserialize_with = "joints")]
    pub dq: [f64; DOF],
    /// r \[Nm\]; not read where `observer` is given.
    #[serde(default, deserialize_with = "joints")]
    pub residual: [f64; DOF],
    /// Task levels, highest priority first.
    pub levels: Vec<Level>,
    /// Null-space compliance.
    pub null_space: NullSpace,
    /// Law; hierarchical unless given.
    #[serde(default)]
    pub controller: Option<String>,
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
}

/// Null-space compliance, diagonal.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NullSpace {
    /// q_d \[rad\].
    #[serde(deserialize_with = "joints")]
    pub q_d: [f64; DOF],
    /// K_q \[Nm/rad\].
    #[serde(deserialize_with = "joints")]
    pub stiffness: [f64; DOF],
    /// D \[Nms/rad\].
    #[serde(deserialize_with = "joints")]
    pub damping: [f64; DOF],
    /// K of (14) \[1/s\], for the acceleration-level controllers.
    #[serde(default = "default_rate_gain", deserialize_with = "joints")]
    pub rate_gain: [f64; DOF],
}

fn default_rate_gain() -> [f64; DOF] {
    [10.0; DOF]
}

/// What the observer remembers of the previous cycle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObserverStep {
    /// p \[Nms\].
    #[serde(deserialize_with = "joints")]
    pub momentum_prev: [f64; DOF],
    /// u = tau + C^T dq - g \[Nm\].
    #[serde(deserialize_with = "joints")]
    pub input_prev: [f64; DOF],
    /// r \[Nm\].
    #[serde(deserialize_with = "joints")]
    pub residual_prev: [f64; DOF],
    /// K_I \[1/s\].
    #[serde(deserialize_with = "joints")]
    pub gain: [f64; DOF],
    /// Interval \[s\].
    pub h: f64,
}

impl Input {
    /// Reads and checks a state.
    ///
    /// # Errors
    /// The first field that cannot be used, by its path.
    pub fn parse(text: &str) -> Result<Self, Invalid> {
        if text.trim().is_empty() {
            let allowed = "a JSON object, as in docs/explain.md";
            return Err(Invalid::new("state", "empty", allowed));
        }
        let mut deserializer = serde_json::Deserializer::from_str(text);
        let input: Self = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
            let path = error.path().to_string();
            let message = explained(text, &error.into_inner());
            if path == "." {
                message
            } else {
                message.within(path)
            }
        })?;
        deserializer
            .end()
            .map_err(|error| Invalid::line(error).within("after the state"))?;
        input.validate()?;
        Ok(input)
    }

    fn validate(&self) -> Result<(), Invalid> {
        if self.robot != LWR_IV.name {
            return Err(Invalid::name("robot", &self.robot, &[LWR_IV.name]));
        }
        for (joint, (&q, link)) in (1..).zip(self.q.iter().zip(&LWR_IV.links)) {
            let limit = link.position_limit;
            in_range(format_args!("q of joint {joint}"), q, -limit, limit)?;
        }
        finite("dq", &self.dq)?;
        finite("residual", &self.residual)?;
        for (name, values) in [
            ("null_space.q_d", &self.null_space.q_d),
            ("null_space.stiffness", &self.null_space.stiffness),
            ("null_space.damping", &self.null_space.damping),
            ("null_space.rate_gain", &self.null_space.rate_gain),
        ] {
            finite(name, values)?;
        }
        if let Some(name) = &self.controller {
            TorqueLaw::from_name(name)?;
        }
        if self.levels.is_empty() {
            return Err(Invalid::new("levels", "none", "1 to 7 levels"));
        }
        let mut rows = 0;
        for (index, level) in self.levels.iter().enumerate() {
            rows += level
                .validate()
                .map_err(|error| error.within(format_args!("levels[{index}]")))?;
        }
        if rows > MAX_ROWS {
            return Err(Invalid::new(
                "levels",
                format_args!("{rows} rows together"),
                "1 to 7",
            ));
        }
        if let Some(observer) = &self.observer {
            finite("observer.momentum_prev", &observer.momentum_prev)?;
            finite("observer.input_prev", &observer.input_prev)?;
            finite("observer.residual_prev", &observer.residual_prev)?;
            for gain in observer.gain {
                in_range("observer.gain", gain, 0.0, 1e9)?;
            }
            cell::invalid::positive("observer.h", observer.h, 10.0)?;
        }
        Ok(())
    }

    /// Tables of the arm.
    #[must_use]
    pub fn arm(&self) -> &'static ArmParameters {
        &LWR_IV
    }

    /// The law.
    #[must_use]
    pub fn controller(&self) -> TorqueLaw {
        let name = self.controller.as_deref().unwrap_or("hierarchical");
        TorqueLaw::from_name(name).unwrap_or(TorqueLaw::Hierarchical)
    }

    /// The core's tasks and their targets.
    #[must_use]
    pub fn tasks(&self) -> (Vec<Task>, Vec<Target<f64>>) {
        self.levels.iter().map(Level::task).unzip()
    }
}

impl Level {
    /// Checks point, axes and shapes; gives the number of rows.
    fn validate(&self) -> Result<usize, Invalid> {
        self.point.validate()?;
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
            finite(name, values)?;
        }
        if self.task == TaskSpec::Orientation {
            let norm = self.x.iter().map(|x| x * x).sum::<f64>().sqrt();
            in_range("norm of x", norm, 0.5, 2.0)?;
        }
        Ok(rows)
    }

    fn task(&self) -> (Task, Target<f64>) {
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
        let point = self.point.resolve();
        let vector = |values: &[f64]| Vector3::from(spread(values));
        match self.task {
            TaskSpec::Position => (
                Task::position(point, axes, gains),
                Target::Position {
                    x: vector(&self.x),
                    dx: vector(&self.dx),
                    ddx: vector(&self.ddx),
                },
            ),
            TaskSpec::Orientation => (
                Task::orientation(point.link, axes, gains),
                Target::Orientation {
                    q: Quaternion::from_iterator(self.x.iter().copied().chain([0.0; 4]).take(4)),
                    w: vector(&self.dx),
                    dw: vector(&self.ddx),
                },
            ),
        }
    }
}

fn finite(name: &str, values: &[f64]) -> Result<(), Invalid> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(Invalid::new(name, value, "finite numbers")),
        None => Ok(()),
    }
}

/// A JSON error with the word it stumbled over: JSON has no NaN or Infinity.
fn explained(text: &str, error: &serde_json::Error) -> Invalid {
    let line = text
        .lines()
        .nth(error.line().saturating_sub(1))
        .unwrap_or("");
    let at = error.column().saturating_sub(1).min(line.len());
    let delimiter = |c: char| c.is_whitespace() || "[]{},:\"".contains(c);
    let (before, after) = line.split_at_checked(at).unwrap_or((line, ""));
    let start = before.rfind(delimiter).map_or(0, |i| i + 1);
    let end = after.find(delimiter).map_or(line.len(), |i| at + i);
    let word = line.get(start..end).unwrap_or("");
    if error.is_syntax() && !word.is_empty() {
        return Invalid::new(
            format_args!("'{word}'"),
            error,
            "finite JSON numbers and text in quotes",
        );
    }
    let text = error.to_string();
    let (message, place) = text.rsplit_once(" at line ").unwrap_or((&text, ""));
    let reworded = reworded(message);
    if reworded.to_string() == message {
        return Invalid::line(error);
    }
    reworded.within(format_args!("line {place}"))
}
