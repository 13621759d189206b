//! The way out of a posture in which the arm is straight and its target is not ahead.
//!
//! There no direction leads towards the target: what the joints do to the lost one begins with
//! the square of their motion. Along a null-space motion n, and a unit vector e from the point of
//! the level to where its lost directions want it,
//!
//! ```text
//! e^T x(t) = b t + c t^2 / 2,     b = e^T J n,     c = n^T H n,     H_ik = e^T d2x / dq_i dq_k
//! ```
//!
//! the point comes nearer on both sides of the straight posture, by c/2 \[m/rad2\], and b/c is how
//! far the arm is already bent. Of the motions n_j that the null space makes of each joint that one
//! is taken that brings it nearest; a small acceleration bends the arm until the level can
//! drive it by itself.

use super::bounds::JointBounds;
use super::motion::WhitenedMotion;
use super::spectrum::Spectrum;
use crate::arm::dynamics::Dynamics;
use crate::arm::kinematics::Kinematics;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointMatrix, JointVector, Vector3, zeros};
use crate::ranges::{
    BEND_ACCELERATION, BEND_CURVATURE_MIN, BEND_ERROR, BEND_PREFERRED, BEND_ROOM_MIN, BEND_TOWARDS,
    MAX_ROWS, RELEASE_DAMPING,
};
use crate::real::Real;
use crate::task::level::{Level, LevelPoint, Levels};
use crate::task::rows::TaskRows;

/// What bends a straight arm.
#[derive(Clone, Copy, Debug)]
pub struct WayOut<T: Real> {
    /// Acceleration \[rad/s2\] that the null space is asked for on top of the rest.
    pub acceleration: JointVector<T>,
    /// The first level that is off its target along a direction that it has lost, if no motion
    /// of the null space brings it nearer: it has no way out.
    pub stuck: IndexSet,
    /// x, of which the null space has n: every cycle brings it nearer to the best motion.
    motion: JointVector<T>,
    /// Whether it is that of a level that is being bent for.
    is_begun: bool,
}

/// Where an arm is with a level released.
pub(crate) struct Straight<'a, T: Real> {
    pub levels: &'a Levels<T>,
    pub bounds: &'a JointBounds<T>,
    pub kinematics: &'a Kinematics<T>,
    pub dynamics: &'a Dynamics<T>,
    pub rows: &'a TaskRows<T>,
    pub spectrum: &'a Spectrum<T>,
    pub motion: &'a WhitenedMotion<T>,
    /// q \[rad\].
    pub q: &'a JointVector<T>,
    /// f - D n \[Nm\].
    pub null_force: &'a JointVector<T>,
    /// r \[Nm\].
    pub residual: &'a JointVector<T>,
    /// q_d \[rad\].
    pub posture: &'a JointVector<T>,
}

impl<T: Real> WayOut<T> {
    /// No way asked for.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            acceleration: zeros(),
            stuck: IndexSet::NONE,
            motion: zeros(),
            is_begun: false,
        }
    }

    /// Whether a level is off its target along a direction that it has lost, so that the arm is bent
    /// for it or the level is stuck.
    #[must_use]
    pub fn bends(&self) -> bool {
        self.is_begun
    }

    /// Nothing where no level is released.
    #[inline]
    pub(crate) fn update(&mut self, arm: &Straight<'_, T>) {
        self.stuck = IndexSet::NONE;
        if arm.spectrum.released.any() && self.bend_for_first(arm) {
            return;
        }
        if self.is_begun {
            (self.acceleration, self.is_begun) = (zeros(), false);
        }
    }

    /// Of the levels that are off their target the first, so that a cycle bends for one. Whether
    /// there is one.
    #[inline(never)]
    fn bend_for_first(&mut self, arm: &Straight<'_, T>) -> bool {
        for (number, level) in arm.levels.as_slice().iter().enumerate() {
            if arm.spectrum.released.contains(number) {
                let lost = lost_error(level, arm.rows, arm.spectrum);
                let error = lost.dot(&lost).square_root();
                let least = T::from_f64(BEND_ERROR) / level.length;
                let share = (error / least - T::ONE).least(T::ONE);
                if share > T::ZERO {
                    self.bend(arm, number, level, &(lost / error), share);
                    return true;
                }
            }
        }
        false
    }

    /// Of one level, `towards` being the unit vector e.
    #[inline(never)]
    fn bend(
        &mut self,
        arm: &Straight<'_, T>,
        number: usize,
        level: &Level<T>,
        towards: &Vector3<T>,
        share: T,
    ) {
        let (slope, curvature) = second_order(level, arm.kinematics, towards);
        let (motion, turned) = self.nearest(arm, &curvature);
        let nearer = motion.dot(&turned) * level.length;
        self.acceleration = zeros();
        let mut way = None;
        if nearer > T::from_f64(BEND_CURVATURE_MIN) {
            let bent = slope.dot(&motion) * level.length / nearer;
            way = side_of(arm, &motion, bent);
        }
        self.stuck.insert_if(number, way.is_none());
        if let Some(side) = way {
            let whitened = arm.dynamics.cholesky.upper_times(&motion);
            let damping = T::from_f64(RELEASE_DAMPING) * arm.spectrum.release;
            let others = motion.dot(&(arm.residual + arm.null_force))
                - whitened.dot(&arm.motion.null) * damping;
            let others = others / whitened.dot(&whitened);
            let opposing = (-others * T::ONE.with_sign_of(side)).larger(T::ZERO);
            let asked = side * (T::from_f64(BEND_ACCELERATION) + opposing);
            self.acceleration = motion * (asked * share);
        }
    }

    /// The null-space motion n that gains most on the target for its size, and H n: the first
    /// eigenvector of H in the null space, by one round of the power method in every cycle. As
    /// fast as its fastest joint, which goes up: that is the one that bends.
    #[inline(always)]
    fn nearest(
        &mut self,
        arm: &Straight<'_, T>,
        curvature: &JointMatrix<T>,
    ) -> (JointVector<T>, JointVector<T>) {
        if !self.is_begun {
            // Not along a direction of any arm.
            let begin = [0.9, 1.1, -0.7, 1.3, 0.8, -1.2, 0.6];
            (self.motion, self.is_begun) = (begin.map(T::from_f64).into(), true);
        }
        let motion = in_null_space(arm, &self.motion);
        let mut fastest = T::from_f64(1e-30);
        for &speed in motion.iter() {
            if speed.magnitude() > fastest.magnitude() {
                fastest = speed;
            }
        }
        let motion = motion / fastest;
        let turned = curvature * motion;
        // Of eigenvalues of both signs the largest wins: none is below minus the norm.
        let shift = curvature.dot(curvature).square_root();
        self.motion = turned + self.motion * (shift / fastest);
        (motion, turned)
    }
}

impl<T: Real> Default for WayOut<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Part of the error of a level along the directions that its own rows have lost, by the shares
/// that are released.
#[inline(always)]
fn lost_error<T: Real>(level: &Level<T>, rows: &TaskRows<T>, spectrum: &Spectrum<T>) -> Vector3<T> {
    let directions = spectrum.of(level);
    let (mut error, mut lost) = ([T::ZERO; 3], [T::ZERO; 3]);
    for (error, &of_row) in error
        .iter_mut()
        .zip(rows.error.get(level.rows()).unwrap_or(&[]))
    {
        *error = of_row;
    }
    for direction in directions.iter().take(3) {
        let mut row: JointVector<T> = zeros();
        for (other, &entry) in directions.iter().zip(&direction.column) {
            row += other.row * entry;
        }
        // What levels above take from a direction is no straight arm.
        let released = level.filters.release(row.dot(&row));
        direction.add_part(direction.part(&error) * released, &mut lost);
    }
    let (mut of_axes, mut next) = (zeros(), 0);
    for axis in 0..3 {
        if level.axes.contains(axis) {
            of_axes[axis] = lost.get(next).copied().unwrap_or(T::ZERO);
            next += 1;
        }
    }
    of_axes
}

/// J^T e, and H of what a level tracks along e.
#[inline(always)]
fn second_order<T: Real>(
    level: &Level<T>,
    kinematics: &Kinematics<T>,
    towards: &Vector3<T>,
) -> (JointVector<T>, JointMatrix<T>) {
    let (columns, diagonal) = match &level.tracked {
        LevelPoint::Position(link, offset) => {
            let motion = kinematics.point(*link, offset);
            (kinematics.point_jacobian(*link, &motion).jacobian, T::ONE)
        }
        LevelPoint::Orientation(link, _) => (kinematics.angular_jacobian(*link).jacobian, T::ZERO),
    };
    let column = |of: &[JointVector<T>; 3], i: usize| Vector3::from([of[0][i], of[1][i], of[2][i]]);
    let (mut slope, mut curvature) = (zeros(), zeros());
    for i in 0..DOF {
        slope[i] = towards.dot(&column(&columns, i));
        let turned = towards.cross(&column(&kinematics.axis, i));
        curvature[(i, i)] = turned.dot(&column(&columns, i)) * diagonal;
        // An axis turns with the joints before it, never with those behind: half of what a point
        // has is the mean of both.
        let half = (T::ONE + diagonal) * T::HALF;
        for k in i + 1..DOF {
            let mixed = turned.dot(&column(&columns, k)) * half;
            curvature[(i, k)] = mixed;
            curvature[(k, i)] = mixed;
        }
    }
    (slope, curvature)
}

/// What of a joint motion the null space has, with all joints alike: the directions of the levels
/// as joint-space rows, made perpendicular to each other, and how much each is kept.
#[inline(always)]
fn in_null_space<T: Real>(arm: &Straight<'_, T>, motion: &JointVector<T>) -> JointVector<T> {
    let mut rows: [(JointVector<T>, T); MAX_ROWS] = [(zeros(), T::ZERO); MAX_ROWS];
    let mut left = *motion;
    for (place, direction) in arm.spectrum.directions().iter().enumerate() {
        let mut row: JointVector<T> = arm.dynamics.cholesky.lower_times(&direction.along);
        for (other, kept) in rows.iter().take(place) {
            row -= other * (other.dot(&row) * *kept);
        }
        row /= row.dot(&row).square_root().larger(T::from_f64(1e-12));
        let kept = direction.keep * direction.mobility.larger(T::ZERO);
        left -= row * (row.dot(motion) * kept);
        if let Some(place) = rows.get_mut(place) {
            *place = (row, kept);
        }
    }
    left
}

/// To which side of a null-space motion the arm is to bend and how much, -1 to 1, if it is `bent`
/// \[rad\] along it already: to q_d, or where there is more room, unless it is bent to the other
/// side. None where it has no room.
#[inline(always)]
fn side_of<T: Real>(arm: &Straight<'_, T>, motion: &JointVector<T>, bent: T) -> Option<T> {
    let (one, little) = (T::ONE, T::from_f64(0.1));
    let (mut back, mut ahead) = (T::INFINITE, T::INFINITE);
    let (mut wanted, mut weight) = (T::ZERO, T::ZERO);
    for i in 0..DOF {
        let speed = motion[i];
        if speed.magnitude() > little {
            let straight = arm.q[i] - bent * speed;
            let [down, up] = arm.bounds.room(i, straight);
            let (behind, before) = if speed > T::ZERO {
                (down, up)
            } else {
                (up, down)
            };
            back = back.least(behind / speed.magnitude());
            ahead = ahead.least(before / speed.magnitude());
            wanted += (arm.posture[i] - straight) * speed;
            weight += speed * speed;
        }
    }
    let least = T::from_f64(BEND_ROOM_MIN);
    match (back >= least, ahead >= least) {
        (false, false) => None,
        (true, false) => Some(-one),
        (false, true) => Some(one),
        (true, true) => {
            let near = T::from_f64(1.0 / BEND_TOWARDS);
            let wanted = (wanted / weight * near).most(-one).least(one);
            let roomier = if back > ahead + T::from_f64(BEND_TOWARDS) {
                -one
            } else {
                one
            };
            let preferred = wanted + (one - wanted.magnitude()) * roomier;
            let bent = bent * T::from_f64(1.0 / BEND_PREFERRED);
            Some((preferred + bent).most(-one).least(one))
        }
    }
}
