//! What levels and null space ask the joints for, as a joint acceleration a*.
//!
//! ```text
//! of level i     b    = ddx_d + K_d (dx_d - dx) + K_p x_err - (dJ/dt) dq     x_err shortened
//!                c    = E^T (b - A_i (u + ur)) + e,   e = E^T K_d E y^T s
//!                u_i  = left by the levels above of  sum of y_k (d_k clip(c_k) - p_k e_k)
//! of the rest    u_n  = null part of (L^-1 (f - D n) - kappa rho sn) + ur
//! a* = L^-T sum of k u,   k <= 1: no joint faster than it can, no torque beyond its limit
//! ```
//!
//! ur is what of the residual L^-1 r no level has compensated yet: it acts on the null space as
//! the force that it is. e takes part in both filters, so that the damping of a direction that
//! gets lost fades last.

use super::bounds::JointBounds;
use super::eigen::Eigen;
use super::motion::WhitenedMotion;
use super::spectrum::Spectrum;
use crate::arm::dynamics::Dynamics;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, zeros};
use crate::linalg::Cholesky;
use crate::ranges::{MAX_LEVELS, MAX_ROWS, RELEASE_DAMPING};
use crate::real::Real;
use crate::task::rows::TaskRows;
use crate::task::set::{Level, Levels};

/// What all stages ask for together.
#[derive(Clone, Copy, Debug)]
pub struct Wish<T: Real> {
    /// a* \[rad/s2\].
    pub acceleration: JointVector<T>,
    /// Torque \[Nm\] that gives it.
    pub torque: JointVector<T>,
    /// k: share of what each level asks for that it gets, 1 where nothing is scaled.
    pub level_share: [T; MAX_LEVELS],
    /// The same of the null space.
    pub null_share: T,
    /// Levels whose share is below 1; bit 7, the eighth, is the null space.
    pub scaled: IndexSet,
    /// Levels whose command was shortened: by the speed of their error, or along a direction
    /// that gets lost.
    pub shaped: IndexSet,
    /// Acceleration \[m/s2\] of each level by what stands below it; 0 but for rounding where
    /// nothing above is released. Of orientations times
    /// [`ORIENTATION_LENGTH`](crate::ranges::ORIENTATION_LENGTH).
    pub leak: [T; MAX_LEVELS],
}

/// What the wish is made from.
pub(crate) struct Ask<'a, T: Real> {
    pub levels: &'a Levels<T>,
    pub bounds: &'a JointBounds<T>,
    pub torque_limit: &'a JointVector<T>,
    pub dynamics: &'a Dynamics<T>,
    pub rows: &'a TaskRows<T>,
    pub spectrum: &'a Spectrum<T>,
    pub motion: &'a WhitenedMotion<T>,
    /// f - D n \[Nm\].
    pub null_force: &'a JointVector<T>,
    /// r \[Nm\].
    pub residual: &'a JointVector<T>,
}

/// The stages so far.
struct Sum<T: Real> {
    /// u: what they ask for, whitened.
    whitened: JointVector<T>,
    /// L^-T of it \[rad/s2\].
    acceleration: JointVector<T>,
    /// ur: L^-1 r, less what the levels so far have compensated.
    residual: JointVector<T>,
    /// C dq + g - r \[Nm\].
    bias: JointVector<T>,
}

impl<T: Real> Wish<T> {
    /// No wish yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            acceleration: zeros(),
            torque: zeros(),
            level_share: [T::ONE; MAX_LEVELS],
            null_share: T::ONE,
            scaled: IndexSet::NONE,
            shaped: IndexSet::NONE,
            leak: [T::ZERO; MAX_LEVELS],
        }
    }

    /// Level by level, then the null space.
    #[inline]
    pub(crate) fn update(&mut self, ask: &Ask<'_, T>) {
        let (dynamics, spectrum) = (ask.dynamics, ask.spectrum);
        let cholesky = &dynamics.cholesky;
        let mut sum = Sum {
            whitened: zeros(),
            acceleration: zeros(),
            residual: cholesky.solve_lower(ask.residual),
            bias: dynamics.coriolis + dynamics.gravity - ask.residual,
        };
        (self.scaled, self.shaped) = (IndexSet::NONE, IndexSet::NONE);
        // What the rows of each level get by the stages down to their own.
        let mut own = [T::ZERO; MAX_ROWS];
        for (number, level) in ask.levels.as_slice().iter().enumerate() {
            let command = self.command(ask, number, level, &mut sum);
            let share = self.add(ask, &command, number > 0, &mut sum);
            self.scaled.insert_if(number, share < T::ONE);
            if let Some(of_level) = self.level_share.get_mut(number) {
                *of_level = share;
            }
            let total = sum.whitened + sum.residual;
            for k in level.rows() {
                if k < MAX_ROWS {
                    own[k] = spectrum.rows[k].dot(&total);
                }
            }
        }
        let force = cholesky.solve_lower(ask.null_force);
        let damping = T::from_f64(RELEASE_DAMPING) * spectrum.release;
        let command = spectrum.null_part(&(force - ask.motion.null * damping)) + sum.residual;
        sum.residual = zeros();
        self.null_share = self.add(ask, &command, true, &mut sum);
        self.scaled.insert_if(MAX_LEVELS, self.null_share < T::ONE);
        self.acceleration = sum.acceleration;
        self.set_leaks(ask, &own, &sum.whitened);
    }

    /// u_i; takes off the residual what the level compensates.
    #[inline(always)]
    fn command(
        &mut self,
        ask: &Ask<'_, T>,
        number: usize,
        level: &Level<T>,
        sum: &mut Sum<T>,
    ) -> JointVector<T> {
        let (rows, spectrum) = (ask.rows, ask.spectrum);
        let before = sum.residual;
        let mut vectors = [[T::ZERO; 3]; 3];
        let mut along = [T::ZERO; 3];
        for k in 0..level.size {
            let place = level.start + k;
            if place < MAX_ROWS {
                let direction = &spectrum.directions[place];
                sum.residual -= direction * (spectrum.keep[place] * direction.dot(&before));
                vectors[k] = spectrum.vectors[place];
                along[k] = ask.motion.along[place];
            }
        }
        let known = sum.whitened + sum.residual;
        let mut wanted = [T::ZERO; 3];
        for k in 0..level.size {
            let place = level.start + k;
            if place < MAX_ROWS {
                let commanded = rows.commanded[place] - rows.bias[place];
                wanted[k] = commanded * level.length - spectrum.rows[place].dot(&known);
            }
        }
        let damped = level.damping_of_rows(&Eigen::times(&vectors, &along));
        let own = Eigen::transposed_times(&vectors, &damped);
        let wanted = Eigen::transposed_times(&vectors, &wanted);
        let mut shaped = rows.shortened.contains(number);
        let mut command: JointVector<T> = zeros();
        for k in 0..level.size {
            let place = level.start + k;
            if place < MAX_ROWS {
                let asked = wanted[k] + own[k];
                let most = level.filters.most_command(spectrum.mobility[place]);
                let cut = asked.limited(-most, most);
                shaped |= cut != asked;
                let force = spectrum.drive[place] * cut - spectrum.keep[place] * own[k];
                command += spectrum.directions[place] * force;
            }
        }
        self.shaped.insert_if(number, shaped);
        if number > 0 {
            // Once more: of a direction that a level above has released, the share that it has
            // been given back twice.
            command = spectrum.left_by(level.start, &command);
        }
        command
    }

    /// Adds a stage, scaled to what the joints can do, one below the first level also to the
    /// torque that is left; and returns its share. `self.torque` becomes the torque of all
    /// stages so far.
    #[inline(always)]
    fn add(
        &mut self,
        ask: &Ask<'_, T>,
        command: &JointVector<T>,
        gives_way: bool,
        sum: &mut Sum<T>,
    ) -> T {
        let cholesky = &ask.dynamics.cholesky;
        let acceleration = cholesky.solve_upper(command);
        let mut most = T::ONE;
        for i in 0..DOF {
            most = (acceleration[i] * ask.bounds.inverse_acceleration[i])
                .magnitude()
                .larger(most);
        }
        let mut share = T::ONE / most;
        if gives_way {
            let before = torque_before(cholesky, sum);
            let torque = cholesky.lower_times(command) * share;
            let room = room(&before, &torque, ask.torque_limit);
            self.torque = before + torque * room;
            share *= room;
        }
        sum.whitened += command * share;
        sum.acceleration += acceleration * share;
        share
    }

    /// What the levels got beyond `own`.
    #[inline(always)]
    fn set_leaks(&mut self, ask: &Ask<'_, T>, own: &[T; MAX_ROWS], whitened: &JointVector<T>) {
        for (number, level) in ask.levels.as_slice().iter().enumerate() {
            let mut squared = T::ZERO;
            for k in level.rows() {
                if k < MAX_ROWS {
                    let below = ask.spectrum.rows[k].dot(whitened) - own[k];
                    squared += below * below;
                }
            }
            if let Some(leak) = self.leak.get_mut(number) {
                *leak = squared.square_root();
            }
        }
    }
}

/// C dq + g - r + L (u + ur) \[Nm\].
#[inline(always)]
fn torque_before<T: Real>(cholesky: &Cholesky<T>, sum: &Sum<T>) -> JointVector<T> {
    sum.bias + cholesky.lower_times(&(sum.whitened + sum.residual))
}

/// Largest share, at most 1, of `torque` \[Nm\] that goes on top of `before` within `limit`.
#[inline(always)]
fn room<T: Real>(before: &JointVector<T>, torque: &JointVector<T>, limit: &JointVector<T>) -> T {
    let least = T::from_f64(1e-9);
    let mut share = T::ONE;
    for i in 0..DOF {
        let size = torque[i].magnitude().larger(least);
        let towards = T::ONE.with_sign_of(torque[i]) * before[i];
        let room = (limit[i] - towards).larger(T::ZERO);
        share = share.limited(T::ZERO, room / size);
    }
    share
}

impl<T: Real> Default for Wish<T> {
    fn default() -> Self {
        Self::new()
    }
}
