//! The motion along the directions of the levels, and what is left of it for the null space.
//!
//! ```text
//! s = L^T dq      sn = s - sum of p_k y_k y_k^T s      n = L^-T sn      w = dq - n
//! F_i = E d E^T Ah_i (s - V),   V = sum over the levels j below of A_j^T F_j
//! ```

use super::eigen::Eigen;
use super::spectrum::Spectrum;
use crate::arm::dynamics::Dynamics;
use crate::joint::{JointState, JointVector, zeros};
use crate::law::motion::MotionSplit;
use crate::ranges::MAX_ROWS;
use crate::real::Real;
use crate::task::set::Levels;

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
        for k in 0..MAX_ROWS {
            if k < spectrum.count() {
                let direction = &spectrum.directions[k];
                let along = direction.dot(&whitened);
                self.along[k] = along;
                self.null -= direction * (spectrum.keep[k] * along);
            }
        }
        split.null_velocity = cholesky.solve_upper(&self.null);
        split.task_velocity = joints.dq - split.null_velocity;
        self.set_momenta(&mut split.task_momentum, levels, spectrum, &whitened);
    }

    /// F, from the last level to the first.
    #[inline(always)]
    fn set_momenta(
        &self,
        momentum: &mut [T; MAX_ROWS],
        levels: &Levels<T>,
        spectrum: &Spectrum<T>,
        whitened: &JointVector<T>,
    ) {
        let mut carried: Option<JointVector<T>> = None;
        for level in levels.as_slice().iter().rev() {
            let mut along = [T::ZERO; 3];
            let mut vectors = [[T::ZERO; 3]; 3];
            for k in 0..level.size {
                let place = level.start + k;
                if place < MAX_ROWS {
                    vectors[k] = spectrum.vectors[place];
                    let speed = match &carried {
                        None => self.along[place],
                        Some(below) => spectrum.directions[place].dot(&(whitened - below)),
                    };
                    along[k] = spectrum.drive[place] * speed;
                }
            }
            let of_level = Eigen::times(&vectors, &along);
            for k in 0..level.size {
                let place = level.start + k;
                if place < MAX_ROWS {
                    // Of the unscaled rows of J.
                    momentum[place] = of_level[k] * level.length;
                    if level.start > 0 {
                        let share = spectrum.rows[place] * of_level[k];
                        carried = Some(match carried {
                            None => share,
                            Some(below) => below + share,
                        });
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
