//! Three-vector algebra that the rigid-body sums are written in.

use crate::joint::{Matrix3, Vector3};
use crate::real::Real;

/// [a x] B: the cross product of `a` with every column of `b`.
#[inline(always)]
pub(crate) fn cross_columns<T: Real>(a: &Vector3<T>, b: &Matrix3<T>) -> Matrix3<T> {
    Matrix3::from_columns(&[
        a.cross(&b.column(0)),
        a.cross(&b.column(1)),
        a.cross(&b.column(2)),
    ])
}

/// Mass, momentum and their moments of a group of links, about one point and
/// in base-plate axes. With p the position of a mass element relative to that
/// point and dp its absolute velocity, everything that dynamics needs is
///
/// | field | integral over the mass | unit |
/// |---|---|---|
/// | `mass` | dm | kg |
/// | `first` h | p dm | kg m |
/// | `second` S | p p^T dm | kg m2 |
/// | `momentum` l | dp dm | kg m/s |
/// | `rate` D | dp p^T dm | kg m2/s |
///
/// All five add over links; moving the point by -d (p -> p + d) is
/// [`Moments::shift`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments<T: Real> {
    pub mass: T,
    pub first: Vector3<T>,
    pub second: Matrix3<T>,
    pub momentum: Vector3<T>,
    pub rate: Matrix3<T>,
}

impl<T: Real> Moments<T> {
    pub fn zero() -> Self {
        Self {
            mass: T::ZERO,
            first: Vector3::from([T::ZERO; 3]),
            second: crate::joint::zeros(),
            momentum: Vector3::from([T::ZERO; 3]),
            rate: crate::joint::zeros(),
        }
    }

    /// Adds one rigid body: `first`, `second` about the point, `velocity` of the
    /// body at the point \[m/s\], `spin` its angular velocity \[rad/s\].
    #[inline(always)]
    pub fn add_body(
        &mut self,
        mass: T,
        first: &Vector3<T>,
        second: &Matrix3<T>,
        velocity: &Vector3<T>,
        spin: &Vector3<T>,
    ) {
        self.mass += mass;
        self.first += first;
        self.second += second;
        self.momentum += velocity * mass + spin.cross(first);
        self.rate += velocity * first.transpose() + cross_columns(spin, second);
    }

    /// Refers the moments to a point that lies `-d` away: every p becomes p + d.
    #[inline(always)]
    pub fn shift(&mut self, d: &Vector3<T>) {
        let hd = self.first * d.transpose();
        self.second += hd + hd.transpose() + (d * self.mass) * d.transpose();
        self.rate += self.momentum * d.transpose();
        self.first += d * self.mass;
    }

    /// Angular momentum about the point for a rotation about it: (tr S 1 - S) a.
    #[inline(always)]
    pub fn inertia_times(&self, a: &Vector3<T>) -> Vector3<T> {
        a * self.second.trace() - self.second * a
    }
}
