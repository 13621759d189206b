//! What levels and null space ask the joints for, as a joint acceleration a*.
//!
//! ```text
//! of level i     b    = ddx_d + K_d (dx_d - dx) + K_p x_err - (dJ/dt) dq     x_err shortened
//!                c    = E^T (b - A_i (u + ur)) + e,   e = E^T K_d E y^T s
//!                u_i  = left by the levels above of  sum of y_k (d_k clip(c)_k - p_k e_k)
//! of the rest    u_n  = null part of (L^-1 (f - D n) - kappa rho sn) + ur
//! a* = L^-T sum of k u,   k <= 1: no joint faster than it can, no torque beyond its limit
//! ```
//!
//! ur is what of the residual L^-1 r no level has compensated yet: it acts on the null space as
//! the force that it is. e takes part in both filters, so that the damping of a direction that
//! gets lost fades last.

use super::asked::{Asked, cut_together};
use super::bounds::JointBounds;
use super::motion::WhitenedMotion;
use super::spectrum::{Spectrum, left_by};
use super::way_out::WayOut;
use crate::arm::dynamics::Dynamics;
use crate::cells::Cells;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, zeros};
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
    /// k: share of what the level of each slot asks for that it gets, 1 where nothing is scaled.
    pub level_share: [T; MAX_LEVELS],
    /// The same of the null space.
    pub null_share: T,
    /// Slots of levels whose share is below 1; bit 7, the eighth, is the null space.
    pub scaled: IndexSet,
    /// Slots of levels whose command was shortened: by the speed of their error, or along a direction
    /// that gets lost.
    pub shaped: IndexSet,
    /// Acceleration \[m/s2\] of the level of each slot by what stands below it; 0 in cycles in
    /// which nothing is given to levels below: then it is rounding. Of orientations times
    /// [`ORIENTATION_LENGTH`](crate::ranges::ORIENTATION_LENGTH).
    pub leak: [T; MAX_LEVELS],
    /// What the rows of each level get by the stages down to its own, in cycles in which levels
    /// below get a share of a direction.
    of_rows: [T; MAX_ROWS],
    // Of the cycle alone; here, because on the stack they would have to be cleared first.
    /// u: what the stages so far ask for, whitened.
    whitened: JointVector<T>,
    /// ur: L^-1 r, less what the levels so far have compensated.
    residual: JointVector<T>,
    /// Parts along the directions of what was split last.
    parts: [T; MAX_ROWS],
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
    pub way_out: &'a WayOut<T>,
    /// f - D n \[Nm\].
    pub null_force: &'a JointVector<T>,
    /// r \[Nm\].
    pub residual: &'a JointVector<T>,
}

/// `share`, or what of `torque` \[Nm\] there is room for on top of `before` within `limit`.
#[inline(always)]
fn torque_share<T: Real>(
    mut share: T,
    before: &JointVector<T>,
    torque: &JointVector<T>,
    limit: &JointVector<T>,
) -> T {
    let least = T::from_f64(1e-9);
    for i in 0..DOF {
        // The room on the side of the torque, and the torque, both times its size.
        let size = torque[i].magnitude().most(least);
        let room = limit[i] * size - before[i] * torque[i];
        share = (room.most(T::ZERO) / (size * size)).least(share);
    }
    share
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
            of_rows: [T::ZERO; MAX_ROWS],
            whitened: zeros(),
            residual: zeros(),
            parts: [T::ZERO; MAX_ROWS],
        }
    }

    /// What is asked for so far, and what is told of it.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.numbers("wish", self.acceleration.as_mut_slice());
        cells.numbers("wish_torque", self.torque.as_mut_slice());
        cells.numbers("wish_whitened", self.whitened.as_mut_slice());
        cells.numbers("wish_residual", self.residual.as_mut_slice());
        cells.numbers("wish_rows", &mut self.of_rows);
        cells.numbers("level_share", &mut self.level_share);
        cells.numbers("null_share", core::slice::from_mut(&mut self.null_share));
        cells.numbers("leak", &mut self.leak);
        cells.set("scaled", &mut self.scaled.0);
        cells.set("shaped", &mut self.shaped.0);
    }

    /// Level by level, then the null space. Behind a call: what it reads lies far apart.
    #[inline(never)]
    pub(crate) fn update(&mut self, ask: &Ask<'_, T>) {
        self.begin(ask);
        for level in ask.levels.in_order() {
            self.add_level(ask, level);
        }
        self.add_rest(ask);
    }

    /// Nothing asked for yet, nothing of the residual compensated.
    #[inline(always)]
    pub(crate) fn begin(&mut self, ask: &Ask<'_, T>) {
        let dynamics = ask.dynamics;
        // C dq + g - r + L u.
        self.torque = dynamics.coriolis + dynamics.gravity - ask.residual;
        self.residual = dynamics.cholesky.solve_lower(ask.residual);
        (self.scaled, self.shaped) = (IndexSet::NONE, IndexSet::NONE);
        if ask.levels.in_order().is_empty() {
            (self.whitened, self.acceleration) = (zeros(), zeros());
        }
    }

    /// What a level asks for, those above it asked already.
    #[inline(always)]
    pub(crate) fn add_level(&mut self, ask: &Ask<'_, T>, level: &Level<T>) {
        let spectrum = ask.spectrum;
        let (mut command, shaped) = self.command(ask, level);
        if spectrum.shares {
            // Once more: of a direction that a level above has released, the share that it
            // has been given back twice.
            command = left_by(spectrum.above(level), &command, &mut self.parts);
        }
        let share = if level.start > 0 {
            let before = self.torque + ask.dynamics.cholesky.lower_times(&self.residual);
            self.add(ask, &command, Some(&before))
        } else {
            self.add(ask, &command, None)
        };
        let slot = level.slot.min(MAX_LEVELS - 1);
        (self.level_share[slot], self.leak[slot]) = (share, T::ZERO);
        self.shaped.insert_if(slot, shaped);
        self.scaled.insert_if(slot, share < T::ONE);
        if spectrum.shares {
            let known = self.whitened + self.residual;
            set_rows(&mut self.of_rows, level, spectrum, &known);
        }
    }

    /// What the null space asks for, all levels asked.
    #[inline(always)]
    pub(crate) fn add_rest(&mut self, ask: &Ask<'_, T>) {
        let command = self.null_command(ask);
        let before = self.torque;
        self.null_share = self.add(ask, &command, Some(&before));
        self.scaled.insert_if(MAX_LEVELS, self.null_share < T::ONE);
        if ask.spectrum.shares {
            self.set_leaks(ask);
        }
    }

    /// Adds a stage; returns the share of it that is added: no joint is asked for more than
    /// alpha, and none for more torque than there is on top of `before` \[Nm\]. The first stage
    /// has nothing before it. Behind a call: it is in the flash once.
    #[inline(never)]
    fn add(
        &mut self,
        ask: &Ask<'_, T>,
        stage: &JointVector<T>,
        before: Option<&JointVector<T>>,
    ) -> T {
        let cholesky = &ask.dynamics.cholesky;
        let acceleration = cholesky.solve_upper(stage);
        let mut most = T::ONE;
        for i in 0..DOF {
            let of_joint = (acceleration[i] * ask.bounds.inverse_acceleration[i]).magnitude();
            most = of_joint.most(most);
        }
        let mut share = T::ONE / most;
        let torque = cholesky.lower_times(stage);
        if let Some(before) = before {
            share = torque_share(share, before, &torque, ask.torque_limit);
            for i in 0..DOF {
                self.whitened[i] += stage[i] * share;
                self.acceleration[i] += acceleration[i] * share;
            }
        } else {
            for i in 0..DOF {
                self.whitened[i] = stage[i] * share;
                self.acceleration[i] = acceleration[i] * share;
            }
        }
        for i in 0..DOF {
            self.torque[i] += torque[i] * share;
        }
        share
    }

    /// u_i, and whether it was shortened; takes off the residual what the level compensates.
    #[inline(always)]
    fn command(&mut self, ask: &Ask<'_, T>, level: &Level<T>) -> (JointVector<T>, bool) {
        let first = level.start == 0;
        let (rows, directions) = (ask.rows, ask.spectrum.of(level));
        let along = ask.motion.along.get(level.rows()).unwrap_or(&[]);
        let commanded = rows.commanded.get(level.rows()).unwrap_or(&[]);
        let bias = rows.bias.get(level.rows()).unwrap_or(&[]);
        let (mut wanted, mut speed) = ([T::ZERO; 3], [T::ZERO; 3]);
        let known = self.whitened + self.residual;
        let given = commanded.iter().zip(bias).zip(along);
        for (k, (direction, ((commanded, bias), along))) in
            directions.iter().zip(given).enumerate().take(3)
        {
            wanted[k] = *commanded - *bias;
            if !first {
                wanted[k] -= direction.row.dot(&known);
            }
            direction.add_part(*along, &mut speed);
        }
        let damped = level.damping_of_rows(&speed);
        let mut shaped = rows.shortened.contains(level.slot);
        let (mut commands, mut owns) = ([T::ZERO; 3], [T::ZERO; 3]);
        let mut compensated = [T::ZERO; 3];
        for (k, direction) in directions.iter().enumerate().take(3) {
            let asked = Asked::of(direction, &wanted, &damped, &self.residual, first);
            (commands[k], owns[k], compensated[k]) = (asked.command, asked.own, asked.kept);
        }
        if ask.spectrum.limits_commands {
            // By copies: what is pointed to could not stay in registers where nothing is cut.
            let (cut, is_cut) = cut_together(level, directions, commands);
            commands = cut;
            shaped |= is_cut;
        }
        let mut forces = [T::ZERO; 3];
        for (k, direction) in directions.iter().enumerate().take(3) {
            forces[k] = direction.drive * commands[k] - direction.keep * owns[k];
        }
        let mut command = match directions {
            [first, ..] => first.along * forces[0],
            [] => zeros(),
        };
        for (direction, &force) in directions.iter().zip(&forces).skip(1) {
            for i in 0..DOF {
                command[i] += direction.along[i] * force;
            }
        }
        for (direction, &compensated) in directions.iter().zip(&compensated) {
            for i in 0..DOF {
                self.residual[i] -= direction.along[i] * compensated;
            }
        }
        (command, shaped)
    }

    /// u_n, with what bends a straight arm.
    #[inline(always)]
    fn null_command(&mut self, ask: &Ask<'_, T>) -> JointVector<T> {
        let mut force = ask.dynamics.cholesky.solve_lower(ask.null_force);
        let damping = T::from_f64(RELEASE_DAMPING) * ask.spectrum.release;
        for i in 0..DOF {
            force[i] -= ask.motion.null[i] * damping;
        }
        if ask.way_out.bends() {
            force += ask.way_out.whitened;
        }
        left_by(ask.spectrum.directions(), &force, &mut self.parts) + self.residual
    }

    /// What the levels get by all stages beyond what they get by those down to their own.
    #[inline(never)]
    fn set_leaks(&mut self, ask: &Ask<'_, T>) {
        let mut all = [T::ZERO; MAX_ROWS];
        for level in ask.levels.in_order() {
            let Some(leak) = self.leak.get_mut(level.slot) else {
                continue;
            };
            set_rows(&mut all, level, ask.spectrum, &self.whitened);
            let mut squared = T::ZERO;
            let rows = all.get(level.rows()).unwrap_or(&[]).iter();
            let own = self.of_rows.get(level.rows()).unwrap_or(&[]);
            for (all, own) in rows.zip(own).take(3) {
                squared += (*all - *own) * (*all - *own);
            }
            *leak = squared.square_root() * level.length;
        }
    }
}

/// What the rows of a level get by x: A x.
#[inline(never)]
fn set_rows<T: Real>(
    of_rows: &mut [T; MAX_ROWS],
    level: &Level<T>,
    spectrum: &Spectrum<T>,
    x: &JointVector<T>,
) {
    let of_rows = of_rows.get_mut(level.rows()).unwrap_or(&mut []);
    for (of_row, direction) in of_rows.iter_mut().zip(spectrum.of(level)).take(3) {
        *of_row = direction.row.dot(x);
    }
}

impl<T: Real> Default for Wish<T> {
    fn default() -> Self {
        Self::new()
    }
}
