//! Tasks as plain data: what a priority level tracks, and the set of all levels.

use super::Axes;
use super::level_limits::LevelLimits;
use crate::arm::{Link, LinkFrame, LinkPoint, distortion};
use crate::error::{ConfigError, Gain};
use crate::gain::{self, diagonal};
use crate::ranges::{DISTORTION_MAX, MAX_LEVELS, MAX_ROWS, POINT_OFFSET_MAX_M};

/// What a task tracks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub enum Tracked {
    /// The position of a point of the arm, along the axes of the task.
    Position(LinkPoint),
    /// The orientation of a frame of the arm, about the axes of the task.
    Orientation(LinkFrame),
}

/// Gains of a task, by rows; they act on acceleration. Only the rows and columns of
/// the controlled axes are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskGains {
    /// K_p of (12) \[1/s2\], symmetric positive definite on the controlled axes.
    pub stiffness: [[f64; 3]; 3],
    /// K_d of (12) \[1/s\], likewise.
    pub damping: [[f64; 3]; 3],
}

impl TaskGains {
    /// The same `stiffness` \[1/s2\] and `damping` \[1/s\] on every axis.
    #[must_use]
    pub const fn uniform(stiffness: f64, damping: f64) -> Self {
        Self::diagonal([stiffness; 3], [damping; 3])
    }

    /// One `stiffness` \[1/s2\] and `damping` \[1/s\] per axis x, y, z.
    #[must_use]
    pub const fn diagonal(stiffness: [f64; 3], damping: [f64; 3]) -> Self {
        Self {
            stiffness: diagonal(stiffness),
            damping: diagonal(damping),
        }
    }
}

/// A tracking task, one priority level. Plain `f64` data, usable as a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// The point or frame.
    pub tracked: Tracked,
    /// Base-plate axes that are controlled: along them, or for an orientation about
    /// them.
    pub axes: Axes,
    /// Gains.
    pub gains: TaskGains,
    /// What happens near singularities and far from the target; none: what the place of the
    /// level calls for, [`LevelLimits::FIRST`] or [`LevelLimits::BELOW`].
    pub limits: Option<LevelLimits>,
}

impl Task {
    /// Tracks the position of `point` along `axes`.
    #[must_use]
    pub const fn position(point: LinkPoint, axes: Axes, gains: TaskGains) -> Self {
        Self {
            tracked: Tracked::Position(point),
            axes,
            gains,
            limits: None,
        }
    }

    /// Tracks the orientation of `frame` about `axes`.
    #[must_use]
    pub const fn orientation(frame: LinkFrame, axes: Axes, gains: TaskGains) -> Self {
        Self {
            tracked: Tracked::Orientation(frame),
            axes,
            gains,
            limits: None,
        }
    }

    fn validate(&self, level: usize) -> Result<(), ConfigError> {
        match &self.tracked {
            Tracked::Position(point) => {
                for &value in &point.offset {
                    if !(-POINT_OFFSET_MAX_M..=POINT_OFFSET_MAX_M).contains(&value) {
                        return Err(ConfigError::PointOffset { level, value });
                    }
                }
            }
            Tracked::Orientation(frame) => {
                let value = distortion(&frame.rotation);
                if !(0.0..=DISTORTION_MAX).contains(&value) {
                    return Err(ConfigError::FrameRotation { level, value });
                }
            }
        }
        let (TaskGains { stiffness, damping }, used) = (&self.gains, self.axes.flags());
        gain::validate(Gain::TaskStiffness, level, stiffness, used)?;
        gain::validate(Gain::TaskDamping, level, damping, used)?;
        match &self.limits {
            Some(limits) => limits.validate(level),
            None => Ok(()),
        }
    }
}

/// Tasks in priority order, highest first: 1 to 7 levels of 1 to 3 rows, each valid,
/// together at most [`MAX_ROWS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskSet {
    tasks: [Task; MAX_LEVELS],
    count: usize,
}

impl TaskSet {
    /// Checks the tasks and keeps them in this order.
    ///
    /// # Errors
    /// [`ConfigError`] names the first thing that cannot be: too many levels or rows, a
    /// point too far from its link, a frame that is distorted, gains that are not finite, symmetric and positive
    /// definite.
    pub fn new(tasks: &[Task]) -> Result<Self, ConfigError> {
        Self::count(tasks)?;
        for (level, task) in (1..).zip(tasks) {
            task.validate(level)?;
        }
        Self::unvalidated(tasks)
    }

    /// The same without a look at points and gains.
    pub(crate) fn unvalidated(tasks: &[Task]) -> Result<Self, ConfigError> {
        const UNUSED: Task =
            Task::orientation(Link::L7.frame(), Axes::XYZ, TaskGains::uniform(0.0, 0.0));
        let count = Self::count(tasks)?;
        Ok(Self {
            tasks: core::array::from_fn(|level| *tasks.get(level).unwrap_or(&UNUSED)),
            count,
        })
    }

    /// Number of levels, where it and their rows are as they must be. Behind a call: it is in the
    /// flash once.
    #[inline(never)]
    fn count(tasks: &[Task]) -> Result<usize, ConfigError> {
        let levels = tasks.len();
        if !(1..=MAX_LEVELS).contains(&levels) {
            return Err(ConfigError::Levels { levels });
        }
        let rows = tasks.iter().map(|task| task.axes.count()).sum();
        if rows > MAX_ROWS {
            return Err(ConfigError::Rows { rows });
        }
        Ok(levels)
    }

    /// The tasks, highest priority first.
    #[must_use]
    pub fn tasks(&self) -> &[Task] {
        self.tasks.get(..self.count).unwrap_or(&[])
    }
}
