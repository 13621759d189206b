//! [`LevelLimits`] as the law reads them: what takes the place of 1/z, and how far commands go.

use super::Axes;
use super::level_limits::LevelLimits;
use crate::cells::Cells;
use crate::joint::{Matrix3, Vector3, in_turn, zeros};
use crate::linalg::approach;
use crate::real::Real;

/// [`LevelLimits`] in the precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Thresholds<T: Real> {
    drive_mobility: T,
    release_mobility: T,
    error_speed: T,
    lost_speed: T,
    stiff_mobility: T,
    give: T,
}

impl<T: Real> Thresholds<T> {
    /// Of no task.
    pub const NONE: Self = Self {
        drive_mobility: T::ZERO,
        release_mobility: T::ZERO,
        error_speed: T::ZERO,
        lost_speed: T::ZERO,
        stiff_mobility: T::ZERO,
        give: T::ZERO,
    };

    /// Without `shortens` every error is followed. `give` as in [`LevelFilters`].
    pub fn new(limits: &LevelLimits, give: f64, shortens: bool) -> Self {
        Self {
            drive_mobility: T::from_f64(limits.drive_mobility),
            release_mobility: T::from_f64(limits.release_mobility),
            // Farther than any error that is believed.
            error_speed: T::from_f64(if shortens { limits.error_speed } else { 1e15 }),
            lost_speed: T::from_f64(limits.lost_speed),
            stiff_mobility: T::from_f64(limits.stiff_mobility),
            give: T::from_f64(give),
        }
    }

    /// These, or by a share of the way the others.
    pub fn towards(&self, others: &Self, share: T) -> Self {
        let between = |from: T, to: T| from + (to - from) * share;
        Self {
            drive_mobility: between(self.drive_mobility, others.drive_mobility),
            release_mobility: between(self.release_mobility, others.release_mobility),
            error_speed: between(self.error_speed, others.error_speed),
            lost_speed: between(self.lost_speed, others.lost_speed),
            stiff_mobility: between(self.stiff_mobility, others.stiff_mobility),
            give: between(self.give, others.give),
        }
    }
}

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
    const NONE: Self = Self {
        threshold: T::ZERO,
        end: T::ZERO,
        slope: T::ZERO,
    };

    fn new(threshold: T) -> Self {
        Self {
            threshold,
            end: T::from_f64(2.0) / threshold,
            slope: T::ONE / (threshold * threshold),
        }
    }

    /// Of a mobility z \[1/kg\], given 1/z: \[kg\].
    #[inline(always)]
    fn of(&self, z: T, inverse: T) -> T {
        let line = self.end - self.slope * z;
        z.choose_below(self.threshold, line, inverse)
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
    stiff_cubed: T,
    /// Share of what it would give by itself that every direction gives at bounds of joints.
    give: T,
    /// K_d^-1 K_p \[1/s\], on the controlled axes: the speed that an error calls for.
    pub approach: Matrix3<T>,
    /// Most of it \[m/s\], or \[rad/s\].
    pub error_speed: T,
}

impl<T: Real> LevelFilters<T> {
    /// Of no task.
    pub const NONE: Self = Self {
        drive: Filter::NONE,
        keep: Filter::NONE,
        inverse_release: T::ZERO,
        lost_command: T::ZERO,
        free: T::ZERO,
        stiff_cubed: T::ZERO,
        give: T::ZERO,
        approach: zeros(),
        error_speed: T::ZERO,
    };

    /// Of a level with rows of this `length`, see [`super::level::Level`]. Behind a call: it is in
    /// the flash once.
    #[inline(never)]
    pub fn new(thresholds: &Thresholds<T>, gains: &LevelGains<T>, axes: Axes, length: T) -> Self {
        let mut rate = T::ZERO;
        for axis in in_turn::<3>(3) {
            rate += gains.damping[(axis, axis)];
        }
        let rate = rate / T::from_f64(axes.count().max(1) as f64);
        // Of the rows as they are: those of orientations are in 1/(kg m2).
        let mobility = |limit: T| limit / (length * length);
        let z0 = mobility(thresholds.drive_mobility);
        let stiff = mobility(thresholds.stiff_mobility);
        let release = mobility(thresholds.release_mobility);
        Self {
            drive: Filter::new(z0),
            keep: Filter::new(release),
            inverse_release: T::ONE / release,
            lost_command: rate * thresholds.lost_speed / length,
            free: T::ONE / (T::from_f64(3.0) * z0),
            stiff_cubed: stiff * stiff * stiff,
            give: thresholds.give,
            approach: approach_rate(gains, axes),
            error_speed: thresholds.error_speed / length,
        }
    }

    /// Its numbers.
    pub fn visit(&mut self, cells: &mut impl Cells<T>) {
        for (name, filter) in [("drive", &mut self.drive), ("keep", &mut self.keep)] {
            let mut numbers = [filter.threshold, filter.end, filter.slope];
            cells.numbers(name, &mut numbers);
            [filter.threshold, filter.end, filter.slope] = numbers;
        }
        let mut numbers = [
            self.inverse_release,
            self.lost_command,
            self.free,
            self.stiff_cubed,
            self.give,
            self.error_speed,
        ];
        cells.numbers("limits", &mut numbers);
        [
            self.inverse_release,
            self.lost_command,
            self.free,
            self.stiff_cubed,
            self.give,
            self.error_speed,
        ] = numbers;
        cells.numbers("approach", self.approach.as_mut_slice());
    }

    /// d and p \[kg\] of a direction of mobility z \[1/kg\].
    #[inline(always)]
    pub fn of(&self, z: T) -> [T; 2] {
        let z = z.most(T::ZERO);
        // What is released is degraded, so that one inverse does for both.
        let inverse = T::ONE / z.most(self.keep.threshold);
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
        let below = (T::ONE - z * self.inverse_release).most(T::ZERO);
        below * below
    }

    /// kk \[kg\] of a direction of mobility z \[1/kg\], given g: how much less than by itself it
    /// gives at bounds of joints.
    #[inline(always)]
    pub fn stiffening(&self, z: T, softened: T) -> T {
        let z = z.most(T::ZERO);
        let cubed = z * z * z;
        z * z / (cubed + (softened * self.stiff_cubed).most(self.give * cubed))
    }

    /// A mobility z \[1/kg\] as a share of the one from which on commands have no limit.
    #[inline(always)]
    pub fn nearness(&self, z: T) -> T {
        z * self.free
    }

    /// Largest command \[m/s2\] along a direction of mobility z \[1/kg\].
    #[inline(always)]
    pub fn most_command(&self, z: T) -> T {
        let lost = (T::ONE - z * self.free).most(T::from_f64(1e-9));
        self.lost_command / lost
    }

    /// Share of the error that a level may follow, given the error: at most 1.
    #[inline(always)]
    pub fn error_share(&self, error: &Vector3<T>) -> T {
        let speed = self.approach * error;
        let most = self.error_speed;
        most / speed.dot(&speed).square_root().most(most)
    }
}

/// K_p \[1/s2\] and K_d \[1/s\] of a level on its controlled axes, zero elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LevelGains<T: Real> {
    pub stiffness: Matrix3<T>,
    pub damping: Matrix3<T>,
}

impl<T: Real> LevelGains<T> {
    /// Of no task.
    pub const NONE: Self = Self {
        stiffness: zeros(),
        damping: zeros(),
    };

    /// A step towards others, of the way to which a share is `left`.
    pub fn approach(&mut self, others: &Self, left: T) {
        approach(
            self.stiffness.as_mut_slice(),
            others.stiffness.as_slice(),
            left,
        );
        approach(self.damping.as_mut_slice(), others.damping.as_slice(), left);
    }
}

/// K_d^-1 K_p on the controlled axes, zero elsewhere.
fn approach_rate<T: Real>(gains: &LevelGains<T>, axes: Axes) -> Matrix3<T> {
    let (mut damping, mut speeds) = (gains.damping, gains.stiffness);
    for axis in in_turn::<3>(3) {
        if !axes.contains(axis) {
            damping[(axis, axis)] = T::ONE;
        }
    }
    // Gauss and Jordan; K_d is positive definite and needs no other pivots.
    for pivot in in_turn::<3>(3) {
        for row in in_turn::<3>(3) {
            if row != pivot {
                let share = damping[(row, pivot)] / damping[(pivot, pivot)];
                for column in in_turn::<3>(3) {
                    let (of_damping, of_speed) =
                        (damping[(pivot, column)], speeds[(pivot, column)]);
                    damping[(row, column)] -= share * of_damping;
                    speeds[(row, column)] -= share * of_speed;
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
