//! Joint-space types: the seven joints, their vectors and matrices, and the
//! state one measurement brings.

use nalgebra::{ArrayStorage, SMatrix, SVector};

use crate::real::Real;

/// Number of joints. Joint 1 is at the base; arrays hold joint i at index i - 1.
pub const DOF: usize = 7;

/// One value per joint, base to flange.
pub type JointVector<T> = SVector<T, DOF>;

/// A 7 x 7 joint-space matrix.
pub type JointMatrix<T> = SMatrix<T, DOF, DOF>;

/// A vector in Cartesian space, base-plate axes unless said otherwise.
pub type Vector3<T> = SVector<T, 3>;

/// A 3 x 3 matrix.
pub type Matrix3<T> = SMatrix<T, 3, 3>;

/// A matrix of zeros, usable in constants and statics.
#[must_use]
pub const fn zeros<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::from_array_storage(ArrayStorage([[T::ZERO; R]; C]))
}

/// A diagonal joint-space matrix: the usual form of stiffness and damping.
#[must_use]
pub fn diagonal<T: Real>(values: [f64; DOF]) -> JointMatrix<T> {
    let mut matrix = zeros();
    for (i, value) in values.into_iter().enumerate() {
        matrix[(i, i)] = T::from_f64(value);
    }
    matrix
}

/// Posture and speed of the arm at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<T: Real> {
    /// q, joint angles \[rad\].
    pub q: JointVector<T>,
    /// dq, joint speeds \[rad/s\].
    pub dq: JointVector<T>,
}
