//! The acceleration within the bounds that is nearest to the wish, nearest for the upper levels
//! first.
//!
//! ```text
//! min (a - a*)^T T^-1 (a - a*)   over   lo <= a <= hi
//! T   = M^-1 - sum over directions k of  kk_k x_k x_k^T,    x_k = L^-T y_k
//! kk  = h z^2 / (z^3 + max(g zw^3, c z^3)),    g = 1 + (dev / dev0)^2
//! ```
//!
//! T is how the arm gives: as M^-1 where no task looks, stiffened in the directions of the levels
//! by 1 + z^3/(g zw^3), below the first level by 1/c at most: light directions of the wrist would
//! outweigh the first level otherwise. The minimum is unique and changes no faster than a*. A level that the limits
//! disturb for some time, dev, softens: its direction is not held at the price of the whole arm.
//!
//! Seven variables, a dual active set: the worst violated bound is pushed onto, joints at their
//! bounds that would be pulled off them are let go on the way. Each exchange is a sweep over T.

use super::bounds::AccelerationBounds;
use super::spectrum::Spectrum;
use super::tableau::{Tableau, WIDTH};
use crate::arm::dynamics::Dynamics;
use crate::cells::Cells;
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
    /// Torque \[Nm\] that gives it: that of the wish and M (a - a*).
    pub torque: JointVector<T>,
    /// Joints that are at their lower bound, and at their upper one.
    pub at_bound: [IndexSet; 2],
    /// Exchanges made.
    pub pivots: u8,
    /// Whether a bound was still violated after [`PIVOTS`]; then it is kept by a cut.
    pub unresolved: bool,
    /// |J_i (a - a*)| \[m/s2\] of the level of each slot: what the bounds take from it. Of orientations times
    /// [`ORIENTATION_LENGTH`](crate::ranges::ORIENTATION_LENGTH).
    pub disturbance: [T; MAX_LEVELS],
    /// n^T M (a - a*) \[W\]: what the bounds do on the null-space motion; above 0 they drive it.
    pub power: T,
    /// dev \[m/s2\]: the disturbance smoothed, remembered from cycle to cycle.
    pub(super) smoothed: [T; MAX_LEVELS],
    /// Of the cycle alone; here, because on the stack it would have to be cleared first.
    search: Search<T>,
}

/// What is projected, and by what measure.
pub(crate) struct Wished<'a, T: Real> {
    pub acceleration: &'a JointVector<T>,
    /// Torque \[Nm\] that gives it.
    pub torque: &'a JointVector<T>,
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
            search: Search::new(),
        }
    }

    /// What it remembers and tells.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.numbers("nearest", self.acceleration.as_mut_slice());
        cells.numbers("nearest_torque", self.torque.as_mut_slice());
        cells.numbers("disturbance", &mut self.disturbance);
        cells.numbers("smoothed_disturbance", &mut self.smoothed);
        cells.numbers("limits_power", core::slice::from_mut(&mut self.power));
        let [least, greatest] = &mut self.at_bound;
        cells.set("at_least", &mut least.0);
        cells.set("at_greatest", &mut greatest.0);
        cells.count("pivots", &mut self.pivots);
        cells.flag("unresolved", &mut self.unresolved);
    }

    /// Row `i` of T, its entries up to the diagonal.
    pub(crate) fn compliance_row(&self, i: usize) -> &[T] {
        self.search.tableau.row(i).get(..=i).unwrap_or(&[])
    }

    /// No disturbance is remembered.
    pub(crate) fn forget(&mut self) {
        self.smoothed = [T::ZERO; MAX_LEVELS];
    }

    /// The wish itself where it is within its bounds.
    #[inline]
    pub(crate) fn update(&mut self, wished: &Wished<'_, T>) {
        if wished.bounds.contain(wished.acceleration) {
            self.keep(wished);
        } else {
            self.project(wished);
        }
    }

    /// The wish as it is.
    #[inline(always)]
    pub(crate) fn keep(&mut self, wished: &Wished<'_, T>) {
        self.acceleration = *wished.acceleration;
        self.torque = *wished.torque;
        self.at_bound = [IndexSet::NONE; 2];
        (self.pivots, self.unresolved) = (0, false);
        self.power = T::ZERO;
        for level in wished.levels.in_order() {
            self.disturb(level.slot, T::ZERO);
        }
    }

    /// No disturbance of the level of a slot is remembered.
    pub(crate) fn forget_level(&mut self, slot: usize) {
        if let Some(smoothed) = self.smoothed.get_mut(slot) {
            *smoothed = T::ZERO;
        }
    }

    /// What the bounds take from the level of a slot.
    #[inline(always)]
    fn disturb(&mut self, slot: usize, disturbance: T) {
        let remembered = self.smoothed.get_mut(slot);
        if let (Some(smoothed), Some(shown)) = (remembered, self.disturbance.get_mut(slot)) {
            *smoothed += (disturbance - *smoothed) * T::from_f64(DISTURBANCE_SMOOTHING);
            *shown = disturbance;
        }
    }

    #[inline(never)]
    fn project(&mut self, wished: &Wished<'_, T>) {
        self.set_compliance(wished);
        self.find(wished);
        self.record(wished);
    }

    /// The acceleration within the bounds that is nearest by T.
    #[inline(always)]
    fn find(&mut self, wished: &Wished<'_, T>) {
        let bounds = wished.bounds;
        let search = &mut self.search;
        let mut pushed = search.start(wished.acceleration, bounds);
        self.pivots = 0;
        while pushed != NONE && self.pivots < PIVOTS {
            self.pivots += 1;
            pushed = search.exchange(pushed % WIDTH, self.pivots == PIVOTS);
        }
        self.at_bound = [IndexSet::NONE; 2];
        let mut within = true;
        for i in 0..DOF {
            let (a, low, high) = (search.acceleration(i), bounds.least[i], bounds.greatest[i]);
            // What is not a number is cut as well; the torque of the wish still shows it.
            let cut = a.most(low).least(high);
            within &= cut == a;
            self.at_bound[0].insert_if(i, cut == low);
            self.at_bound[1].insert_if(i, cut == high);
            self.acceleration[i] = cut;
        }
        self.unresolved = !within;
    }

    /// T.
    #[inline(always)]
    pub(crate) fn set_compliance(&mut self, wished: &Wished<'_, T>) {
        let cholesky = &wished.dynamics.cholesky;
        let tableau = &mut self.search.tableau;
        tableau.set_inverse(cholesky);
        let softening = T::from_f64(1.0 / SOFTENING_DISTURBANCE);
        for level in wished.levels.in_order() {
            let smoothed = self.smoothed.get(level.slot).copied();
            let share = smoothed.unwrap_or(T::ZERO) * softening;
            let softened = T::ONE + share * share;
            for direction in wished.spectrum.of(level) {
                let stiffening = level.filters.stiffening(direction.mobility, softened);
                let held = level.activation * stiffening;
                tableau.stiffen(cholesky, &direction.along, held);
            }
        }
        tableau.mirror();
    }

    /// What the difference to the wish does.
    #[inline(always)]
    pub(crate) fn record(&mut self, wished: &Wished<'_, T>) {
        let difference = self.acceleration - wished.acceleration;
        let torque = wished.dynamics.mass_matrix * difference;
        self.torque = wished.torque + torque;
        self.power = wished.null_velocity.dot(&torque);
        for level in wished.levels.in_order() {
            let mut squared = T::ZERO;
            let rows = wished.rows.jacobian.get(level.rows()).unwrap_or(&[]);
            for row in rows.iter().take(3) {
                let along = row.dot(&difference);
                squared += along * along;
            }
            self.disturb(level.slot, squared.square_root() * level.length);
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
// In this order in memory: what an exchange reads besides the tableau lies in reach of one base.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Search<T: Real> {
    /// a \[rad/s2\] of free joints, the multiplier \[Nm\] of joints at a bound.
    point: [T; WIDTH],
    /// 1 of joints at a bound, 0 of free ones.
    held: [T; WIDTH],
    /// 1 / sqrt(T_jj) of joints that may be chosen, T_jj before any sweep; 0 of others.
    choice: [T; WIDTH],
    least: [T; WIDTH],
    greatest: [T; WIDTH],
    /// The bound that a joint is at, or pushed to.
    bound: [T; WIDTH],
    /// 1 / T_jj.
    weight: [T; WIDTH],
    /// The multiplier so far of the joint that is pushed.
    so_far: T,
    tableau: Tableau<T>,
}

impl<T: Real> Search<T> {
    #[inline(always)]
    const fn new() -> Self {
        Self {
            point: [T::ZERO; WIDTH],
            held: [T::ZERO; WIDTH],
            choice: [T::ZERO; WIDTH],
            least: [T::ZERO; WIDTH],
            greatest: [T::ZERO; WIDTH],
            bound: [T::ZERO; WIDTH],
            weight: [T::ZERO; WIDTH],
            so_far: T::ZERO,
            tableau: Tableau::new(),
        }
    }

    /// All joints free, the tableau T; returns the joint to push first, or [`NONE`].
    #[inline(always)]
    fn start(&mut self, wish: &JointVector<T>, bounds: &AccelerationBounds<T>) -> usize {
        for i in 0..DOF {
            let weight = T::ONE / self.tableau.diagonal(i);
            self.point[i] = wish[i];
            self.held[i] = T::ZERO;
            self.least[i] = bounds.least[i];
            self.greatest[i] = bounds.greatest[i];
            self.weight[i] = weight;
            self.choice[i] = weight.square_root();
        }
        let worst = self.go(0, T::ZERO);
        self.choose(worst)
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
    /// the joint to push next, [`NONE`] where no bound is violated any more. The tableau behind
    /// the `last` exchange has no meaning.
    #[inline(always)]
    fn exchange(&mut self, pushed: usize, last: bool) -> usize {
        let pivot = self.tableau.diagonal(pushed);
        if pivot * self.weight[pushed] <= T::PIVOT_SHARE {
            return self.pass_over(pushed);
        }
        let step = (self.point[pushed] - self.bound[pushed]) / pivot;
        let (dropped, worst) = self.advance(pushed, step);
        let done = dropped == NONE;
        let swept = if done { pushed } else { dropped % WIDTH };
        if done {
            self.point[pushed] = self.so_far;
            self.held[pushed] = T::ONE;
        } else {
            self.point[swept] = self.bound[swept];
            self.held[swept] = T::ZERO;
            self.choice[swept] = self.weight[swept].square_root();
        }
        if last || (done && worst == NONE) {
            return NONE;
        }
        self.tableau
            .sweep(swept, if done { T::ONE } else { -T::ONE });
        if done { self.choose(worst) } else { pushed }
    }

    /// Where nothing gives way to a joint any more, the cut in the end keeps its bound: the next
    /// one is pushed.
    #[cold]
    #[inline(never)]
    fn pass_over(&mut self, joint: usize) -> usize {
        self.choice[joint % WIDTH] = T::ZERO;
        let worst = self.go(joint, T::ZERO);
        self.choose(worst)
    }

    /// Moves the multiplier of the pushed joint by `step`, or until the first joint leaves its
    /// bound: that one, or [`NONE`]; and what [`Search::go`] returns.
    #[inline(always)]
    fn advance(&mut self, pushed: usize, step: T) -> (usize, usize) {
        let row = self.tableau.row(pushed);
        // Above 1 a multiplier changes its sign on the way.
        let (mut most, mut ways) = (T::ONE, [T::ZERO; DOF]);
        for i in 0..DOF {
            ways[i] = row[i] * step * self.held[i] / self.point[i];
            most = ways[i].most(most);
        }
        let mut dropped = NONE;
        if most > T::ONE {
            for (i, &way) in ways.iter().enumerate() {
                if way == most {
                    dropped = i;
                }
            }
        } else {
            self.choice[pushed] = T::ZERO;
        }
        let step = step / most;
        self.so_far += step;
        (dropped, self.go(pushed, step))
    }

    /// Moves the multiplier of a joint by `step`. Returns the joint whose bound is then violated
    /// worst, by the cost of pushing it there, or [`NONE`].
    #[inline(always)]
    fn go(&mut self, pushed: usize, step: T) -> usize {
        let row = self.tableau.row(pushed);
        let (mut worst, mut most) = (NONE, T::ZERO);
        for i in 0..DOF {
            let value = self.point[i] - row[i] * step;
            self.point[i] = value;
            let violation = (value - self.greatest[i]).most(self.least[i] - value);
            let cost = violation * self.choice[i];
            if cost > most {
                (most, worst) = (cost, i);
            }
        }
        worst
    }

    /// Makes a joint, or [`NONE`], ready to be pushed.
    #[inline(always)]
    fn choose(&mut self, joint: usize) -> usize {
        let place = joint % WIDTH;
        self.so_far = T::ZERO;
        self.bound[place] = self.point[place]
            .most(self.least[place])
            .least(self.greatest[place]);
        joint
    }
}
