//! The directions in which each level can move the arm, and how easily.
//!
//! ```text
//! A_i  = J_i L^-T                                             whitened rows, M = L L^T
//! Ah_i = A_i - sum over rows k above of p_k (A_i y_k) y_k^T   what the levels above leave
//! S_i  = Ah_i A_i^T = E diag(z) E^T,   y = rows of E^T Ah_i
//! ```
//!
//! z \[1/kg\] is the mobility of a direction: the acceleration along it of a unit force. At a
//! singularity it goes to zero, and 1/z with which the exact law drives it grows without bound.
//! Two filters take the place of 1/z, equal to it above their thresholds: d, with which a
//! direction is driven, and p, with which it is kept from the levels below.

use super::eigen::Eigen;
use crate::fault::IndexSet;
use crate::joint::{JointVector, zeros};
use crate::linalg::Cholesky;
use crate::ranges::MAX_ROWS;
use crate::real::Real;
use crate::task::rows::TaskRows;
use crate::task::set::{Level, Levels};

/// Directions of all levels, as many per level as it has rows. Behind the last one the arrays
/// have no meaning.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum<T: Real> {
    count: usize,
    /// A: rows of J L^-T, those of orientations times [`ORIENTATION_LENGTH`]
    /// (crate::ranges::ORIENTATION_LENGTH).
    pub rows: [JointVector<T>; MAX_ROWS],
    /// y: what of them is left to the level, along its directions.
    pub directions: [JointVector<T>; MAX_ROWS],
    /// z \[1/kg\] per direction.
    pub mobility: [T; MAX_ROWS],
    /// d \[kg\]: 1/z, or less than it where the level is degraded.
    pub drive: [T; MAX_ROWS],
    /// p \[kg\]: 1/z, or less than it where the level is released.
    pub keep: [T; MAX_ROWS],
    /// E by rows of the level.
    pub vectors: [[T; 3]; MAX_ROWS],
    /// rho: the square of how far the most released direction is below its threshold, 0 to 1.
    pub release: T,
    /// Levels with a direction that is driven by less than 1/z.
    pub degraded: IndexSet,
    /// Levels with a direction of which the levels below get a share.
    pub released: IndexSet,
}

impl<T: Real> Spectrum<T> {
    /// No directions yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            count: 0,
            rows: [zeros(); MAX_ROWS],
            directions: [zeros(); MAX_ROWS],
            mobility: [T::ZERO; MAX_ROWS],
            drive: [T::ZERO; MAX_ROWS],
            keep: [T::ZERO; MAX_ROWS],
            vectors: [[T::ZERO; 3]; MAX_ROWS],
            release: T::ZERO,
            degraded: IndexSet::NONE,
            released: IndexSet::NONE,
        }
    }

    /// Level by level.
    #[inline]
    pub(crate) fn update(
        &mut self,
        levels: &Levels<T>,
        rows: &TaskRows<T>,
        cholesky: &Cholesky<T>,
    ) {
        self.count = 0;
        self.release = T::ZERO;
        (self.degraded, self.released) = (IndexSet::NONE, IndexSet::NONE);
        for (number, level) in levels.as_slice().iter().enumerate() {
            self.add(number, level, rows, cholesky);
        }
    }

    #[inline(always)]
    fn add(&mut self, number: usize, level: &Level<T>, rows: &TaskRows<T>, cholesky: &Cholesky<T>) {
        let Level { start, size, .. } = *level;
        let mut left: [JointVector<T>; 3] = [zeros(); 3];
        for k in 0..size {
            if start + k < MAX_ROWS {
                let row = cholesky.solve_lower(&(rows.jacobian[start + k] * level.length));
                self.rows[start + k] = row;
                left[k] = self.left_by(start, &row);
            }
        }
        // Symmetric but for rounding, and where a level above is released.
        let product = |a: usize, b: usize| match self.rows.get(start + b) {
            Some(row) => left[a].dot(row),
            None => T::ZERO,
        };
        let gram = |a: usize, b: usize| match start {
            0 => product(a, b),
            _ => (product(a, b) + product(b, a)) * T::HALF,
        };
        let (mut diagonal, mut off) = ([T::ZERO; 3], [T::ZERO; 3]);
        for k in 0..size {
            diagonal[k] = product(k, k);
        }
        if size > 1 {
            off[2] = gram(0, 1);
        }
        if size > 2 {
            off[1] = gram(0, 2);
            off[0] = gram(1, 2);
        }
        let eigen = Eigen::new(diagonal, off, size);
        let filters = &level.filters;
        for k in 0..size {
            let place = start + k;
            if place < MAX_ROWS {
                let mut direction = left[0] * eigen.vectors[0][k];
                for row in 1..size {
                    direction += left[row] * eigen.vectors[row][k];
                }
                let z = eigen.values[k];
                self.directions[place] = direction;
                self.mobility[place] = z;
                self.drive[place] = filters.drive.of(z);
                self.keep[place] = filters.keep.of(z);
                self.vectors[place] = eigen.vectors[k];
                self.degraded.insert_if(number, z < filters.drive.threshold);
                self.released.insert_if(number, z < filters.keep.threshold);
                let below = (T::ONE - z * filters.keep.inverse).larger(T::ZERO);
                self.release = self.release.larger(below * below);
                self.count = place + 1;
            }
        }
    }

    /// Number of directions: of task rows.
    #[must_use]
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count.min(MAX_ROWS)
    }

    /// x less what the first `count` directions keep of it: 1 - sum of p y y^T, applied.
    #[must_use]
    #[inline(always)]
    pub fn left_by(&self, count: usize, x: &JointVector<T>) -> JointVector<T> {
        let mut left = *x;
        let directions = self.directions.iter().zip(&self.keep);
        for (direction, &keep) in directions.take(count) {
            left -= direction * (keep * direction.dot(x));
        }
        left
    }

    /// x less what all directions keep of it: the null-space part of a whitened vector.
    #[must_use]
    #[inline]
    pub fn null_part(&self, x: &JointVector<T>) -> JointVector<T> {
        self.left_by(self.count(), x)
    }
}

impl<T: Real> Default for Spectrum<T> {
    fn default() -> Self {
        Self::new()
    }
}
