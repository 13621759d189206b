//! Eigenvalues of the small symmetric matrices of one level, by cyclic Jacobi rotations.

use crate::real::Real;

/// Sweeps over the three planes of a 3 x 3 matrix. Each squares what is left off the diagonal:
/// the third leaves up to 1e-5 of a torque, the fourth rounding.
const SWEEPS: usize = 4;

/// S = E diag(z) E^T of up to three rows.
#[derive(Clone, Copy, Debug)]
pub struct Eigen<T: Real> {
    /// The diagonal: after all rotations the eigenvalues z, in no order.
    pub values: [T; 3],
    /// Entry k is the one off the diagonal that row and column k do not have.
    off: [T; 3],
    /// E by rows.
    pub vectors: [[T; 3]; 3],
}

impl<T: Real> Eigen<T> {
    /// A matrix by its diagonal, and by its entries off it, entry k at the place whose row and
    /// column are the other two.
    #[inline(always)]
    pub fn of(&[diagonal, off]: &[[T; 3]; 2]) -> Self {
        let (zero, one) = (T::ZERO, T::ONE);
        Self {
            values: diagonal,
            off,
            vectors: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        }
    }

    /// Makes it diagonal. Rows from `size` on are zero and stay out.
    #[inline(always)]
    pub fn solve(&mut self, size: usize) {
        match size {
            0 | 1 => {}
            2 => self.rotate::<0, 1, 2>(),
            _ => {
                for _ in 0..SWEEPS {
                    self.rotate::<0, 1, 2>();
                    self.rotate::<0, 2, 1>();
                    self.rotate::<1, 2, 0>();
                }
            }
        }
    }

    /// The rotation in the plane (P, Q) that makes the entry between them zero; R is the third.
    #[inline(always)]
    fn rotate<const P: usize, const Q: usize, const R: usize>(&mut self) {
        let Self {
            values,
            off,
            vectors,
        } = self;
        let between = off[R];
        let half = (values[Q] - values[P]) * T::HALF;
        // Keeps 0 / 0 away and changes nothing else.
        let tiny = T::from_f64(1e-30);
        let root = (half * half + between * between).square_root() + tiny;
        let tangent = between / (half + root.with_sign_of(half));
        let cosine = T::ONE / (T::ONE + tangent * tangent).square_root();
        let sine = cosine * tangent;
        values[P] -= tangent * between;
        values[Q] += tangent * between;
        off[R] = T::ZERO;
        let (to_p, to_q) = (off[Q], off[P]);
        off[Q] = cosine * to_p - sine * to_q;
        off[P] = sine * to_p + cosine * to_q;
        for row in vectors {
            let (p, q) = (row[P], row[Q]);
            row[P] = cosine * p - sine * q;
            row[Q] = sine * p + cosine * q;
        }
    }

    /// Column `k` of E: the eigenvector of value `k`.
    #[inline(always)]
    pub fn column(&self, k: usize) -> [T; 3] {
        self.vectors.map(|row| *row.get(k).unwrap_or(&T::ZERO))
    }
}
