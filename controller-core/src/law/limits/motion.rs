//! The motion along the directions of the levels, and what is left of it for the null space.
//!
//! ```text
//! s = L^T dq      sn = s - sum of p_k y_k y_k^T s      n = L^-T sn      w = dq - n
//! F_i = E d E^T Ah_i (s - V),   V = sum over the levels j below of A_j^T F_j
//! ```

use super::spectrum::Spectrum;
use crate::arm::dynamics::Dynamics;
use crate::joint::{DOF, JointState, JointVector, zeros};
use crate::law::motion::MotionSplit;
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

    /// Splits dq, here and in joint coordinates.
    #[inline]
    pub(crate) fn update(
        &mut self,
        split: &mut MotionSplit<T>,
        levels: &Levels<T>,
        dynamics: &Dynamics<T>,
        spectrum: &Spectrum<T>,
        joints: &JointState<T>,
    ) {
        let cholesky = &dynamics.cholesky;
        let whitened = cholesky.upper_times(&joints.dq);
        self.null = whitened;
        for (along, direction) in self.along.iter_mut().zip(spectrum.directions()) {
            *along = direction.along.dot(&whitened);
            let kept = direction.keep * *along;
            for i in 0..DOF {
                self.null[i] -= direction.along[i] * kept;
            }
        }
        split.null_velocity = cholesky.solve_upper(&self.null);
        split.task_velocity = joints.dq - split.null_velocity;
        self.set_momenta(&mut split.task_momentum, levels, spectrum, whitened);
    }

    /// F, from the last level to the first; `rest` is s - V.
    #[inline(always)]
    fn set_momenta(
        &self,
        momentum: &mut [T; MAX_ROWS],
        levels: &Levels<T>,
        spectrum: &Spectrum<T>,
        mut rest: JointVector<T>,
    ) {
        for level in levels.as_slice().iter().rev() {
            let mut of_level = [T::ZERO; 3];
            for direction in spectrum.of(level) {
                let speed = direction.along.dot(&rest);
                direction.add_part(direction.drive * speed, &mut of_level);
            }
            let Some(momentum) = momentum.get_mut(level.rows()) else {
                return;
            };
            for ((momentum, direction), of_row) in
                momentum.iter_mut().zip(spectrum.of(level)).zip(of_level)
            {
                *momentum = of_row;
                if level.start > 0 {
                    for i in 0..DOF {
                        rest[i] -= direction.row[i] * of_row;
                    }
                }
            }
        }
    }
}

impl<T: Real> Default for WhitenedMotion<T> {
    fn default() -> Self {
        Self::new()
    }
}
