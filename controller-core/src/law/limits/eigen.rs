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
    /// Of a matrix with this `diagonal`, and with entry k of `off` at the place whose row and
    /// column are the other two. Rows from `size` on are zero and stay out.
    #[inline(always)]
    pub fn new(diagonal: [T; 3], off: [T; 3], size: usize) -> Self {
        let (zero, one) = (T::ZERO, T::ONE);
        let mut eigen = Self {
            values: diagonal,
            off,
            vectors: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        };
        match size {
            0 | 1 => {}
            2 => eigen.rotate::<0, 1, 2>(),
            _ => {
                for _ in 0..SWEEPS {
                    eigen.rotate::<0, 1, 2>();
                    eigen.rotate::<0, 2, 1>();
                    eigen.rotate::<1, 2, 0>();
                }
            }
        }
        eigen
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
        let tiny = T::from_f64(1e-30).with_sign_of(half);
        let root = (half * half + between * between)
            .square_root()
            .with_sign_of(half);
        let tangent = between / (half + root + tiny);
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

    /// E x.
    #[inline(always)]
    pub fn times(vectors: &[[T; 3]; 3], x: &[T; 3]) -> [T; 3] {
        vectors.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
    }

    /// E^T x.
    #[inline(always)]
    pub fn transposed_times(vectors: &[[T; 3]; 3], x: &[T; 3]) -> [T; 3] {
        let [first, second, third] = vectors;
        core::array::from_fn(|k| first[k] * x[0] + second[k] * x[1] + third[k] * x[2])
    }
}
