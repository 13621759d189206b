//! Levels in the precision of the controller.

use super::filters::{LevelFilters, length};
use super::orientation::{self, Quaternion};
use super::set::{Task, TaskGains, TaskSet, Tracked};
use super::{Axes, Target};
use crate::arm::kinematics::{Kinematics, PointMotion};
use crate::arm::{ArmModel, Link, LinkFrame};
use crate::joint::{Matrix3, Vector3, in_turn, zeros};
use crate::ranges::{MAX_LEVELS, REACH_MARGIN_M};
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
    pub tracked: LevelPoint<T>,
    pub axes: Axes,
    /// How far from the shoulder a target may be \[m\]; of an orientation 0.
    pub reach: T,
    /// K_p \[1/s2\].
    pub stiffness: Matrix3<T>,
    /// K_d \[1/s\].
    pub damping: Matrix3<T>,
    /// First row of the stack that is the level's.
    pub start: usize,
    /// Number of rows.
    pub size: usize,
    /// K_d of the rows, by rows.
    row_damping: [[T; 3]; 3],
    /// What a row is multiplied by to be a way \[m\]: of orientations
    /// [`ORIENTATION_LENGTH`](crate::ranges::ORIENTATION_LENGTH), else 1.
    pub length: T,
    pub filters: LevelFilters<T>,
}

impl<T: Real> Level<T> {
    /// With its rows from `start` on.
    #[inline(always)]
    fn new(task: &Task, start: usize, arm: &ArmModel<T>, filters: LevelFilters<T>) -> Self {
        let (tracked, reach) = match task.tracked {
            Tracked::Position(point) => {
                let offset = Vector3::from(point.offset.map(T::from_f64));
                let reach = arm.reach(&point) + T::from_f64(REACH_MARGIN_M);
                (LevelPoint::Position(point.link, offset), reach)
            }
            Tracked::Orientation(LinkFrame { link, rotation }) => {
                // nalgebra takes columns.
                let rotation = nalgebra::Matrix3::from(rotation).transpose();
                let turn = orientation::unit(&orientation::of_rotation(&rotation));
                let turn = turn.map(T::from_f64);
                (LevelPoint::Orientation(link, turn), T::ZERO)
            }
        };
        Self {
            tracked,
            axes: task.axes,
            reach,
            stiffness: on_axes(&task.gains.stiffness, task.axes),
            damping: on_axes(&task.gains.damping, task.axes),
            start,
            size: task.axes.count().min(3),
            row_damping: by_rows(&task.gains.damping, task.axes),
            length: T::from_f64(length(task)),
            filters,
        }
    }

    /// The level at the place `number`, counted from 0, or behind the last one any.
    #[inline(never)]
    fn at(set: &TaskSet, number: usize, arm: &ArmModel<T>, limits: bool) -> Self {
        const UNUSED: Task =
            Task::orientation(Link::L7.frame(), Axes::XYZ, TaskGains::uniform(1.0, 1.0));
        let task = set.tasks().get(number).unwrap_or(&UNUSED);
        let above = set.tasks().iter().take(number);
        let start = above.map(|task| task.axes.count()).sum();
        Self::new(task, start, arm, LevelFilters::new(task, number, limits))
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

/// A gain on the controlled axes. The others are not read: whatever stands there stays out.
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
fn by_rows<T: Real>(gain: &[[f64; 3]; 3], axes: Axes) -> [[T; 3]; 3] {
    let mut rows = [[T::ZERO; 3]; 3];
    let used = || in_turn::<3>(3).filter(|&axis| axes.contains(axis));
    for (row, i) in used().enumerate() {
        for (column, j) in used().enumerate() {
            rows[row % 3][column % 3] = T::from_f64(gain[i][j]);
        }
    }
    rows
}

/// All levels in the precision of the controller, highest priority first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levels<T: Real> {
    levels: [Level<T>; MAX_LEVELS],
    count: usize,
    shoulder: Vector3<T>,
}

impl<T: Real> Levels<T> {
    /// With `limits` errors are shortened that call for too much speed; else every one is followed.
    /// Behind a call, so that the levels are made in the place of the result.
    #[inline(never)]
    pub fn new(set: &TaskSet, arm: &ArmModel<T>, limits: bool) -> Self {
        let at = |number| Level::at(set, number, arm, limits);
        Self {
            // One by one: a function that makes arrays makes them elsewhere first.
            levels: [at(0), at(1), at(2), at(3), at(4), at(5), at(6)],
            count: set.tasks().len(),
            shoulder: arm.shoulder(),
        }
    }

    /// With K_p = `stiffness` \[1/s2\] and K_d = `damping` \[1/s\] on every axis that a level
    /// controls.
    pub fn set_gains(&mut self, stiffness: T, damping: T) {
        for level in &mut self.levels {
            let uniform =
                |gain: T| Matrix3::from_diagonal(&level.axes.select(&Vector3::repeat(gain)));
            (level.stiffness, level.damping) = (uniform(stiffness), uniform(damping));
        }
    }

    /// Where the distance of targets counts from \[m\], base-plate frame.
    #[inline(always)]
    pub fn shoulder(&self) -> &Vector3<T> {
        &self.shoulder
    }

    #[inline(always)]
    pub fn as_slice(&self) -> &[Level<T>] {
        self.levels.get(..self.count).unwrap_or(&[])
    }
}
