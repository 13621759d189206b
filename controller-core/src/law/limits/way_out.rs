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
//! far the arm is already bent. Of the motions of the null space that one is taken that brings it
//! nearest; a small acceleration bends the arm until the level can drive it by itself.

use super::bounds::JointBounds;
use super::motion::WhitenedMotion;
use super::spectrum::Spectrum;
use crate::arm::dynamics::Dynamics;
use crate::arm::kinematics::Kinematics;
use crate::cells::Cells;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, Matrix3, Vector3, in_turn, zeros};
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
    /// The same whitened, L^T a; without a meaning where nothing [`bends`](Self::bends).
    pub(super) whitened: JointVector<T>,
    /// The first level that is off its target along a direction that it has lost, if no motion
    /// of the null space brings it nearer: it has no way out.
    pub stuck: IndexSet,
    /// x, of which the null space has n: every cycle brings it nearer to the best motion.
    pub(super) motion: JointVector<T>,
    /// Whether it is that of a level that is being bent for.
    pub(super) is_begun: bool,
    /// Of the cycle alone; here, because on the stack it would have to be cleared first.
    taken: [Taken<T>; MAX_ROWS],
}

/// What a direction of a level takes from the joint motions, perpendicular to what those above
/// it take.
#[derive(Clone, Copy, Debug)]
struct Taken<T: Real> {
    row: JointVector<T>,
    /// How much of it, over the square of its length.
    weight: T,
}

impl<T: Real> Taken<T> {
    const NONE: Self = Self {
        row: zeros(),
        weight: T::ZERO,
    };

    /// Takes from `motion` what belongs to it.
    #[inline(always)]
    fn take_from(&self, motion: &mut JointVector<T>) {
        let part = self.row.dot(motion) * self.weight;
        for i in 0..DOF {
            motion[i] -= self.row[i] * part;
        }
    }
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
            whitened: zeros(),
            stuck: IndexSet::NONE,
            motion: zeros(),
            is_begun: false,
            taken: [Taken::NONE; MAX_ROWS],
        }
    }

    /// Whether a level is off its target along a direction that it has lost, so that the arm is bent
    /// for it or the level is stuck.
    #[must_use]
    pub fn bends(&self) -> bool {
        self.is_begun
    }

    /// What it remembers and tells.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.numbers("bend", self.acceleration.as_mut_slice());
        cells.numbers("bend_whitened", self.whitened.as_mut_slice());
        cells.numbers("bend_motion", self.motion.as_mut_slice());
        cells.flag("bends", &mut self.is_begun);
        cells.set("stuck", &mut self.stuck.0);
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

    /// Of the levels that are off their target along what they have lost the first, so that a
    /// cycle bends for one. Whether there is one.
    #[inline(never)]
    fn bend_for_first(&mut self, arm: &Straight<'_, T>) -> bool {
        for level in arm.levels.in_order() {
            let lost = lost_error(level, arm.rows, arm.spectrum);
            let error = lost.dot(&lost).square_root();
            let least = T::from_f64(BEND_ERROR) / level.length;
            let share = (error / least - T::ONE).least(T::ONE) * level.activation;
            if share > T::ZERO {
                self.acceleration = self.nearest(arm);
                self.whitened = arm.dynamics.cholesky.upper_times(&self.acceleration);
                let way = self.side(arm, level, &(lost / error));
                self.stuck.insert_if(level.slot, way.is_none());
                // To no side where there is none: 0.
                let asked = self.asked(arm, way.unwrap_or(T::ZERO)) * share;
                self.acceleration *= asked;
                self.whitened *= asked;
                return true;
            }
        }
        false
    }

    /// The null-space motion n that gains most on the target for its size, as far as the cycles
    /// before have found it: its fastest joint, the one that bends, goes up with 1 rad/s. x gets the
    /// same scale.
    #[inline(never)]
    fn nearest(&mut self, arm: &Straight<'_, T>) -> JointVector<T> {
        if !self.is_begun {
            // Not along a direction of any arm.
            let begin = [0.9, 1.1, -0.7, 1.3, 0.8, -1.2, 0.6];
            (self.motion, self.is_begun) = (begin.map(T::from_f64).into(), true);
        }
        let motion = self.in_null_space(arm);
        let mut fastest = T::from_f64(1e-30);
        for &speed in motion.iter() {
            let size = fastest.magnitude();
            fastest = size.choose_below(speed.magnitude(), speed, fastest);
        }
        let inverse = T::ONE / fastest;
        self.motion *= inverse;
        motion * inverse
    }

    /// What of x the null space has, with all joints alike: the directions of the levels as
    /// joint-space rows, made perpendicular to each other, and how much each is kept.
    #[inline(always)]
    fn in_null_space(&mut self, arm: &Straight<'_, T>) -> JointVector<T> {
        let mut left = self.motion;
        for (place, direction) in arm.spectrum.directions().iter().enumerate() {
            let Some((above, [own, ..])) = self.taken.split_at_mut_checked(place) else {
                break;
            };
            own.row = arm.dynamics.cholesky.lower_times(&direction.along);
            for other in above {
                other.take_from(&mut own.row);
            }
            let squared = own.row.dot(&own.row).most(T::from_f64(1e-24));
            own.weight = direction.keep * direction.mobility.most(T::ZERO) / squared;
            own.take_from(&mut left);
        }
        left
    }

    /// To which side the arm is bent for a level and how much, -1 to 1, along n, which stands in the
    /// place of the acceleration; `towards` is the unit vector e. None where there is no way. Makes
    /// the round of the power method, towards the first eigenvector of H in the null space.
    #[inline(never)]
    fn side(&mut self, arm: &Straight<'_, T>, level: &Level<T>, towards: &Vector3<T>) -> Option<T> {
        let motion = &self.acceleration;
        let second = SecondOrder::new(level, arm.kinematics, towards, motion);
        // Of eigenvalues of both signs the largest wins: none is below minus the norm.
        for i in 0..DOF {
            self.motion[i] = second.turned[i] + self.motion[i] * second.norm;
        }
        let nearer = motion.dot(&second.turned) * level.length;
        if nearer > T::from_f64(BEND_CURVATURE_MIN) {
            return side_of(arm, motion, second.slope * level.length / nearer);
        }
        None
    }

    /// Acceleration \[rad/s2\] along n that bends to a side: what is wanted, and what the arm is
    /// held back with there.
    #[inline(always)]
    fn asked(&self, arm: &Straight<'_, T>, side: T) -> T {
        let damping = T::from_f64(RELEASE_DAMPING) * arm.spectrum.release;
        let forces = arm.residual + arm.null_force;
        let others = self.acceleration.dot(&forces) - self.whitened.dot(&arm.motion.null) * damping;
        let others = others / self.whitened.dot(&self.whitened);
        let opposing = (-others * T::ONE.with_sign_of(side)).most(T::ZERO);
        side * (T::from_f64(BEND_ACCELERATION) + opposing)
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
        let mut released = level.filters.release(direction.mobility);
        // What levels above take from a direction is no straight arm: its row may have more.
        if level.start > 0 {
            let mut row: JointVector<T> = zeros();
            for (other, &entry) in directions.iter().zip(&direction.column) {
                row += other.row * entry;
            }
            let of_row = level.filters.release(row.dot(&row));
            released = T::ZERO.choose_below(released, of_row, released);
        }
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

/// How what a level tracks goes along e with a joint motion n, to the second order.
struct SecondOrder<T: Real> {
    /// b = e^T J n.
    slope: T,
    /// H n.
    turned: JointVector<T>,
    /// |H|: no eigenvalue is larger, of either sign.
    norm: T,
}

impl<T: Real> SecondOrder<T> {
    /// With t_i = e x z_i, H_ik = t_i^T J_k for i <= k, so that
    ///
    /// ```text
    /// (H n)_i = t_i^T (sum of J_k n_k, k >= i) + J_i^T (sum of t_k n_k, k < i)
    /// |H|^2   = sum of J_k^T (t_k t_k^T + 2 sum of t_i t_i^T, i < k) J_k
    /// ```
    ///
    /// An axis turns with the joints before it, never with those behind: half of what a point has
    /// is the mean of both.
    #[inline(always)]
    fn new(
        level: &Level<T>,
        kinematics: &Kinematics<T>,
        towards: &Vector3<T>,
        motion: &JointVector<T>,
    ) -> Self {
        let (link, point, share) = match &level.tracked {
            LevelPoint::Position(link, offset) => {
                (*link, Some(kinematics.point(*link, offset).x), T::ONE)
            }
            LevelPoint::Orientation(link, _) => (*link, None, T::HALF),
        };
        let mut turned: JointVector<T> = zeros();
        let (mut moved, mut turn): (Vector3<T>, Vector3<T>) = (zeros(), zeros());
        let (mut squares, mut norm): (Matrix3<T>, T) = (zeros(), T::ZERO);
        for i in in_turn::<DOF>(link.number()) {
            let axis = kinematics.joint_axis(i);
            let column = match &point {
                Some(x) => axis.cross(&(x - kinematics.joint_place(i))),
                None => axis,
            };
            let of_axis = towards.cross(&axis);
            // The first sum less what is the same for all joints.
            turned[i] = turn.dot(&column) - of_axis.dot(&moved);
            moved += column * motion[i];
            turn += of_axis * motion[i];
            let own = of_axis.dot(&column);
            norm += own * own + column.dot(&(squares * column));
            squares += of_axis * (of_axis + of_axis).transpose();
        }
        let all = moved.cross(towards);
        for i in in_turn::<DOF>(link.number()) {
            turned[i] = (turned[i] + kinematics.joint_axis(i).dot(&all)) * share;
        }
        Self {
            slope: towards.dot(&moved),
            turned,
            norm: norm.square_root() * share,
        }
    }
}

/// To which side of a null-space motion the arm is to bend and how much, -1 to 1, if it is `bent`
/// \[rad\] along it already: to q_d, or where there is more room, unless it is bent to the other
/// side. None where it has no room.
#[inline(always)]
fn side_of<T: Real>(arm: &Straight<'_, T>, motion: &JointVector<T>, bent: T) -> Option<T> {
    let (one, little) = (T::ONE, T::from_f64(0.1));
    let (mut back, mut ahead) = (T::INFINITE, T::INFINITE);
    let (mut wanted, mut weight) = (T::ZERO, T::ZERO);
    for i in in_turn::<DOF>(DOF) {
        let speed = motion[i];
        // Of joints that hardly move nothing counts.
        let size = speed.magnitude();
        let straight = arm.q[i] - bent * speed;
        let [down, up] = arm.bounds.room(i, straight);
        let behind = T::ZERO.choose_below(speed, down, up) / size;
        let before = T::ZERO.choose_below(speed, up, down) / size;
        let moves = |counted: T, else_: T| little.choose_below(size, counted, else_);
        back = moves(behind.least(back), back);
        ahead = moves(before.least(ahead), ahead);
        wanted += moves((arm.posture[i] - straight) * speed, T::ZERO);
        weight += moves(speed * speed, T::ZERO);
    }
    let least = T::from_f64(BEND_ROOM_MIN);
    match (back >= least, ahead >= least) {
        (false, false) => None,
        (true, false) => Some(-one),
        (false, true) => Some(one),
        (true, true) => {
            let near = T::from_f64(1.0 / BEND_TOWARDS);
            let wanted = (wanted / weight * near).most(-one).least(one);
            let as_much = ahead + T::from_f64(BEND_TOWARDS);
            let roomier = as_much.choose_below(back, -one, one);
            let preferred = wanted + (one - wanted.magnitude()) * roomier;
            let bent = bent * T::from_f64(1.0 / BEND_PREFERRED);
            Some((preferred + bent).most(-one).least(one))
        }
    }
}
