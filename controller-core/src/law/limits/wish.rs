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
use super::motion::WhitenedMotion;
use super::spectrum::{Spectrum, left_by};
use crate::arm::dynamics::Dynamics;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, zeros};
use crate::linalg::Cholesky;
use crate::ranges::{MAX_LEVELS, MAX_ROWS, RELEASE_DAMPING};
use crate::real::Real;
use crate::task::level::{Level, Levels};
use crate::task::rows::TaskRows;

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
    /// L^-T u \[rad/s2\].
    acceleration: JointVector<T>,
    /// ur: L^-1 r, less what the levels so far have compensated.
    residual: JointVector<T>,
    /// C dq + g - r \[Nm\].
    bias: JointVector<T>,
}

impl<T: Real> Sum<T> {
    /// u + ur.
    #[inline(always)]
    fn known(&self) -> JointVector<T> {
        self.whitened + self.residual
    }

    /// Adds a share of a stage.
    #[inline(always)]
    fn add(&mut self, stage: &Stage<T>, share: T) {
        for i in 0..DOF {
            self.whitened[i] += stage.whitened[i] * share;
            self.acceleration[i] += stage.acceleration[i] * share;
        }
    }
}

/// What one stage asks for.
struct Stage<T: Real> {
    whitened: JointVector<T>,
    /// L^-T of it \[rad/s2\].
    acceleration: JointVector<T>,
}

impl<T: Real> Stage<T> {
    #[inline(always)]
    fn new(cholesky: &Cholesky<T>, whitened: JointVector<T>) -> Self {
        Self {
            acceleration: cholesky.solve_upper(&whitened),
            whitened,
        }
    }

    /// Share, at most 1, with which no joint is asked for more than alpha.
    #[inline(always)]
    fn moderate_share(&self, bounds: &JointBounds<T>) -> T {
        let mut most = T::ONE;
        for i in 0..DOF {
            let of_joint = (self.acceleration[i] * bounds.inverse_acceleration[i]).magnitude();
            most = if of_joint > most { of_joint } else { most };
        }
        T::ONE / most
    }
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
        let levels = ask.levels.as_slice().iter();
        for (number, (level, of_level)) in levels.zip(&mut self.level_share).enumerate() {
            let (command, shaped) = command(ask, number, level, &mut sum);
            let stage = Stage::new(cholesky, command);
            let mut share = stage.moderate_share(ask.bounds);
            if number > 0 {
                let before = sum.bias + cholesky.lower_times(&sum.known());
                let torque = cholesky.lower_times(&stage.whitened);
                share *= torque_share(&before, &torque, share, ask.torque_limit);
            }
            sum.add(&stage, share);
            *of_level = share;
            self.shaped.insert_if(number, shaped);
            self.scaled.insert_if(number, share < T::ONE);
            let known = sum.known();
            if let Some(own) = own.get_mut(level.rows()) {
                for (own, direction) in own.iter_mut().zip(spectrum.of(level)) {
                    *own = direction.row.dot(&known);
                }
            }
        }
        self.add_null_space(ask, &mut sum);
        self.acceleration = sum.acceleration;
        self.set_leaks(ask, &own, &sum.whitened);
    }

    /// The null space; makes the torque of all stages.
    #[inline(always)]
    fn add_null_space(&mut self, ask: &Ask<'_, T>, sum: &mut Sum<T>) {
        let cholesky = &ask.dynamics.cholesky;
        let mut force = cholesky.solve_lower(ask.null_force);
        let damping = T::from_f64(RELEASE_DAMPING) * ask.spectrum.release;
        for i in 0..DOF {
            force[i] -= ask.motion.null[i] * damping;
        }
        let command = ask.spectrum.null_part(&force) + sum.residual;
        let stage = Stage::new(cholesky, command);
        let moderate = stage.moderate_share(ask.bounds);
        let before = sum.bias + cholesky.lower_times(&sum.whitened);
        let torque = cholesky.lower_times(&stage.whitened);
        let share = moderate * torque_share(&before, &torque, moderate, ask.torque_limit);
        sum.add(&stage, share);
        self.torque = before + torque * share;
        self.null_share = share;
        self.scaled.insert_if(MAX_LEVELS, share < T::ONE);
    }

    /// What the levels got beyond `own`.
    #[inline(always)]
    fn set_leaks(&mut self, ask: &Ask<'_, T>, own: &[T; MAX_ROWS], whitened: &JointVector<T>) {
        let levels = ask.levels.as_slice().iter();
        for (level, leak) in levels.zip(&mut self.leak) {
            let mut squared = T::ZERO;
            let own = own.get(level.rows()).unwrap_or(&[]);
            for (direction, own) in ask.spectrum.of(level).iter().zip(own) {
                let below = direction.row.dot(whitened) - *own;
                squared += below * below;
            }
            *leak = squared.square_root() * level.length;
        }
    }
}

/// u_i, and whether it was shortened; takes off the residual what the level compensates.
#[inline(always)]
fn command<T: Real>(
    ask: &Ask<'_, T>,
    number: usize,
    level: &Level<T>,
    sum: &mut Sum<T>,
) -> (JointVector<T>, bool) {
    let (rows, spectrum) = (ask.rows, ask.spectrum);
    let directions = spectrum.of(level);
    sum.residual = left_by(directions, &sum.residual);
    let known = sum.known();
    let along = ask.motion.along.get(level.rows()).unwrap_or(&[]);
    let commanded = rows.commanded.get(level.rows()).unwrap_or(&[]);
    let bias = rows.bias.get(level.rows()).unwrap_or(&[]);
    let (mut wanted, mut speed) = ([T::ZERO; 3], [T::ZERO; 3]);
    for (k, direction) in directions.iter().enumerate().take(3) {
        if let (Some(along), Some(commanded), Some(bias)) =
            (along.get(k), commanded.get(k), bias.get(k))
        {
            wanted[k] = *commanded - *bias - direction.row.dot(&known);
            direction.add_part(*along, &mut speed);
        }
    }
    let damped = level.damping_of_rows(&speed);
    let mut shaped = rows.shortened.contains(number);
    let mut command: JointVector<T> = zeros();
    for direction in directions {
        let own = direction.part(&damped);
        let asked = direction.part(&wanted) + own;
        let most = level.filters.most_command(direction.mobility);
        let cut = asked.limited(-most, most);
        shaped |= cut != asked;
        let force = direction.drive * cut - direction.keep * own;
        for i in 0..DOF {
            command[i] += direction.along[i] * force;
        }
    }
    if number > 0 {
        // Once more: of a direction that a level above has released, the share that it has
        // been given back twice.
        command = left_by(spectrum.above(level), &command);
    }
    (command, shaped)
}

/// Largest share, at most 1, of a torque of `share` times `torque` \[Nm\] that goes on top of
/// `before` within `limit`.
#[inline(always)]
fn torque_share<T: Real>(
    before: &JointVector<T>,
    torque: &JointVector<T>,
    share: T,
    limit: &JointVector<T>,
) -> T {
    let least = T::from_f64(1e-9);
    let mut room = T::ONE;
    for i in 0..DOF {
        let asked = torque[i] * share;
        let towards = T::ONE.with_sign_of(asked) * before[i];
        let of_joint = (limit[i] - towards).larger(T::ZERO) / asked.magnitude().larger(least);
        room = if of_joint < room { of_joint } else { room };
    }
    room
}

impl<T: Real> Default for Wish<T> {
    fn default() -> Self {
        Self::new()
    }
}
