//! The task hierarchy from one factorisation.
//!
//! The stacked task rows J = \[J_1; J_2; ..\] are whitened by the mass matrix
//! M = L L^T and factored once, rows in priority order and without pivoting:
//!
//! ```text
//! A = J L^-T = R Q_t,    R lower triangular,    Q = [Q_t; Q_n] orthogonal
//! ```
//!
//! Row k of Q_t is the part of task row k that no row above it can reach. So
//! the projected Jacobians (17)-(21) of level i, with R_ii and Q_i its diagonal
//! block and rows, are
//!
//! ```text
//! Jbar_i = R_ii Q_i L^T      Jbar_i^# = L^-T Q_i^T R_ii^-1      Lambda_i = (R_ii R_ii^T)^-1
//! Z      = Q_n L^-1          Z M Z^T  = 1                       v = Q_n L^T dq
//! ```
//!
//! and (22)-(25) hold by orthogonality. What a moving level does to the levels
//! below it sits in the off-diagonal blocks of R; forward substitution takes
//! care of it. The factorisation uses Householder reflections, whose Q is
//! orthogonal to rounding however close to singular the tasks are.

use crate::cells::Cells;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, zeros};
use crate::linalg::{Cholesky, for_each_joint};
use crate::ranges::EXACT_ROWS;
use crate::real::Real;
use crate::task::rows::TaskRows;

/// A row whose R_kk^2 is below this \[1/kg\] is not resolvable given the rows
/// above it: it gets no acceleration.
pub const RANK_THRESHOLD: f64 = 1e-8;

/// R and Q of the whitened task rows.
#[derive(Clone, Copy, Debug)]
pub struct Hierarchy<T: Real> {
    pub(super) count: usize,
    pub(super) level_start: [usize; EXACT_ROWS],
    /// Row k holds R_k0 .. R_k(k-1), and from entry k on the reflector v_k:
    /// Q = H_m .. H_1 with H_k = 1 - scale_k v_k v_k^T. Behind the last row the arrays
    /// have no meaning.
    pub(super) factors: [JointVector<T>; EXACT_ROWS],
    scale: [T; EXACT_ROWS],
    /// R_kk.
    pub(super) pivot: [T; EXACT_ROWS],
    /// 1 / R_kk, 0 where the row is rank deficient.
    inverse_pivot: [T; EXACT_ROWS],
    deficient: IndexSet,
}

impl<T: Real> Hierarchy<T> {
    /// Nothing factored yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            count: 0,
            level_start: [0; EXACT_ROWS],
            factors: [zeros(); EXACT_ROWS],
            scale: [T::ZERO; EXACT_ROWS],
            pivot: [T::ZERO; EXACT_ROWS],
            inverse_pivot: [T::ZERO; EXACT_ROWS],
            deficient: IndexSet::NONE,
        }
    }

    /// Factors J L^-T. With [`Cholesky::identity`] it factors J itself, which
    /// gives the unweighted (Moore-Penrose) hierarchy.
    #[inline]
    pub fn update(&mut self, rows: &TaskRows<T>, cholesky: &Cholesky<T>) {
        let count = rows.count().min(EXACT_ROWS);
        self.count = count;
        for (start, of_row) in self.level_start.iter_mut().zip(&rows.level_start) {
            *start = *of_row;
        }
        self.deficient = IndexSet::NONE;
        for (factor, row) in self.factors.iter_mut().zip(&rows.jacobian).take(count) {
            *factor = cholesky.solve_lower(row);
        }
        for_each_joint!(k, {
            if k < count {
                self.eliminate::<k>();
                for row in k + 1..count {
                    let mut below = self.factors[row];
                    self.reflect::<k>(&mut below);
                    self.factors[row] = below;
                }
            }
        });
    }

    /// The reflection that leaves row `K` zero behind entry `K`.
    #[inline(always)]
    fn eliminate<const K: usize>(&mut self) {
        let row = self.factors[K];
        let mut norm_squared = T::ZERO;
        for i in K..DOF {
            norm_squared += row[i] * row[i];
        }
        let norm = norm_squared.square_root();
        let pivot = -norm.with_sign_of(row[K]);
        let (one, zero) = (T::ONE, T::ZERO);
        let threshold = T::from_f64(RANK_THRESHOLD);
        let resolvable = norm_squared.choose_below(threshold, zero, one);
        // Below this a row is zero in either precision: no reflection.
        let turns = T::from_f64(1e-30).choose_below(norm_squared, one, zero);

        let head = row[K] - pivot;
        self.factors[K][K] = head;
        self.pivot[K] = pivot;
        // Divisors are made harmless by a sum: a choice of them may become a branch.
        let scale = norm * (norm + (pivot + head).magnitude());
        self.scale[K] = turns / (scale + (one - turns));
        self.inverse_pivot[K] = resolvable / (pivot + (one - resolvable));
        self.deficient.insert_if(K, norm_squared < threshold);
    }

    /// Applies H_K, which leaves entries before `K` as they are.
    #[inline(always)]
    fn reflect<const K: usize>(&self, x: &mut JointVector<T>) {
        let reflector = &self.factors[K];
        let mut projection = reflector[K] * x[K];
        for i in K + 1..DOF {
            projection += reflector[i] * x[i];
        }
        projection *= self.scale[K];
        for i in K..DOF {
            x[i] -= reflector[i] * projection;
        }
    }

    /// Number of task rows m.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// What it tells.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.set("rank", &mut self.deficient.0);
    }

    /// Rows that are not resolvable given the rows above them.
    #[must_use]
    pub fn deficient(&self) -> IndexSet {
        self.deficient
    }

    /// |R_kk| per row \[1/sqrt(kg)\]: how far the row is from being
    /// unresolvable given the rows above it. 0 behind the last row.
    #[must_use]
    pub fn conditioning(&self) -> [T; EXACT_ROWS] {
        let mut diagonal = [T::ZERO; EXACT_ROWS];
        for k in 0..EXACT_ROWS {
            if k < self.count {
                diagonal[k] = self.pivot[k].magnitude();
            }
        }
        diagonal
    }

    /// Q x: entries 0..m are Q_t x, the rest Q_n x.
    #[must_use]
    #[inline]
    pub fn rotate(&self, x: &JointVector<T>) -> JointVector<T> {
        let mut x = *x;
        for_each_joint!(k, {
            if k < self.count {
                self.reflect::<k>(&mut x);
            }
        });
        x
    }

    /// Q^T x = Q_t^T x\[0..m\] + Q_n^T x\[m..\].
    #[must_use]
    #[inline]
    pub fn rotate_back(&self, x: &JointVector<T>) -> JointVector<T> {
        let mut x = *x;
        for_each_joint!(rev k, {
            if k < self.count {
                self.reflect::<k>(&mut x);
            }
        });
        x
    }

    /// `x` with only its task entries 0..m kept.
    #[must_use]
    #[inline]
    pub fn task_part(&self, x: &JointVector<T>) -> JointVector<T> {
        self.joined(x, &zeros())
    }

    /// `x` with only its null-space entries m.. kept.
    #[must_use]
    #[inline]
    pub fn null_part(&self, x: &JointVector<T>) -> JointVector<T> {
        self.joined(&zeros(), x)
    }

    /// Entries 0..m of `task`, m.. of `null`.
    #[must_use]
    #[inline(always)]
    pub fn joined(&self, task: &JointVector<T>, null: &JointVector<T>) -> JointVector<T> {
        let mut joined = *null;
        for k in 0..DOF {
            if k < self.count {
                joined[k] = task[k];
            }
        }
        joined
    }

    /// y = R^-1 b, the coupled solution: what levels above do to a row is taken
    /// off before the row acts. 0 in rank-deficient rows and behind row m.
    #[must_use]
    #[inline]
    pub fn solve(&self, b: &[T; EXACT_ROWS]) -> JointVector<T> {
        let mut y: JointVector<T> = zeros();
        for_each_joint!(k, {
            if k < self.count {
                let mut rest = b[k];
                for j in 0..k {
                    rest -= self.factors[k][j] * y[j];
                }
                y[k] = rest * self.inverse_pivot[k];
            }
        });
        y
    }

    /// R_ii^-1 b_i per level i: as [`Hierarchy::solve`] but blind to the coupling
    /// between levels, as (26), (34) and (51) are printed.
    #[must_use]
    #[inline]
    pub fn solve_uncoupled(&self, b: &[T; EXACT_ROWS]) -> JointVector<T> {
        let mut y: JointVector<T> = zeros();
        for k in 0..EXACT_ROWS {
            if k < self.count {
                let mut known = T::ZERO;
                for j in 0..k {
                    if j >= self.level_start[k] {
                        known += self.factors[k][j] * y[j];
                    }
                }
                y[k] = (b[k] - known) * self.inverse_pivot[k];
            }
        }
        y
    }

    /// R^-T s for the task entries of `s`. 0 in rank-deficient rows.
    #[must_use]
    #[inline]
    pub fn solve_transposed(&self, s: &JointVector<T>) -> [T; EXACT_ROWS] {
        let mut rest = *s;
        let mut x = [T::ZERO; EXACT_ROWS];
        for_each_joint!(rev k, {
            if k < self.count {
                let value = rest[k] * self.inverse_pivot[k];
                x[k] = value;
                for j in 0..k {
                    rest[j] -= self.factors[k][j] * value;
                }
            }
        });
        x
    }
}

impl<T: Real> Default for Hierarchy<T> {
    fn default() -> Self {
        Self::new()
    }
}
