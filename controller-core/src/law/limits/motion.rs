//! The motion along the directions of the levels, and what is left of it for the null space.
//!
//! ```text
//! s = L^T dq      sn = s - sum of p_k y_k y_k^T s      n = L^-T sn      w = dq - n
//! F_i = E d E^T Ah_i (s - V),   V = sum over the levels j below of A_j^T F_j
//! ```

use super::spectrum::{Spectrum, left_by};
use crate::joint::{JointVector, zeros};
use crate::law::motion::MotionSplit;
use crate::linalg::Cholesky;
use crate::ranges::MAX_ROWS;
use crate::real::Real;
use crate::task::level::Levels;

/// The motion in whitened coordinates.
#[derive(Clone, Copy, Debug)]
pub struct WhitenedMotion<T: Real> {
    /// y^T s per direction.
    pub along: [T; MAX_ROWS],
    /// sn = L^T n: its squared length is twice the kinetic energy of the null-space motion \[J\].
    pub null: JointVector<T>,
}

impl<T: Real> WhitenedMotion<T> {
    /// At rest.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            along: [T::ZERO; MAX_ROWS],
            null: zeros(),
        }
    }

    /// Splits dq, here and in joint coordinates. Behind a call: what it reads lies far apart.
    #[inline(never)]
    pub(crate) fn update(
        &mut self,
        split: &mut MotionSplit<T>,
        levels: &Levels<T>,
        cholesky: &Cholesky<T>,
        spectrum: &Spectrum<T>,
        dq: &JointVector<T>,
    ) {
        let whitened = cholesky.upper_times(dq);
        self.null = left_by(spectrum.directions(), &whitened, &mut self.along);
        split.null_velocity = cholesky.solve_upper(&self.null);
        split.task_velocity = dq - split.null_velocity;
        self.set_momenta(&mut split.task_momentum, levels, spectrum);
    }

    /// F, from the last level to the first.
    #[inline(always)]
    fn set_momenta(
        &self,
        momentum: &mut [T; MAX_ROWS],
        levels: &Levels<T>,
        spectrum: &Spectrum<T>,
    ) {
        // Of the levels that are still to come y^T (s - V) of their directions.
        let used = momentum.iter_mut().zip(&self.along);
        for (rest, along) in used.take(spectrum.directions().len()) {
            *rest = *along;
        }
        for level in levels.in_order().iter().rev() {
            let (directions, rows) = (spectrum.of(level), level.rows());
            let mut of_level = [T::ZERO; 3];
            let own = momentum.get(rows.clone()).unwrap_or(&[]);
            for (direction, &rest) in directions.iter().zip(own) {
                direction.add_part(direction.drive * rest, &mut of_level);
            }
            let above = momentum.get_mut(..level.start).unwrap_or(&mut []);
            for (direction, &of_row) in directions.iter().zip(&of_level) {
                for (rest, &along) in above.iter_mut().zip(&direction.of_above) {
                    *rest -= along * of_row;
                }
            }
            let own = momentum.get_mut(rows).unwrap_or(&mut []);
            for (momentum, of_row) in own.iter_mut().zip(of_level) {
                *momentum = of_row;
            }
        }
    }
}

impl<T: Real> Default for WhitenedMotion<T> {
    fn default() -> Self {
        Self::new()
    }
}
