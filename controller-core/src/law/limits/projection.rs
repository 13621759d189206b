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
use crate::ranges::{DISTURBANCE_SMOOTHING, MAX_LEVELS, MAX_ROWS, PIVOTS, SOFTENING_DISTURBANCE};
use crate::real::Real;
use crate::task::rows::TaskRows;
use crate::task::set::Levels;

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
        for (smoothed, &now) in self.smoothed.iter_mut().zip(&self.disturbance) {
            *smoothed += (now - *smoothed) * share;
        }
    }

    #[inline(never)]
    fn project(&mut self, wished: &Wished<'_, T>) {
        let mut tableau = self.compliance(wished);
        let bounds = wished.bounds;
        let mut search = Search::new(&tableau, wished.acceleration, bounds);
        self.pivots = 0;
        while self.pivots < PIVOTS && search.exchange(&mut tableau) {
            self.pivots += 1;
        }
        self.at_bound = [IndexSet::NONE; 2];
        let mut within = true;
        for i in 0..DOF {
            let (a, low, high) = (search.acceleration[i], bounds.least[i], bounds.greatest[i]);
            within &= (a >= low) & (a <= high);
            let cut = a.limited(low, high);
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
            for k in level.rows() {
                if k < MAX_ROWS {
                    let z = wished.spectrum.mobility[k].larger(T::ZERO);
                    let held = z * z / (z * z * z + soft);
                    let direction = cholesky.solve_upper(&wished.spectrum.directions[k]);
                    tableau.stiffen(&direction, held);
                }
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
            for k in level.rows() {
                if k < MAX_ROWS {
                    let along = wished.rows.jacobian[k].dot(&difference);
                    squared += along * along;
                }
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

/// The dual active set on its way.
struct Search<T: Real> {
    acceleration: [T; WIDTH],
    least: [T; WIDTH],
    greatest: [T; WIDTH],
    /// Multipliers of the joints at a bound \[Nm\], 0 of the others.
    multiplier: [T; WIDTH],
    /// 1 / T_jj before any sweep.
    weight: [T; WIDTH],
    /// Whether a joint is at a bound: 1, or 0.
    at_bound: [T; WIDTH],
    /// The joint being pushed onto its bound, and that bound; none at first.
    pushed: Option<(usize, T)>,
}

impl<T: Real> Search<T> {
    #[inline(always)]
    fn new(
        tableau: &Tableau<T>,
        acceleration: &JointVector<T>,
        bounds: &AccelerationBounds<T>,
    ) -> Self {
        let mut search = Self {
            acceleration: [T::ZERO; WIDTH],
            least: [T::ZERO; WIDTH],
            greatest: [T::ZERO; WIDTH],
            multiplier: [T::ZERO; WIDTH],
            weight: [T::ZERO; WIDTH],
            at_bound: [T::ZERO; WIDTH],
            pushed: None,
        };
        for i in 0..DOF {
            search.acceleration[i] = acceleration[i];
            search.least[i] = bounds.least[i];
            search.greatest[i] = bounds.greatest[i];
            search.weight[i] = T::ONE / tableau.diagonal(i);
        }
        search
    }

    /// One exchange: a joint onto its bound, or on the way there another one off its own.
    /// False where no bound is violated any more. Without branches: each costs the same.
    #[inline(always)]
    fn exchange(&mut self, tableau: &mut Tableau<T>) -> bool {
        let worst = self.worst(tableau);
        let Some((pushed, bound)) = self.pushed.or(worst) else {
            return false;
        };
        let row = tableau.row(pushed);
        let mut step = (self.acceleration[pushed % WIDTH] - bound) / row[pushed % WIDTH];
        let mut dropped = NONE;
        for joint in 0..DOF {
            // Joints that are not at a bound have no multiplier.
            let (multiplier, slope) = (self.multiplier[joint], row[joint]);
            let reached = multiplier / slope;
            let first =
                (multiplier * slope * step > T::ZERO) & (reached.magnitude() < step.magnitude());
            step = if first { reached } else { step };
            dropped = if first { joint } else { dropped };
        }
        for joint in 0..DOF {
            let change = row[joint] * step;
            let held = self.at_bound[joint];
            self.multiplier[joint] -= held * change;
            self.acceleration[joint] -= (T::ONE - held) * change;
        }
        self.multiplier[pushed % WIDTH] += step;
        let arrives = dropped == NONE;
        let (exchanged, held) = if arrives {
            (pushed, T::ONE)
        } else {
            (dropped, T::ZERO)
        };
        tableau.sweep(exchanged, held + held - T::ONE);
        self.at_bound[exchanged % WIDTH] = held;
        self.multiplier[exchanged % WIDTH] *= held;
        let place = &mut self.acceleration[pushed % WIDTH];
        *place = if arrives { bound } else { *place };
        self.pushed = if arrives { None } else { Some((pushed, bound)) };
        true
    }

    /// The joint whose bound is violated worst, by the cost of pushing it there, and the bound.
    #[inline(always)]
    fn worst(&self, tableau: &Tableau<T>) -> Option<(usize, T)> {
        let least_share = T::PIVOT_SHARE;
        let mut worst = None;
        let mut most = T::ZERO;
        for joint in 0..DOF {
            let acceleration = self.acceleration[joint];
            let bound = acceleration.limited(self.least[joint], self.greatest[joint]);
            let violation = acceleration - bound;
            let weight = self.weight[joint];
            let cost = violation * violation * weight;
            let free = self.at_bound[joint] == T::ZERO;
            let gives = tableau.diagonal(joint) * weight > least_share;
            if free & gives & (cost > most) {
                most = cost;
                worst = Some((joint, bound));
            }
        }
        worst
    }
}
