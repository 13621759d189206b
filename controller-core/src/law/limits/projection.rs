//! The acceleration within the bounds that is nearest to the wish, nearest for the upper levels
//! first.
//!
//! ```text
//! min (a - a*)^T T^-1 (a - a*)   over   lo <= a <= hi
//! T   = M^-1 - sum over directions k of  kk_k x_k x_k^T,    x_k = L^-T y_k
//! kk  = z^2 / (z^3 + g zw^3),    g = 1 + (dev / dev0)^2
//! ```
//!
//! T is how the arm gives: as M^-1 where no task looks, stiffened in the directions of the levels
//! by 1 + z^3/(g zw^3). The minimum is unique and changes no faster than a*. A level that the limits
//! disturb for some time, dev, softens: its direction is not held at the price of the whole arm.
//!
//! Seven variables, a dual active set: the worst violated bound is pushed onto, joints at their
//! bounds that would be pulled off them are let go on the way. Each exchange is a sweep over T.

use super::bounds::AccelerationBounds;
use super::spectrum::Spectrum;
use super::tableau::{Tableau, WIDTH};
use crate::arm::dynamics::Dynamics;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, zeros};
use crate::ranges::{DISTURBANCE_SMOOTHING, MAX_LEVELS, PIVOTS, SOFTENING_DISTURBANCE};
use crate::real::Real;
use crate::task::level::Levels;
use crate::task::rows::TaskRows;

/// The wish within the bounds, and what that does to the levels.
#[derive(Clone, Copy, Debug)]
pub struct Projection<T: Real> {
    /// a \[rad/s2\]: within the bounds.
    pub acceleration: JointVector<T>,
    /// Torque \[Nm\] by which it differs from that of the wish, M (a - a*).
    pub torque: JointVector<T>,
    /// Joints that are at their lower bound, and at their upper one.
    pub at_bound: [IndexSet; 2],
    /// Exchanges made.
    pub pivots: u8,
    /// Whether a bound was still violated after [`PIVOTS`]; then it is kept by a cut.
    pub unresolved: bool,
    /// |J_i (a - a*)| \[m/s2\] of each level: what the bounds take from it. Of orientations times
    /// [`ORIENTATION_LENGTH`](crate::ranges::ORIENTATION_LENGTH).
    pub disturbance: [T; MAX_LEVELS],
    /// n^T M (a - a*) \[W\]: what the bounds do on the null-space motion; above 0 they drive it.
    pub power: T,
    /// dev \[m/s2\]: the disturbance smoothed, remembered from cycle to cycle.
    smoothed: [T; MAX_LEVELS],
}

/// What is projected, and by what measure.
pub(crate) struct Wished<'a, T: Real> {
    pub acceleration: &'a JointVector<T>,
    pub bounds: &'a AccelerationBounds<T>,
    pub levels: &'a Levels<T>,
    pub dynamics: &'a Dynamics<T>,
    pub rows: &'a TaskRows<T>,
    pub spectrum: &'a Spectrum<T>,
    pub null_velocity: &'a JointVector<T>,
}

impl<T: Real> Projection<T> {
    /// Nothing projected, nothing disturbed.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            acceleration: zeros(),
            torque: zeros(),
            at_bound: [IndexSet::NONE; 2],
            pivots: 0,
            unresolved: false,
            disturbance: [T::ZERO; MAX_LEVELS],
            power: T::ZERO,
            smoothed: [T::ZERO; MAX_LEVELS],
        }
    }

    /// No disturbance is remembered.
    pub(crate) fn forget(&mut self) {
        self.smoothed = [T::ZERO; MAX_LEVELS];
    }

    /// The wish itself where it is within its bounds.
    #[inline]
    pub(crate) fn update(&mut self, wished: &Wished<'_, T>) {
        if wished.bounds.contain(wished.acceleration) {
            self.acceleration = *wished.acceleration;
            self.torque = zeros();
            self.at_bound = [IndexSet::NONE; 2];
            (self.pivots, self.unresolved) = (0, false);
            self.disturbance = [T::ZERO; MAX_LEVELS];
            self.power = T::ZERO;
        } else {
            self.project(wished);
        }
        let share = T::from_f64(DISTURBANCE_SMOOTHING);
        let levels = wished.levels.as_slice().iter();
        for ((smoothed, &now), _) in self.smoothed.iter_mut().zip(&self.disturbance).zip(levels) {
            *smoothed += (now - *smoothed) * share;
        }
    }

    #[inline(never)]
    fn project(&mut self, wished: &Wished<'_, T>) {
        let bounds = wished.bounds;
        let mut search = Search::new(self.compliance(wished), wished.acceleration, bounds);
        let mut pushed = search.worst();
        self.pivots = 0;
        while pushed != NONE && self.pivots < PIVOTS {
            pushed = search.exchange(pushed % WIDTH);
            self.pivots += 1;
        }
        self.at_bound = [IndexSet::NONE; 2];
        let mut within = true;
        for i in 0..DOF {
            let (a, low, high) = (search.acceleration(i), bounds.least[i], bounds.greatest[i]);
            within &= (a >= low) & (a <= high);
            // What is not a number is cut as well; the torque of the wish still shows it.
            let cut = a.larger(low);
            let cut = if cut < high { cut } else { high };
            self.at_bound[0].insert_if(i, cut == low);
            self.at_bound[1].insert_if(i, cut == high);
            self.acceleration[i] = cut;
        }
        self.unresolved = !within;
        self.record(wished);
    }

    /// T.
    #[inline(always)]
    fn compliance(&self, wished: &Wished<'_, T>) -> Tableau<T> {
        let cholesky = &wished.dynamics.cholesky;
        let mut tableau = Tableau::inverse(&cholesky.inverse_factor());
        let softening = T::from_f64(1.0 / SOFTENING_DISTURBANCE);
        for (level, &smoothed) in wished.levels.as_slice().iter().zip(&self.smoothed) {
            let share = smoothed * softening;
            let soft = (T::ONE + share * share) * level.filters.stiff_cubed;
            for direction in wished.spectrum.of(level) {
                let z = direction.mobility.larger(T::ZERO);
                let held = z * z / (z * z * z + soft);
                tableau.stiffen(&cholesky.solve_upper(&direction.along), held);
            }
        }
        tableau
    }

    /// What the difference to the wish does.
    #[inline(always)]
    fn record(&mut self, wished: &Wished<'_, T>) {
        let difference = self.acceleration - wished.acceleration;
        self.torque = wished.dynamics.mass_matrix * difference;
        self.power = wished.null_velocity.dot(&self.torque);
        let levels = wished.levels.as_slice().iter();
        for (level, disturbance) in levels.zip(&mut self.disturbance) {
            let mut squared = T::ZERO;
            for row in wished.rows.jacobian.get(level.rows()).unwrap_or(&[]) {
                let along = row.dot(&difference);
                squared += along * along;
            }
            *disturbance = squared.square_root() * level.length;
        }
    }
}

impl<T: Real> Default for Projection<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// No joint.
const NONE: usize = DOF;

/// The dual active set on its way. Joints at a bound are those that are swept into the tableau.
struct Search<T: Real> {
    tableau: Tableau<T>,
    /// a \[rad/s2\] of free joints, the multiplier \[Nm\] of joints at a bound.
    point: [T; WIDTH],
    /// 1 of joints at a bound, 0 of free ones.
    held: [T; WIDTH],
    least: [T; WIDTH],
    greatest: [T; WIDTH],
    /// The bound that a joint is at, or pushed to.
    bound: [T; WIDTH],
    /// 1 / T_jj before any sweep.
    weight: [T; WIDTH],
    /// The same of joints that may be chosen, 0 of others.
    choice: [T; WIDTH],
    /// The multiplier so far of the joint that is pushed.
    so_far: T,
}

impl<T: Real> Search<T> {
    #[inline(always)]
    fn new(
        tableau: Tableau<T>,
        acceleration: &JointVector<T>,
        bounds: &AccelerationBounds<T>,
    ) -> Self {
        let mut search = Self {
            tableau,
            point: [T::ZERO; WIDTH],
            held: [T::ZERO; WIDTH],
            least: [T::ZERO; WIDTH],
            greatest: [T::ZERO; WIDTH],
            bound: [T::ZERO; WIDTH],
            weight: [T::ZERO; WIDTH],
            choice: [T::ZERO; WIDTH],
            so_far: T::ZERO,
        };
        for i in 0..DOF {
            let weight = T::ONE / search.tableau.diagonal(i);
            search.point[i] = acceleration[i];
            search.least[i] = bounds.least[i];
            search.greatest[i] = bounds.greatest[i];
            search.weight[i] = weight;
            search.choice[i] = weight;
        }
        search
    }

    /// a of a joint.
    #[inline(always)]
    fn acceleration(&self, joint: usize) -> T {
        let held = self.held[joint] > T::ZERO;
        if held {
            self.bound[joint]
        } else {
            self.point[joint]
        }
    }

    /// One exchange: a joint onto its bound, or on the way there another one off its own. Returns
    /// the joint to push next, [`NONE`] where no bound is violated any more.
    #[inline(always)]
    fn exchange(&mut self, pushed: usize) -> usize {
        let row = self.tableau.row(pushed);
        let pivot = row[pushed];
        let violation = self.point[pushed] - self.bound[pushed];
        let (step, dropped) = self.reach(violation / pivot, &row);
        self.so_far += step;
        for i in 0..DOF {
            self.point[i] -= row[i] * step;
        }
        if pivot * self.weight[pushed] <= T::PIVOT_SHARE {
            // Nothing gives way to it any more: the cut in the end keeps its bound.
            self.choice[pushed] = T::ZERO;
            self.worst()
        } else if dropped == NONE {
            self.point[pushed] = self.so_far;
            self.held[pushed] = T::ONE;
            self.choice[pushed] = T::ZERO;
            self.tableau.sweep(pushed, &row, T::ONE);
            self.worst()
        } else {
            let dropped = dropped % WIDTH;
            self.point[dropped] = self.bound[dropped];
            self.held[dropped] = T::ZERO;
            self.choice[dropped] = self.weight[dropped];
            let row = self.tableau.row(dropped);
            self.tableau.sweep(dropped, &row, -T::ONE);
            pushed
        }
    }

    /// How far the multiplier of the pushed joint goes of `step`: all the way, or until the first
    /// joint leaves its bound; and that joint, or [`NONE`].
    #[inline(always)]
    fn reach(&self, step: T, row: &[T; WIDTH]) -> (T, usize) {
        // Above 1 a multiplier changes its sign on the way.
        let (mut most, mut dropped) = (T::ONE, NONE);
        for i in 0..DOF {
            let way = row[i] * step * self.held[i] / self.point[i];
            if way > most {
                (most, dropped) = (way, i);
            }
        }
        (step / most, dropped)
    }

    /// The joint whose bound is violated worst, by the cost of pushing it there, or [`NONE`]: it
    /// is ready to be pushed. Behind a call: it is in the flash once.
    #[inline(never)]
    fn worst(&mut self) -> usize {
        let (mut worst, mut most) = (NONE, T::ZERO);
        for i in 0..DOF {
            let value = self.point[i];
            let above = (value - self.greatest[i]).larger(self.least[i] - value);
            let violation = above.larger(T::ZERO);
            let cost = violation * violation * self.choice[i];
            if cost > most {
                (most, worst) = (cost, i);
            }
        }
        let joint = worst % WIDTH;
        self.so_far = T::ZERO;
        self.bound[joint] = self.point[joint].limited(self.least[joint], self.greatest[joint]);
        worst
    }
}
