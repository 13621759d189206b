//! Small dense linear algebra with fixed trip counts: the Cholesky factor of
//! the mass matrix and its triangular solves, and the largest eigenvalue of a
//! symmetric matrix (construction only).

use crate::joint::{DOF, JointMatrix, JointVector, in_turn, zeros};
use crate::real::Real;

/// A step of numbers towards others, of the way to which a share is `left`. Behind a call: it is in
/// the flash once.
#[inline(never)]
pub(crate) fn approach<T: Real>(numbers: &mut [T], others: &[T], left: T) {
    for (number, &other) in numbers.iter_mut().zip(others) {
        *number = other + (*number - other) * left;
    }
}

/// Repeats a block with the index as a constant: triangular loops inside it get
/// fixed lengths, which the compiler then lays out without counters.
macro_rules! for_each_joint {
    ($index:ident, $body:block) => {
        for_each_joint!(@ $index, [0 1 2 3 4 5 6], $body)
    };
    (rev $index:ident, $body:block) => {
        for_each_joint!(@ $index, [6 5 4 3 2 1 0], $body)
    };
    (@ $index:ident, [$($value:literal)*], $body:block) => {
        $(#[allow(clippy::reversed_empty_ranges)] {
            #[allow(non_upper_case_globals)]
            const $index: usize = $value;
            $body
        })*
    };
}
pub(crate) use for_each_joint;

/// A = L L^T with L lower triangular; A symmetric, positive definite, 7 x 7.
#[derive(Clone, Copy, Debug)]
pub struct Cholesky<T: Real> {
    l: JointMatrix<T>,
    inverse_diagonal: JointVector<T>,
}

impl<T: Real> Cholesky<T> {
    /// No factor yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            l: zeros(),
            inverse_diagonal: zeros(),
        }
    }

    /// Factors `a`; only its lower triangle is read.
    ///
    /// Never fails: a pivot below 1e-30 counts as 1e-30, so the factor of a
    /// matrix that is not positive definite is finite but meaningless. The mass
    /// matrix of a validated arm is always positive definite.
    #[inline(never)]
    pub fn update(&mut self, a: &JointMatrix<T>) {
        let Self {
            l,
            inverse_diagonal,
        } = self;
        let floor = T::from_f64(1e-30);
        for_each_joint!(j, {
            let mut column: JointVector<T> = zeros();
            for i in j..DOF {
                column[i] = a[(i, j)];
            }
            for k in 0..j {
                let factor = l[(j, k)];
                for i in j..DOF {
                    column[i] -= l[(i, k)] * factor;
                }
            }
            let root = column[j].most(floor).square_root();
            let inverse = T::ONE / root;
            inverse_diagonal[j] = inverse;
            l[(j, j)] = root;
            for i in j + 1..DOF {
                l[(i, j)] = column[i] * inverse;
            }
        });
    }

    /// The factor of the identity: whitening with it changes nothing.
    #[must_use]
    pub fn identity() -> Self {
        Self {
            l: JointMatrix::identity(),
            inverse_diagonal: JointVector::from([T::ONE; DOF]),
        }
    }

    /// L, lower triangular, zeros above.
    #[must_use]
    pub fn factor(&self) -> &JointMatrix<T> {
        &self.l
    }

    /// L^-1 b.
    #[must_use]
    #[inline]
    pub fn solve_lower(&self, b: &JointVector<T>) -> JointVector<T> {
        let mut x = *b;
        for_each_joint!(j, {
            let value = x[j] * self.inverse_diagonal[j];
            x[j] = value;
            for i in j + 1..DOF {
                x[i] -= self.l[(i, j)] * value;
            }
        });
        x
    }

    /// L^-T b.
    #[must_use]
    #[inline]
    pub fn solve_upper(&self, b: &JointVector<T>) -> JointVector<T> {
        let mut x = *b;
        for_each_joint!(rev i, {
            let mut value = x[i];
            for j in i + 1..DOF {
                value -= self.l[(j, i)] * x[j];
            }
            x[i] = value * self.inverse_diagonal[i];
        });
        x
    }

    /// L^-1, lower triangular.
    #[must_use]
    #[inline]
    pub fn inverse_factor(&self) -> JointMatrix<T> {
        let mut inverse: JointMatrix<T> = zeros();
        for_each_joint!(j, {
            inverse[(j, j)] = self.inverse_diagonal[j];
            for i in j + 1..DOF {
                let mut sum = T::ZERO;
                for k in j..i {
                    sum += self.l[(i, k)] * inverse[(k, j)];
                }
                inverse[(i, j)] = -(sum * self.inverse_diagonal[i]);
            }
        });
        inverse
    }

    /// L x.
    #[must_use]
    #[inline]
    pub fn lower_times(&self, x: &JointVector<T>) -> JointVector<T> {
        let mut y: JointVector<T> = zeros();
        for i in 0..DOF {
            y[i] = self.l[(i, 0)] * x[0];
        }
        for_each_joint!(@ j, [1 2 3 4 5 6], {
            for i in j..DOF {
                y[i] += self.l[(i, j)] * x[j];
            }
        });
        y
    }

    /// L^T x. Behind a call: it is in the flash once.
    #[must_use]
    #[inline(never)]
    pub fn upper_times(&self, x: &JointVector<T>) -> JointVector<T> {
        let mut y: JointVector<T> = zeros();
        for_each_joint!(i, {
            for j in i..DOF {
                y[i] += self.l[(j, i)] * x[j];
            }
        });
        y
    }

    /// L^-1 B L^-T, for a symmetric B. For construction: small, not fast.
    #[must_use]
    pub fn whiten(&self, b: &JointMatrix<T>) -> JointMatrix<T> {
        let (mut whole, mut turned) = (*b, *b);
        // (L^-1 B)^T = B L^-T, and once more the same.
        for _ in 0..2 {
            for j in in_turn::<DOF>(DOF) {
                for i in in_turn::<DOF>(DOF) {
                    let mut value = whole[(i, j)];
                    for k in 0..i {
                        value -= self.l[(i, k)] * turned[(j, k)];
                    }
                    turned[(j, i)] = value * self.inverse_diagonal[i];
                }
            }
            whole = turned;
        }
        whole
    }
}

impl<T: Real> Default for Cholesky<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Largest eigenvalue of a symmetric matrix, which becomes diagonal, and its eigenvector, by
/// cyclic Jacobi rotations, until nothing changes any more: for 7 x 7 some six sweeps, at most
/// twelve. For construction, not for the cycle.
#[must_use]
pub fn largest_eigenpair<T: Real>(a: &mut JointMatrix<T>) -> (T, JointVector<T>) {
    const SWEEPS: usize = 12;
    let mut vectors = JointMatrix::<T>::identity();
    for _ in 0..SWEEPS {
        let mut changes = false;
        for p in in_turn::<DOF>(DOF) {
            for q in p + 1..DOF {
                changes |= rotate(a, &mut vectors, p, q);
            }
        }
        if !changes {
            break;
        }
    }
    let (mut largest, mut best) = (a[(0, 0)], 0);
    for i in in_turn::<DOF>(DOF) {
        if a[(i, i)] > largest {
            (largest, best) = (a[(i, i)], i);
        }
    }
    (largest, vectors.column(best.min(DOF - 1)).into_owned())
}

/// The rotation in the plane (p, q) that makes a\[p, q\] zero; false where it would change nothing.
fn rotate<T: Real>(
    a: &mut JointMatrix<T>,
    vectors: &mut JointMatrix<T>,
    p: usize,
    q: usize,
) -> bool {
    let off = a[(p, q)];
    // Lost in the rounding of the diagonal: so is what the rotation would change.
    let scale = a[(p, p)].magnitude() + a[(q, q)].magnitude();
    if scale + off.magnitude() == scale {
        return false;
    }
    let theta = (a[(q, q)] - a[(p, p)]) / (off + off);
    let t =
        T::ONE.with_sign_of(theta) / (theta.magnitude() + (theta * theta + T::ONE).square_root());
    let c = T::ONE / (t * t + T::ONE).square_root();
    let s = t * c;
    for k in in_turn::<DOF>(DOF) {
        let (x, y) = (a[(k, p)], a[(k, q)]);
        a[(k, p)] = x * c - y * s;
        a[(k, q)] = x * s + y * c;
    }
    for k in in_turn::<DOF>(DOF) {
        let (x, y) = (a[(p, k)], a[(q, k)]);
        a[(p, k)] = x * c - y * s;
        a[(q, k)] = x * s + y * c;
    }
    for k in in_turn::<DOF>(DOF) {
        let (x, y) = (vectors[(k, p)], vectors[(k, q)]);
        vectors[(k, p)] = x * c - y * s;
        vectors[(k, q)] = x * s + y * c;
    }
    true
}
