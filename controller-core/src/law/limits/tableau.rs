//! A symmetric 7 x 7 matrix on which single variables are swept in and out.

use crate::joint::{DOF, JointVector};
use crate::linalg::{Cholesky, for_each_joint};
use crate::real::Real;

/// Length of arrays over the joints that are read at an index from data: a power of two, so that
/// no index can be outside.
pub const WIDTH: usize = 8;

/// The matrix by rows. Both halves are kept: rows lie in one piece in memory, and are swept as
/// wholes.
#[derive(Clone, Copy, Debug)]
pub struct Tableau<T: Real> {
    rows: [[T; WIDTH]; WIDTH],
}

impl<T: Real> Tableau<T> {
    /// Zeros.
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            rows: [[T::ZERO; WIDTH]; WIDTH],
        }
    }

    /// The lower half becomes that of M^-1. Behind a call: what it needs besides is gone then.
    #[inline(never)]
    pub fn set_inverse(&mut self, cholesky: &Cholesky<T>) {
        let factor = cholesky.inverse_factor();
        for_each_joint!(i, {
            for j in 0..=i {
                let mut sum = factor[(i, i)] * factor[(i, j)];
                for k in i + 1..DOF {
                    sum += factor[(k, i)] * factor[(k, j)];
                }
                self.rows[i][j] = sum;
            }
        });
    }

    /// The lower half less `held` x x^T, x = L^-T y. Behind a call: in a loop around it its
    /// numbers would not fit into registers.
    #[inline(never)]
    pub fn stiffen(&mut self, cholesky: &Cholesky<T>, y: &JointVector<T>, held: T) {
        let x = cholesky.solve_upper(y);
        for i in 0..DOF {
            let scaled = x[i] * held;
            for j in 0..=i {
                self.rows[i][j] -= scaled * x[j];
            }
        }
    }

    /// Completes the upper half.
    #[inline(always)]
    pub fn mirror(&mut self) {
        for i in 0..DOF {
            for j in 0..i {
                self.rows[j][i] = self.rows[i][j];
            }
        }
    }

    /// Entry (i, i).
    #[inline(always)]
    pub fn diagonal(&self, i: usize) -> T {
        self.rows[i % WIDTH][i % WIDTH]
    }

    /// Row `k`.
    #[inline(always)]
    pub fn row(&self, k: usize) -> &[T; WIDTH] {
        &self.rows[k % WIDTH]
    }

    /// Sweeps variable `k` in (`sign` 1) or out (-1): what is left is the matrix of the others
    /// with it held, its own row what its multiplier does to them. Behind a call: it is in the
    /// flash once.
    #[inline(never)]
    pub fn sweep(&mut self, k: usize, sign: T) {
        let k = k % WIDTH;
        let (row, inverse) = (self.rows[k], T::ONE / self.rows[k][k]);
        for i in 0..DOF {
            let scaled = row[i] * inverse;
            for j in 0..=i {
                let entry = self.rows[i][j] - scaled * row[j];
                self.set(i, j, entry);
            }
        }
        let signed = inverse * sign;
        for j in 0..DOF {
            self.set(k, j, row[j] * signed);
        }
        self.rows[k][k] = -inverse;
    }

    /// Entries (i, j) and (j, i).
    #[inline(always)]
    fn set(&mut self, i: usize, j: usize, entry: T) {
        self.rows[i][j] = entry;
        self.rows[j][i] = entry;
    }
}
