//! The stacked rows J, dJ/dt that all levels make together, and what they command.

use super::Axes;
use super::followed::{Followed, Motion};
use super::level::{Level, LevelPoint, Levels};
use super::orientation;
use crate::arm::kinematics::{JacobianRows, Kinematics};
use crate::fault::IndexSet;
use crate::joint::{DOF, JointState, JointVector, Vector3, in_turn, zeros};
use crate::ranges::{EXACT_ROWS, MAX_ROWS};
use crate::real::Real;

/// The stacked rows of all levels in priority order, first level first. Behind the
/// last row the arrays have no meaning.
#[derive(Clone, Copy, Debug)]
pub struct TaskRows<T: Real> {
    count: usize,
    /// First row of the level that row k belongs to.
    pub level_start: [usize; MAX_ROWS],
    /// Rows of J \[m\], of orientations \[1\].
    pub jacobian: [JointVector<T>; MAX_ROWS],
    /// Rows of dJ/dt \[m/s\], of orientations \[1/s\].
    pub jacobian_dot: [JointVector<T>; MAX_ROWS],
    /// (dJ/dt) dq \[m/s2\], or \[rad/s2\].
    pub bias: [T; MAX_ROWS],
    /// Commanded task acceleration, (12) without the bias:
    /// ddx_d + K_d (dx_d - dx) + K_p x_err \[m/s2\], or \[rad/s2\]; within limits no error
    /// calls for more speed than its level may have.
    pub commanded: [T; MAX_ROWS],
    /// Slots of levels whose error calls for more speed than they may have: it is shortened in
    /// `commanded`, not in `error`.
    pub shortened: IndexSet,
    /// x_err: x_d - x \[m\], or the chord of [`orientation::chord`] \[1\].
    pub error: [T; MAX_ROWS],
    /// Rows of all three axes of a level, where there is no room for them. Of the cycle alone; here, because
    /// on the stack they would have to be cleared first.
    aside: JacobianRows<T>,
}

impl<T: Real> TaskRows<T> {
    /// No rows yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            count: 0,
            level_start: [0; MAX_ROWS],
            jacobian: [zeros(); MAX_ROWS],
            jacobian_dot: [zeros(); MAX_ROWS],
            bias: [T::ZERO; MAX_ROWS],
            commanded: [T::ZERO; MAX_ROWS],
            error: [T::ZERO; MAX_ROWS],
            shortened: IndexSet::NONE,
            aside: JacobianRows::new(),
        }
    }

    /// Rows of all `levels`, level by level. Behind a call: what it reads lies far apart.
    #[inline(never)]
    pub(crate) fn update(
        &mut self,
        levels: &Levels<T>,
        followed: &Followed<T>,
        kinematics: &Kinematics<T>,
        joints: &JointState<T>,
    ) {
        self.count = 0;
        self.shortened = IndexSet::NONE;
        for level in levels.in_order() {
            let Some(followed) = followed.of_slots().get(level.slot) else {
                continue;
            };
            let desired = &followed.now;
            let start = self.count;
            // Rows of all three axes, in their place if there is room for them.
            let places = (
                three_from(&mut self.jacobian, start),
                three_from(&mut self.jacobian_dot, start),
            );
            let (in_place, rows, rates) = match places {
                (Some(rows), Some(rates)) => (true, rows, rates),
                _ => (
                    false,
                    &mut self.aside.jacobian,
                    &mut self.aside.jacobian_dot,
                ),
            };
            let commanded = match &level.tracked {
                LevelPoint::Position(link, offset) => {
                    let motion = kinematics.point(*link, offset);
                    let error = desired.position() - motion.x;
                    kinematics.set_point_rows(*link, &motion, rows, rates);
                    Commanded::new(level, desired, error, motion.dx)
                }
                LevelPoint::Orientation(link, turn) => {
                    let motion = kinematics.link(*link);
                    let actual = orientation::of_frame(&motion.rotation, turn);
                    let error = orientation::chord(&desired.place, &actual);
                    kinematics.set_angular_rows(*link, rows, rates);
                    Commanded::new(level, desired, error, motion.angular_velocity)
                }
            };
            if level.axes != Axes::XYZ || !in_place {
                self.keep_rows(level.axes, start, in_place);
            }
            self.shortened.insert_if(level.slot, commanded.shortened);
            self.push(level, &commanded, &joints.dq);
        }
    }

    /// Of rows of all three axes those that a level controls, one behind the other.
    #[inline(never)]
    fn keep_rows(&mut self, axes: Axes, start: usize, in_place: bool) {
        let mut place = start;
        for axis in in_turn::<3>(3) {
            let from = start + axis;
            if axes.contains(axis) && place < MAX_ROWS {
                if !in_place {
                    self.jacobian[place] = self.aside.jacobian[axis];
                    self.jacobian_dot[place] = self.aside.jacobian_dot[axis];
                } else if place < from && from < MAX_ROWS {
                    self.jacobian[place] = self.jacobian[from];
                    self.jacobian_dot[place] = self.jacobian_dot[from];
                }
                place += 1;
            }
        }
    }

    /// What belongs to the rows of the axes that the level controls.
    #[inline(always)]
    fn push(&mut self, level: &Level<T>, commanded: &Commanded<T>, dq: &JointVector<T>) {
        let start = self.count;
        for axis in 0..3 {
            let place = self.count;
            if level.axes.contains(axis) && place < MAX_ROWS {
                let rate = &self.jacobian_dot[place];
                let mut bias = T::ZERO;
                for i in 0..DOF {
                    bias += rate[i] * dq[i];
                }
                self.level_start[place] = start;
                self.bias[place] = bias;
                self.commanded[place] = commanded.acceleration[axis];
                self.error[place] = commanded.error[axis];
                self.count = place + 1;
            }
        }
    }

    /// Number of rows m.
    #[must_use]
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count.min(MAX_ROWS)
    }

    /// Drops the rows from `count` on.
    pub fn truncate(&mut self, count: usize) {
        self.count = self.count.min(count);
    }

    /// b of (12), of the exact law: the commanded acceleration less (dJ/dt) dq \[m/s2\].
    #[must_use]
    #[inline]
    pub fn acceleration(&self) -> [T; EXACT_ROWS] {
        let mut b = [T::ZERO; EXACT_ROWS];
        for ((b, commanded), bias) in b.iter_mut().zip(&self.commanded).zip(&self.bias) {
            *b = *commanded - *bias;
        }
        b
    }

    /// (dJ/dt)^T F for one entry per row of `momentum` F: \[Nm\] for task momenta.
    #[must_use]
    #[inline]
    pub fn rate_transposed_times<const N: usize>(&self, momentum: &[T; N]) -> JointVector<T> {
        let mut transport: JointVector<T> = zeros();
        let rows = self.jacobian_dot.iter().zip(momentum);
        for (row, &momentum) in rows.take(self.count()) {
            transport += row * momentum;
        }
        transport
    }
}

/// Three rows from `start` on, if there is room for so many.
#[inline(always)]
fn three_from<T: Real>(
    rows: &mut [JointVector<T>; MAX_ROWS],
    start: usize,
) -> Option<&mut [JointVector<T>; 3]> {
    rows.get_mut(start..)?.first_chunk_mut()
}

impl<T: Real> Default for TaskRows<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// What one level commands on all three axes.
struct Commanded<T: Real> {
    /// As in [`TaskRows::error`].
    error: Vector3<T>,
    /// As in [`TaskRows::commanded`].
    acceleration: Vector3<T>,
    /// Whether the error was shortened for it.
    shortened: bool,
}

impl<T: Real> Commanded<T> {
    /// (12) from the desired motion, the error and the actual velocity.
    #[inline(always)]
    fn new(level: &Level<T>, desired: &Motion<T>, error: Vector3<T>, velocity: Vector3<T>) -> Self {
        let rate = level.axes.select(&(desired.velocity - velocity));
        let error = level.axes.select(&error);
        let share = level.filters.error_share(&error);
        let followed = error * share;
        Self {
            error,
            acceleration: desired.acceleration
                + level.gains.damping * rate
                + level.gains.stiffness * followed,
            shortened: share < T::ONE,
        }
    }
}
