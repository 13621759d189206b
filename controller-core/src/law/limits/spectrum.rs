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
use crate::joint::{DOF, JointVector, zeros};
use crate::linalg::Cholesky;
use crate::ranges::MAX_ROWS;
use crate::real::Real;
use crate::task::level::{Level, Levels};
use crate::task::rows::TaskRows;

/// A direction of a level, and the row of the level in the same place.
#[derive(Clone, Copy, Debug)]
pub struct Direction<T: Real> {
    /// The row of A, J L^-T.
    pub row: JointVector<T>,
    /// y: the direction, of what the levels above leave.
    pub along: JointVector<T>,
    /// Its column of E: the direction in the rows of the level.
    pub column: [T; 3],
    /// z \[1/kg\], of an orientation \[1/(kg m2)\].
    pub mobility: T,
    /// d: 1/z, or less where the level is degraded.
    pub drive: T,
    /// p: 1/z, or less where the level is released.
    pub keep: T,
}

impl<T: Real> Direction<T> {
    const NONE: Self = Self {
        row: zeros(),
        along: zeros(),
        column: [T::ZERO; 3],
        mobility: T::ZERO,
        drive: T::ZERO,
        keep: T::ZERO,
    };

    /// The part of numbers per row of the level along the direction.
    #[inline(always)]
    pub fn part(&self, rows: &[T; 3]) -> T {
        let ([a, b, c], [x, y, z]) = (&self.column, rows);
        *a * *x + *b * *y + *c * *z
    }

    /// Adds `part` along the direction to numbers per row of the level.
    #[inline(always)]
    pub fn add_part(&self, part: T, rows: &mut [T; 3]) {
        for (row, &entry) in rows.iter_mut().zip(&self.column) {
            *row += entry * part;
        }
    }
}

/// Directions of all levels, as many per level as it has rows. Behind the last one they have
/// no meaning.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum<T: Real> {
    count: usize,
    directions: [Direction<T>; MAX_ROWS],
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
            directions: [Direction::NONE; MAX_ROWS],
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
        self.count = rows.count();
        self.release = T::ZERO;
        (self.degraded, self.released) = (IndexSet::NONE, IndexSet::NONE);
        let placed = self.directions.iter_mut().zip(&rows.jacobian);
        for (direction, row) in placed.take(self.count) {
            direction.row = cholesky.solve_lower(row);
        }
        for (number, level) in levels.as_slice().iter().enumerate() {
            self.split(number, level);
        }
    }

    /// The directions of a level, those of the levels above it known.
    #[inline(always)]
    fn split(&mut self, number: usize, level: &Level<T>) {
        let Some((above, from)) = self.directions.split_at_mut_checked(level.start) else {
            return;
        };
        let Some(own) = from.get_mut(..level.size) else {
            return;
        };
        let mut left: [JointVector<T>; 3] = [zeros(); 3];
        for (left, direction) in left.iter_mut().zip(&*own) {
            *left = left_by(above, &direction.row);
        }
        let eigen = Eigen::new(&gram(&left, own, number == 0), level.size);
        let filters = &level.filters;
        for (k, direction) in own.iter_mut().enumerate().take(3) {
            let column = eigen.column(k);
            let mut along = left[0] * column[0];
            for (left, &share) in left.iter().zip(&column).take(level.size).skip(1) {
                for i in 0..DOF {
                    along[i] += left[i] * share;
                }
            }
            direction.along = along;
            let z = eigen.values[k];
            direction.column = column;
            direction.mobility = z;
            direction.drive = filters.drive.of(z);
            direction.keep = filters.keep.of(z);
            self.degraded.insert_if(number, z < filters.drive.threshold);
            self.released.insert_if(number, z < filters.keep.threshold);
            let below = (T::ONE - z * filters.keep.inverse).larger(T::ZERO);
            self.release = self.release.larger(below * below);
        }
    }

    /// All directions, level by level.
    #[must_use]
    #[inline(always)]
    pub fn directions(&self) -> &[Direction<T>] {
        self.directions.get(..self.count).unwrap_or(&[])
    }

    /// Those of the levels above a level.
    #[inline(always)]
    pub(super) fn above(&self, level: &Level<T>) -> &[Direction<T>] {
        self.directions.get(..level.start).unwrap_or(&[])
    }

    /// Those of a level: at most three.
    #[inline(always)]
    pub(super) fn of(&self, level: &Level<T>) -> &[Direction<T>] {
        self.directions.get(level.rows()).unwrap_or(&[])
    }

    /// x less what all directions keep of it: the null-space part of a whitened vector.
    #[must_use]
    #[inline]
    pub fn null_part(&self, x: &JointVector<T>) -> JointVector<T> {
        left_by(self.directions(), x)
    }
}

/// x less what directions keep of it: 1 - sum of p y y^T, applied.
#[inline(always)]
pub(super) fn left_by<T: Real>(directions: &[Direction<T>], x: &JointVector<T>) -> JointVector<T> {
    let mut left = *x;
    for direction in directions {
        let kept = direction.keep * direction.along.dot(x);
        for i in 0..DOF {
            left[i] -= direction.along[i] * kept;
        }
    }
    left
}

/// S by its diagonal, and by its entries off it, each at the place of the row that it has not to
/// do with. Symmetric but for rounding, and where a level above is released.
#[inline(always)]
fn gram<T: Real>(left: &[JointVector<T>; 3], own: &[Direction<T>], first: bool) -> [[T; 3]; 2] {
    let product = |a: usize, b: usize| match own.get(b) {
        Some(direction) => left[a].dot(&direction.row),
        None => T::ZERO,
    };
    let mean = |a: usize, b: usize| {
        if first {
            product(a, b)
        } else {
            (product(a, b) + product(b, a)) * T::HALF
        }
    };
    let (mut diagonal, mut off) = ([T::ZERO; 3], [T::ZERO; 3]);
    for k in 0..3 {
        diagonal[k] = product(k, k);
    }
    if own.len() > 1 {
        off[2] = mean(0, 1);
    }
    if own.len() > 2 {
        off[1] = mean(0, 2);
        off[0] = mean(1, 2);
    }
    [diagonal, off]
}

impl<T: Real> Default for Spectrum<T> {
    fn default() -> Self {
        Self::new()
    }
}
