//! The paper's matrices of the hierarchy, for inspection and tests. Not in the cycle.

use core::cmp::Ordering;

use heapless::Vec;

use super::hierarchy::Hierarchy;
use crate::joint::{DOF, JointMatrix, JointVector, zeros};
use crate::linalg::Cholesky;
use crate::ranges::EXACT_ROWS;
use crate::real::Real;

/// One joint-space row (or column) per task row of a level.
pub type LevelRows<T> = Vec<JointVector<T>, EXACT_ROWS>;

impl<T: Real> Hierarchy<T> {
    /// R_kj, zero for j > k.
    fn r(&self, k: usize, j: usize) -> T {
        match j.cmp(&k) {
            Ordering::Less => self.factors[k][j],
            Ordering::Equal => self.pivot[k],
            Ordering::Greater => T::ZERO,
        }
    }

    /// Row k of Q.
    fn q_row(&self, k: usize) -> JointVector<T> {
        let mut unit: JointVector<T> = zeros();
        unit[k] = T::ONE;
        self.rotate_back(&unit)
    }

    /// Number of levels.
    #[must_use]
    pub fn levels(&self) -> usize {
        (0..self.count)
            .filter(|&k| self.level_start[k] == k)
            .count()
    }

    /// Rows `start..end` of level `level`, counted from 0; empty beyond the last.
    #[must_use]
    pub fn level_range(&self, level: usize) -> core::ops::Range<usize> {
        let mut starts = (0..self.count)
            .filter(|&k| self.level_start[k] == k)
            .skip(level);
        let start = starts.next().unwrap_or(self.count);
        start..starts.next().unwrap_or(self.count)
    }

    /// Jbar_i, m_i rows: dx of level i in the motion that levels above allow.
    #[must_use]
    pub fn jbar(&self, level: usize, cholesky: &Cholesky<T>) -> LevelRows<T> {
        let range = self.level_range(level);
        let row = |k: usize| {
            range.clone().fold(zeros(), |sum: JointVector<T>, j| {
                sum + cholesky.lower_times(&self.q_row(j)) * self.r(k, j)
            })
        };
        range.clone().map(row).collect()
    }

    /// Columns of Jbar_i^#, the dynamically consistent inverse, m_i of them.
    #[must_use]
    pub fn jbar_pinv(&self, level: usize, cholesky: &Cholesky<T>) -> LevelRows<T> {
        let range = self.level_range(level);
        let column = |k: usize| {
            let mut unit = [T::ZERO; EXACT_ROWS];
            unit[k] = T::ONE;
            // R^-1 of a unit vector, cut to the level: the column of R_ii^-1.
            let solved = self.solve(&unit);
            let whitened = range.clone().fold(zeros(), |sum: JointVector<T>, j| {
                sum + self.q_row(j) * solved[j]
            });
            cholesky.solve_upper(&whitened)
        };
        range.clone().map(column).collect()
    }

    /// Lambda_i = (Jbar_i M^-1 Jbar_i^T)^-1 \[kg\], the inertia of level i: entry
    /// (j, k) at `[j][k]`, m_i x m_i, zeros behind.
    #[must_use]
    pub fn task_inertia(&self, level: usize) -> JointMatrix<T> {
        let range = self.level_range(level);
        let inverse = |k: usize| {
            let mut unit = [T::ZERO; EXACT_ROWS];
            unit[k] = T::ONE;
            let mut column = self.solve(&unit);
            for (j, value) in column.iter_mut().enumerate() {
                if j >= range.end {
                    *value = T::ZERO;
                }
            }
            column
        };
        let mut lambda = zeros();
        for j in range.clone() {
            for k in range.clone() {
                lambda[(j - range.start, k - range.start)] = inverse(j).dot(&inverse(k));
            }
        }
        lambda
    }

    /// Z, 7 - m rows: one basis of the null space with Z M Z^T = 1.
    #[must_use]
    pub fn null_basis(&self, cholesky: &Cholesky<T>) -> LevelRows<T> {
        (self.count..DOF)
            .map(|k| cholesky.solve_upper(&self.q_row(k)))
            .collect()
    }

    /// v = Z M dq, the 7 - m null-space velocities that belong to
    /// [`Hierarchy::null_basis`].
    #[must_use]
    pub fn null_velocity(&self, cholesky: &Cholesky<T>, dq: &JointVector<T>) -> Vec<T, DOF> {
        self.rotate(&cholesky.upper_times(dq))
            .iter()
            .skip(self.count)
            .copied()
            .collect()
    }

    /// N = L^-T Q_n^T Q_n L^T, the null-space projector of velocities.
    #[must_use]
    pub fn null_projector(&self, cholesky: &Cholesky<T>) -> JointMatrix<T> {
        let mut projector: JointMatrix<T> = zeros();
        for j in 0..DOF {
            let mut unit: JointVector<T> = zeros();
            unit[j] = T::ONE;
            let inside = self.null_part(&self.rotate(&cholesky.upper_times(&unit)));
            projector.set_column(j, &cholesky.solve_upper(&self.rotate_back(&inside)));
        }
        projector
    }
}
