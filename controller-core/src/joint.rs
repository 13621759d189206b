//! Joint-space types: the seven joints, their vectors and matrices, and the
//! state one measurement brings.

use core::hint::black_box;
use core::ops::Range;

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

/// Four numbers that are treated alike: what a vector unit does at once.
pub(crate) type Lanes<T> = SVector<T, 4>;

/// A 3 x 3 matrix.
pub type Matrix3<T> = SMatrix<T, 3, 3>;

/// The first `count` indices, below `N`, in a loop that stays one: the compiler would lay out a
/// copy of it for each, which takes flash and saves little where it runs seldom.
#[inline(always)]
pub(crate) fn in_turn<const N: usize>(count: usize) -> impl Iterator<Item = usize> {
    // What the compiler cannot see is not laid out several times either.
    (0..black_box(count)).map(|i| black_box(i).min(N - 1))
}

/// Whether numbers of all joints are computed one after the other: a vector unit takes four at once,
/// as long as they are as many as the compiler knows.
const ONE_BY_ONE: bool = cfg!(target_arch = "arm");

/// The first `count` joints, in a loop that stays one, or with a vector unit all of them.
#[inline(always)]
pub(crate) fn joints_up_to(count: usize) -> impl Iterator<Item = usize> {
    staying(0..if ONE_BY_ONE { count } else { DOF })
}

/// The joints behind the first `count`, in a loop that stays one.
#[inline(always)]
pub(crate) fn joints_behind(count: usize) -> impl Iterator<Item = usize> {
    staying(0..DOF).skip(count)
}

#[inline(always)]
fn staying(joints: Range<usize>) -> impl Iterator<Item = usize> {
    joints.inspect(|_| {
        if ONE_BY_ONE {
            // What the compiler cannot see through is not laid out several times.
            black_box(());
        }
    })
}

/// A matrix of zeros, usable in constants and statics.
#[must_use]
pub const fn zeros<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::from_array_storage(ArrayStorage([[T::ZERO; R]; C]))
}

/// Length of the loops over sines and cosines of all joints. Vector units do a whole number of
/// fours, so an eighth value is cheaper than seven; without one it would be wasted. The results
/// are the same.
pub(crate) const ALIKE: usize = if cfg!(target_arch = "arm") { DOF } else { 8 };

/// One value per joint where functions of all joints are computed, the rest as of an angle 0.
pub(crate) type Padded<T> = [T; ALIKE];

#[inline(always)]
pub(crate) fn padded<T: Real>(x: &JointVector<T>) -> Padded<T> {
    let mut values = [T::ZERO; ALIKE];
    for i in 0..DOF {
        values[i] = x[i];
    }
    values
}

/// Whether every value is finite: x - x is 0 where x is, else NaN, which no sum loses.
#[inline(always)]
#[allow(clippy::eq_op)]
pub(crate) fn all_finite<T: Real, const N: usize>(values: &SVector<T, N>) -> bool {
    let mut sum = T::ZERO;
    for i in 0..N {
        sum += values[i] - values[i];
    }
    sum == T::ZERO
}

/// Posture and speed of the arm at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<T: Real> {
    /// q, joint angles \[rad\].
    pub q: JointVector<T>,
    /// dq, joint speeds \[rad/s\].
    pub dq: JointVector<T>,
}
