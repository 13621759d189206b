//! A symmetric 7 x 7 matrix on which single variables are swept in and out.

use crate::joint::{DOF, JointMatrix, JointVector};
use crate::real::Real;

/// Length of arrays over the joints that are read at an index from data: a power of two, so that
/// no index can be outside.
pub const WIDTH: usize = 8;

/// Entries on and below the diagonal, and up to a power of two.
const ENTRIES: usize = 32;

/// Where entry (i, j) is kept, whichever of i and j is larger.
const PLACE: [[u8; WIDTH]; WIDTH] = {
    let mut place = [[0; WIDTH]; WIDTH];
    let mut n = 0;
    while n < WIDTH * WIDTH {
        let (i, j) = (n / WIDTH, n % WIDTH);
        let (low, high) = if i < j { (i, j) } else { (j, i) };
        place[i][j] = ((high * (high + 1) / 2 + low) % ENTRIES) as u8;
        n += 1;
    }
    place
};

/// The matrix, by the rows of its lower triangle.
#[derive(Clone, Copy, Debug)]
pub struct Tableau<T: Real> {
    entries: [T; ENTRIES],
}

impl<T: Real> Tableau<T> {
    /// W^T W of a lower triangular W.
    #[inline(always)]
    pub fn inverse(factor: &JointMatrix<T>) -> Self {
        let mut entries = [T::ZERO; ENTRIES];
        for i in 0..DOF {
            for j in 0..=i {
                let mut sum = T::ZERO;
                for k in i..DOF {
                    sum += factor[(k, i)] * factor[(k, j)];
                }
                entries[i * (i + 1) / 2 + j] = sum;
            }
        }
        Self { entries }
    }

    /// Less `held` x x^T.
    #[inline(always)]
    pub fn stiffen(&mut self, x: &JointVector<T>, held: T) {
        for i in 0..DOF {
            let scaled = x[i] * held;
            for j in 0..=i {
                self.entries[i * (i + 1) / 2 + j] -= scaled * x[j];
            }
        }
    }

    /// Entry (i, i).
    #[inline(always)]
    pub fn diagonal(&self, i: usize) -> T {
        self.entries[(i * (i + 3) / 2) % ENTRIES]
    }

    /// Row `k`. Behind a call: it is in the flash once.
    #[inline(never)]
    pub fn row(&self, k: usize) -> [T; WIDTH] {
        let places = &PLACE[k % WIDTH];
        let mut row = [T::ZERO; WIDTH];
        for j in 0..DOF {
            row[j] = self.entries[usize::from(places[j]) % ENTRIES];
        }
        row
    }

    /// Sweeps variable `k`, whose row this is, in (`sign` 1) or out (-1): what is left is the
    /// matrix of the others with it held, its own row what its multiplier does to them. Behind a
    /// call: it is in the flash once.
    #[inline(never)]
    pub fn sweep(&mut self, k: usize, row: &[T; WIDTH], sign: T) {
        let inverse = T::ONE / row[k % WIDTH];
        for i in 0..DOF {
            let scaled = row[i] * inverse;
            for j in 0..=i {
                self.entries[i * (i + 1) / 2 + j] -= scaled * row[j];
            }
        }
        let (places, signed) = (&PLACE[k % WIDTH], inverse * sign);
        for j in 0..DOF {
            self.entries[usize::from(places[j]) % ENTRIES] = row[j] * signed;
        }
        self.entries[usize::from(places[k % WIDTH]) % ENTRIES] = -inverse;
    }
}
