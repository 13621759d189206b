//! [`LevelLimits`] as the law reads them: what takes the place of 1/z, and how far commands go.

use super::level_limits::LevelLimits;
use super::set::{Task, Tracked};
use crate::joint::{Matrix3, Vector3, in_turn};
use crate::ranges::ORIENTATION_LENGTH;
use crate::real::Real;

/// 1/z down to a threshold, below it a line that ends at twice 1/threshold: what grew without
/// bound meets an end, and does so without a kink.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Filter<T: Real> {
    /// \[1/kg\].
    threshold: T,
    /// The line at z = 0 \[kg\].
    end: T,
    /// Its slope \[kg2\].
    slope: T,
}

impl<T: Real> Filter<T> {
    fn new(threshold: f64) -> Self {
        Self {
            threshold: T::from_f64(threshold),
            end: T::from_f64(2.0 / threshold),
            slope: T::from_f64(1.0 / (threshold * threshold)),
        }
    }

    /// Of a mobility z \[1/kg\], given 1/z: \[kg\].
    #[inline(always)]
    fn of(&self, z: T, inverse: T) -> T {
        let line = self.end - self.slope * z;
        if z >= self.threshold { inverse } else { line }
    }
}

/// [`LevelLimits`] of a task with its gains, in the precision of the controller and for rows as
/// they are: of orientations in rad, with mobilities in 1/(kg m2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LevelFilters<T: Real> {
    drive: Filter<T>,
    keep: Filter<T>,
    /// 1/zr \[kg\].
    inverse_release: T,
    /// Largest command \[m/s2\], or \[rad/s2\], along a direction that is lost.
    lost_command: T,
    /// 1/(3 z0) \[kg\]: from there on a command has no limit.
    free: T,
    /// zw^3 \[1/kg3\].
    pub stiff_cubed: T,
    /// K_d^-1 K_p \[1/s\], on the controlled axes: the speed that an error calls for.
    pub approach: Matrix3<T>,
    /// Most of it \[m/s\], or \[rad/s\].
    pub error_speed: T,
}

impl<T: Real> LevelFilters<T> {
    /// Of a task at the place `level`, counted from 0; without `shortens` every error is followed.
    pub fn new(task: &Task, level: usize, shortens: bool) -> Self {
        let limits = task.limits.unwrap_or(match level {
            0 => LevelLimits::FIRST,
            _ => LevelLimits::BELOW,
        });
        let mut rate = 0.0;
        for axis in 0..3 {
            if task.axes.contains(axis) {
                rate += task.gains.damping[axis][axis];
            }
        }
        let rows = task.axes.count().max(1);
        // Of the rows as they are: those of orientations are in 1/(kg m2).
        let length = length(task);
        let mobility = |limit: f64| limit / (length * length);
        let z0 = mobility(limits.drive_mobility);
        let stiff = mobility(limits.stiff_mobility);
        Self {
            drive: Filter::new(z0),
            keep: Filter::new(mobility(limits.release_mobility)),
            inverse_release: T::from_f64(1.0 / mobility(limits.release_mobility)),
            lost_command: T::from_f64(rate / rows as f64 * limits.lost_speed / length),
            free: T::from_f64(1.0 / (3.0 * z0)),
            stiff_cubed: T::from_f64(stiff * stiff * stiff),
            approach: approach(task).map(T::from_f64),
            error_speed: T::from_f64(if shortens {
                limits.error_speed / length
            } else {
                // Farther than any error that is believed.
                1e15
            }),
        }
    }

    /// d and p \[kg\] of a direction of mobility z \[1/kg\].
    #[inline(always)]
    pub fn of(&self, z: T) -> [T; 2] {
        let z = z.larger(T::ZERO);
        // What is released is degraded, so that one inverse does for both.
        let inverse = T::ONE / z.larger(self.keep.threshold);
        [self.drive.of(z, inverse), self.keep.of(z, inverse)]
    }

    /// Whether a level is degraded and whether it is released, by the least mobility z \[1/kg\]
    /// of its directions.
    #[inline(always)]
    pub fn lost(&self, z: T) -> [bool; 2] {
        [z < self.drive.threshold, z < self.keep.threshold]
    }

    /// rho of a level, by the least mobility z \[1/kg\] of its directions.
    #[inline(always)]
    pub fn release(&self, z: T) -> T {
        let below = (T::ONE - z * self.inverse_release).larger(T::ZERO);
        below * below
    }

    /// Largest command \[m/s2\] along a direction of mobility z \[1/kg\].
    #[inline(always)]
    pub fn most_command(&self, z: T) -> T {
        let lost = (T::ONE - z * self.free).larger(T::from_f64(1e-9));
        self.lost_command / lost
    }

    /// Share of the error that a level may follow, given the error: at most 1.
    #[inline(always)]
    pub fn error_share(&self, error: &Vector3<T>) -> T {
        let speed = self.approach * error;
        let most = self.error_speed;
        most / speed.dot(&speed).square_root().larger(most)
    }
}

/// What a row of a task is multiplied by to be a way \[m\].
pub(crate) fn length(task: &Task) -> f64 {
    match task.tracked {
        Tracked::Position(_) => 1.0,
        Tracked::Orientation(_) => ORIENTATION_LENGTH,
    }
}

/// K_d^-1 K_p on the controlled axes, zero elsewhere.
fn approach(task: &Task) -> Matrix3<f64> {
    let (mut damping, mut speeds) = (Matrix3::identity(), Matrix3::zeros());
    for row in in_turn::<3>(3) {
        for column in in_turn::<3>(3) {
            if task.axes.contains(row) && task.axes.contains(column) {
                damping[(row, column)] = task.gains.damping[row][column];
                speeds[(row, column)] = task.gains.stiffness[row][column];
            }
        }
    }
    // Gauss and Jordan; K_d is positive definite and needs no other pivots.
    for pivot in in_turn::<3>(3) {
        for row in in_turn::<3>(3) {
            if row != pivot {
                let share = damping[(row, pivot)] / damping[(pivot, pivot)];
                for column in in_turn::<3>(3) {
                    damping[(row, column)] -= share * damping[(pivot, column)];
                    speeds[(row, column)] -= share * speeds[(pivot, column)];
                }
            }
        }
    }
    for row in in_turn::<3>(3) {
        for column in in_turn::<3>(3) {
            speeds[(row, column)] /= damping[(row, row)];
        }
    }
    speeds
}
