//! Levels in the precision of the controller.

use super::filters::{LevelFilters, LevelGains, Thresholds};
use super::level_limits::LevelLimits;
use super::order::Order;
use super::orientation::{self, Quaternion};
use super::set::{AfterStale, Task, TaskGains, TaskSet, Tracked};
use super::{Axes, Target};
use crate::arm::kinematics::{Kinematics, PointMotion};
use crate::arm::{ArmModel, Link, LinkFrame};
use crate::cells::Cells;
use crate::joint::{Matrix3, Vector3, in_turn, zeros};
use crate::ranges::{GIVE_BELOW, MAX_LEVELS, ORIENTATION_LENGTH, REACH_MARGIN_M};
use crate::real::Real;

/// What a level tracks, in the precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LevelPoint<T: Real> {
    /// A point with this offset \[m\] in the DH frame of its link.
    Position(Link, Vector3<T>),
    /// A frame that is turned so in the DH frame of its link.
    Orientation(Link, Quaternion<T>),
}

impl<T: Real> LevelPoint<T> {
    /// As it moves now: position or orientation and velocity, no acceleration.
    pub fn target(&self, kinematics: &Kinematics<T>) -> Target<T> {
        match self {
            Self::Position(link, offset) => {
                let PointMotion { x, dx } = kinematics.point(*link, offset);
                Target::Position {
                    x,
                    dx,
                    ddx: zeros(),
                }
            }
            Self::Orientation(link, turn) => {
                let motion = kinematics.link(*link);
                Target::Orientation {
                    q: orientation::of_frame(&motion.rotation, turn),
                    w: motion.angular_velocity,
                    dw: zeros(),
                }
            }
        }
    }
}

/// A task in the precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Level<T: Real> {
    /// Its slot, counted from 0: where a reference has its target, a status its bit.
    pub slot: usize,
    pub tracked: LevelPoint<T>,
    pub axes: Axes,
    /// How far from the shoulder a target may be \[m\]; of an orientation 0.
    pub reach: T,
    /// K_p and K_d.
    pub gains: LevelGains<T>,
    /// First row of the stack that is the level's.
    pub start: usize,
    /// Number of rows.
    pub size: usize,
    /// K_d of the rows, by rows.
    row_damping: [[T; 3]; 3],
    /// What a row is multiplied by to be a way \[m\]: of orientations
    /// [`ORIENTATION_LENGTH`], else 1.
    pub length: T,
    /// h: 1 in force, between 0 and 1 while it comes or goes.
    pub activation: T,
    pub filters: LevelFilters<T>,
    /// Without and with levels above.
    thresholds: [Thresholds<T>; 2],
    /// Age \[s\] from which on its reference is too old; 0: never.
    pub stale_after_s: T,
    /// Whether the level is released once it rests with such a reference.
    pub stale_releases: bool,
}

impl<T: Real> Level<T> {
    /// Of no task.
    pub const NONE: Self = Self {
        slot: 0,
        tracked: LevelPoint::Position(Link::L1, zeros()),
        axes: Axes::XYZ,
        reach: T::ZERO,
        gains: LevelGains::NONE,
        start: 0,
        size: 0,
        row_damping: [[T::ZERO; 3]; 3],
        length: T::ZERO,
        activation: T::ZERO,
        filters: LevelFilters::NONE,
        thresholds: [Thresholds::NONE; 2],
        stale_after_s: T::ZERO,
        stale_releases: false,
    };

    /// In a slot, without `shortens` as in [`Thresholds::new`]. It is the first level, of rows from
    /// the first on, until it has a place. Behind a call, so that it is made in the place of the
    /// result.
    #[inline(never)]
    pub fn new(task: &Task, slot: usize, arm: &ArmModel<T>, shortens: bool) -> Self {
        let (tracked, reach, length) = match task.tracked {
            Tracked::Position(point) => {
                let offset = Vector3::from(point.offset.map(T::from_f64));
                let reach = arm.reach(&point) + T::from_f64(REACH_MARGIN_M);
                (LevelPoint::Position(point.link, offset), reach, T::ONE)
            }
            Tracked::Orientation(LinkFrame { link, rotation }) => {
                // nalgebra takes columns.
                let rotation = nalgebra::Matrix3::from(rotation).transpose();
                let turn = orientation::unit(&orientation::of_rotation(&rotation));
                let turn = turn.map(T::from_f64);
                let length = T::from_f64(ORIENTATION_LENGTH);
                (LevelPoint::Orientation(link, turn), T::ZERO, length)
            }
        };
        let gains = gains_on(&task.gains, task.axes);
        let places = [(LevelLimits::FIRST, 0.0), (LevelLimits::BELOW, GIVE_BELOW)];
        let thresholds = places.map(|(of_place, give)| {
            Thresholds::new(&task.limits.unwrap_or(of_place), give, shortens)
        });
        Self {
            slot,
            tracked,
            axes: task.axes,
            reach,
            gains,
            start: 0,
            size: task.axes.count().min(3),
            row_damping: by_rows(&gains.damping, task.axes),
            length,
            activation: T::ONE,
            filters: LevelFilters::new(&thresholds[0], &gains, task.axes, length),
            thresholds,
            stale_after_s: T::from_f64(task.stale.map_or(0.0, |stale| stale.age_s)),
            stale_releases: task
                .stale
                .is_some_and(|stale| stale.then == AfterStale::Release),
        }
    }

    /// The level that stands at a position of a set, counted from 0: those in force first.
    #[inline(never)]
    fn at(set: &TaskSet, position: usize, arm: &ArmModel<T>, limits: bool) -> Self {
        let slot = set.slot_at(position);
        let Some(task) = set.tasks().get(slot) else {
            return Self { slot, ..Self::NONE };
        };
        let mut level = Self::new(task, slot, arm, limits);
        if position > 0 {
            let gains = level.gains;
            level.adjust(&gains, T::ONE);
        }
        let above = (0..position).filter_map(|above| set.tasks().get(set.slot_at(above)));
        level.start = above.map(|task| task.axes.count()).sum();
        level
    }

    /// With these gains, where levels stand above it, or by a share are about to.
    #[inline(never)]
    pub fn adjust(&mut self, gains: &LevelGains<T>, above: T) {
        let [first, below] = &self.thresholds;
        let thresholds = first.towards(below, above);
        self.gains = *gains;
        self.row_damping = by_rows(&gains.damping, self.axes);
        self.filters = LevelFilters::new(&thresholds, gains, self.axes, self.length);
    }

    /// Gains and limits.
    pub fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.numbers("stiffness", self.gains.stiffness.as_mut_slice());
        cells.numbers("damping", self.gains.damping.as_mut_slice());
        self.row_damping = by_rows(&self.gains.damping, self.axes);
        self.filters.visit(cells);
        cells.numbers("reach", core::slice::from_mut(&mut self.reach));
    }

    /// Whether another level tracks the same along the same axes.
    pub fn tracks_as(&self, other: &Self) -> bool {
        self.tracked == other.tracked && self.axes == other.axes
    }

    /// The rows of the stack that are the level's.
    #[inline(always)]
    pub fn rows(&self) -> core::ops::Range<usize> {
        self.start..self.start + self.size
    }

    /// K_d x, by rows of the level.
    #[inline(always)]
    pub fn damping_of_rows(&self, x: &[T; 3]) -> [T; 3] {
        self.row_damping
            .map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
    }
}

/// Gains on the controlled axes. The others are not read: whatever stands there stays out.
pub(crate) fn gains_on<T: Real>(gains: &TaskGains, axes: Axes) -> LevelGains<T> {
    LevelGains {
        stiffness: on_axes(&gains.stiffness, axes),
        damping: on_axes(&gains.damping, axes),
    }
}

/// Behind a call: it is in the flash once.
#[inline(never)]
fn on_axes<T: Real>(gain: &[[f64; 3]; 3], axes: Axes) -> Matrix3<T> {
    Matrix3::from_fn(|row, column| {
        let both = axes.contains(row) && axes.contains(column);
        T::from_f64(if both { gain[row][column] } else { 0.0 })
    })
}

/// A gain by the rows of the controlled axes, zeros behind the last one. Behind a call, likewise.
#[inline(never)]
fn by_rows<T: Real>(gain: &Matrix3<T>, axes: Axes) -> [[T; 3]; 3] {
    let mut rows = [[T::ZERO; 3]; 3];
    let used = || in_turn::<3>(3).filter(|&axis| axes.contains(axis));
    for (row, i) in used().enumerate() {
        for (column, j) in used().enumerate() {
            rows[row % 3][column % 3] = gain[(i, j)];
        }
    }
    rows
}

/// The levels of all slots in the precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levels<T: Real> {
    /// Those in force, highest priority first; behind them those that are not.
    levels: [Level<T>; MAX_LEVELS],
    count: usize,
    slots: usize,
    /// Whether a level in force comes or goes.
    pub fades: bool,
    /// Whether the age of any reference matters.
    pub watched: bool,
    shoulder: Vector3<T>,
}

impl<T: Real> Levels<T> {
    /// Without a slot.
    pub const NONE: Self = Self {
        levels: [Level::NONE; MAX_LEVELS],
        count: 0,
        slots: 0,
        fades: false,
        watched: false,
        shoulder: zeros(),
    };

    /// All tasks of a set, those in force that are not absent. With `limits` errors are shortened that
    /// call for too much speed; else every one is followed. Behind a call, so that the levels are made
    /// in the place of the result.
    #[inline(never)]
    pub fn new(set: &TaskSet, arm: &ArmModel<T>, limits: bool) -> Self {
        let at = |position| Level::at(set, position, arm, limits);
        Self {
            // One by one: a function that makes arrays makes them elsewhere first.
            levels: [at(0), at(1), at(2), at(3), at(4), at(5), at(6)],
            count: set.count_in_force(),
            slots: set.capacity().levels,
            fades: false,
            watched: set.tasks().iter().any(|task| task.stale.is_some()),
            shoulder: arm.shoulder(),
        }
    }

    /// With K_p = `stiffness` \[1/s2\] and K_d = `damping` \[1/s\] on every axis that a level
    /// controls.
    pub fn set_gains(&mut self, stiffness: T, damping: T) {
        for level in &mut self.levels {
            let uniform =
                |gain: T| Matrix3::from_diagonal(&level.axes.select(&Vector3::repeat(gain)));
            (level.gains.stiffness, level.gains.damping) = (uniform(stiffness), uniform(damping));
        }
    }

    /// Where the distance of targets counts from \[m\], base-plate frame.
    #[inline(always)]
    pub fn shoulder(&self) -> &Vector3<T> {
        &self.shoulder
    }

    /// Number of slots: so many targets a reference needs.
    #[inline(always)]
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// Those in force, highest priority first.
    #[inline(always)]
    pub fn in_order(&self) -> &[Level<T>] {
        self.levels.get(..self.count).unwrap_or(&[])
    }

    /// The same, to change them.
    pub fn in_order_mut(&mut self) -> &mut [Level<T>] {
        self.levels.get_mut(..self.count).unwrap_or(&mut [])
    }

    /// Those in force, and behind them those of the other slots; without rows where a slot never
    /// had a task.
    pub fn all(&self) -> &[Level<T>; MAX_LEVELS] {
        &self.levels
    }

    /// The slots of those in force.
    pub fn order(&self) -> Order {
        let mut order = Order::NONE;
        for level in self.in_order() {
            order.insert(MAX_LEVELS, level.slot);
        }
        order
    }

    /// The level of a slot, whether it is in force or not.
    pub fn slot_mut(&mut self, slot: usize) -> Option<&mut Level<T>> {
        self.levels.iter_mut().find(|level| level.slot == slot)
    }

    /// Whether the level of a slot is in force.
    pub fn is_in_force(&self, slot: usize) -> bool {
        self.in_order().iter().any(|level| level.slot == slot)
    }

    /// Brings the level of a slot that is not in force to a place among those that are.
    #[inline(never)]
    pub fn bring(&mut self, slot: usize, place: usize) {
        let found = self.levels.iter().position(|level| level.slot == slot);
        let Some(found) = found.filter(|&found| found >= self.count) else {
            return;
        };
        for upper in (place.min(self.count)..found).rev() {
            self.swap_with_next(upper);
        }
        self.count += 1;
        self.place();
    }

    /// Takes the level at a place among those in force out of force. Whether there is one.
    #[inline(never)]
    pub fn take(&mut self, place: usize) -> bool {
        let found = place < self.count;
        if found {
            for upper in place + 1..self.count {
                self.swap_with_next(upper - 1);
            }
            self.count -= 1;
            self.place();
        }
        found
    }

    fn swap_with_next(&mut self, upper: usize) {
        if let Some([upper, lower]) = self.levels.get_mut(upper..upper + 2) {
            core::mem::swap(upper, lower);
        }
    }

    /// Gives the levels in force their rows.
    fn place(&mut self) {
        self.watched = self
            .levels
            .iter()
            .any(|level| level.stale_after_s > T::ZERO);
        let mut start = 0;
        for level in self.in_order_mut() {
            level.start = start;
            start += level.size;
        }
    }
}
