//! Tasks as plain data: what a priority level tracks, and the set of all levels.

use super::Axes;
use super::level_limits::LevelLimits;
use crate::arm::{Link, LinkFrame, LinkPoint, distortion};
use crate::error::{ConfigError, Gain};
use crate::fault::IndexSet;
use crate::gain::{self, diagonal};
use crate::ranges::{DISTORTION_MAX, MAX_LEVELS, MAX_ROWS, POINT_OFFSET_MAX_M, STALE_RANGE_S};

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

    pub(crate) fn validate(&self, level: usize, axes: Axes) -> Result<(), ConfigError> {
        let used = axes.flags();
        gain::validate(Gain::TaskStiffness, level, &self.stiffness, used)?;
        gain::validate(Gain::TaskDamping, level, &self.damping, used)
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
    /// What happens when its reference gets too old; none: nothing, it has no age.
    pub stale: Option<Stale>,
}

/// When the reference of a level is too old, and what then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stale {
    /// Largest age \[s\] of its target, see [`Reference::set_age`](super::Reference::set_age):
    /// from then on the level comes to rest as with [`Target::Hold`](super::Target::Hold).
    pub age_s: f64,
    /// What follows once it rests.
    pub then: AfterStale,
}

/// What a level with a stale reference does once it rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub enum AfterStale {
    /// It stays.
    Hold,
    /// It goes as a task that is removed, and comes back with a fresh reference. The exact law,
    /// whose tasks do not go, holds it.
    Release,
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
            stale: None,
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
            stale: None,
        }
    }

    pub(crate) fn validate(&self, level: usize) -> Result<(), ConfigError> {
        if let Some(Stale { age_s: value, .. }) = self.stale {
            let [min, max] = STALE_RANGE_S;
            if !(value >= min && value <= max) {
                return Err(ConfigError::StaleAge { level, value });
            }
        }
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
        self.gains.validate(level, self.axes)?;
        match &self.limits {
            Some(limits) => limits.validate(level),
            None => Ok(()),
        }
    }
}

/// Tasks in priority order, highest first: 1 to 7 levels of 1 to 3 rows, each valid,
/// together at most [`MAX_ROWS`]. Each has a slot, by which references and changes call it
/// whatever its priority becomes; at first the slots are in priority order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskSet {
    tasks: [Task; MAX_LEVELS],
    count: usize,
    /// Slots whose tasks are not in force at first.
    absent: IndexSet,
    capacity: Capacity,
}

/// What a task set has room for while tasks come and go. The time that a cycle takes at most is
/// that of so many rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Slots: each has a target in the reference, whether there is a task in it or not.
    pub levels: usize,
    /// Rows of all tasks together.
    pub rows: usize,
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
        let capacity = Self::count(tasks)?;
        Ok(Self {
            tasks: core::array::from_fn(|level| *tasks.get(level).unwrap_or(&UNUSED)),
            count: capacity.levels,
            absent: IndexSet::NONE,
            capacity,
        })
    }

    /// What the tasks take, where it is as it must be. Behind a call: it is in the flash once.
    #[inline(never)]
    fn count(tasks: &[Task]) -> Result<Capacity, ConfigError> {
        let levels = tasks.len();
        if !(1..=MAX_LEVELS).contains(&levels) {
            return Err(ConfigError::Levels { levels });
        }
        let rows = tasks.iter().map(|task| task.axes.count()).sum();
        if rows > MAX_ROWS {
            return Err(ConfigError::Rows { rows });
        }
        Ok(Capacity { levels, rows })
    }

    /// The same tasks with room for others.
    ///
    /// # Errors
    /// [`ConfigError::Capacity`] where it is less than the tasks take, or more than 7 levels and
    /// [`MAX_ROWS`].
    pub fn with_capacity(mut self, capacity: Capacity) -> Result<Self, ConfigError> {
        let Capacity { levels, rows } = self.capacity;
        let fits = (levels..=MAX_LEVELS).contains(&capacity.levels)
            && (rows..=MAX_ROWS).contains(&capacity.rows);
        if !fits {
            return Err(ConfigError::Capacity {
                given: [capacity.levels, capacity.rows],
                taken: [levels, rows],
            });
        }
        self.capacity = capacity;
        Ok(self)
    }

    /// The same tasks, but that of a slot is not in force at first: it has a target in the
    /// reference and room, and nothing else until it is added
    /// ([`Change::Add`](crate::Change::Add)). A slot that there is not changes nothing.
    #[must_use]
    pub fn without(mut self, slot: usize) -> Self {
        self.absent.insert_if(slot, true);
        self
    }

    /// Whether the task of a slot is in force at first.
    #[must_use]
    pub fn is_in_force(&self, slot: usize) -> bool {
        slot < self.count && !self.absent.contains(slot)
    }

    /// Number of tasks in force at first.
    pub fn count_in_force(&self) -> usize {
        (0..MAX_LEVELS)
            .filter(|&slot| self.is_in_force(slot))
            .count()
    }

    /// The slots, those in force at first before the others.
    pub(crate) fn slot_at(&self, position: usize) -> usize {
        let in_force = (0..MAX_LEVELS).filter(|&slot| self.is_in_force(slot));
        let others = (0..MAX_LEVELS).filter(|&slot| !self.is_in_force(slot));
        in_force.chain(others).nth(position).unwrap_or(0)
    }

    /// What it has room for; unless said otherwise what its tasks take.
    #[must_use]
    pub fn capacity(&self) -> Capacity {
        self.capacity
    }

    /// The tasks, highest priority first.
    #[must_use]
    pub fn tasks(&self) -> &[Task] {
        self.tasks.get(..self.count).unwrap_or(&[])
    }
}
