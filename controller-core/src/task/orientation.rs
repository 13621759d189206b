//! Orientations as unit quaternions, and the chord between two of them along the
//! shortest path.

use crate::joint::{Matrix3, Vector3};
use crate::real::Real;

/// A quaternion (w, x, y, z). A unit quaternion q and -q are the same orientation.
pub type Quaternion<T> = nalgebra::SVector<T, 4>;

/// No rotation.
#[must_use]
pub const fn identity<T: Real>() -> Quaternion<T> {
    Quaternion::from_array_storage(nalgebra::ArrayStorage([[
        T::ONE,
        T::ZERO,
        T::ZERO,
        T::ZERO,
    ]]))
}

/// Rotation by `angle` \[rad\], |angle| <= 4 pi, about a unit `axis`.
#[must_use]
pub fn about_axis<T: Real>(axis: &Vector3<T>, angle: T) -> Quaternion<T> {
    let (sin, cos) = (angle * T::HALF).sine_cosine();
    Quaternion::from([cos, axis.x * sin, axis.y * sin, axis.z * sin])
}

/// `orientation` turned by a rotation vector \[rad\], at most a full turn of it.
#[must_use]
pub fn turned<T: Real>(orientation: &Quaternion<T>, by: &Vector3<T>) -> Quaternion<T> {
    let angle = by.dot(by).square_root();
    if angle < T::from_f64(1e-12) {
        return *orientation;
    }
    let axis = by * (T::ONE / angle);
    let angle = angle.limited(T::ZERO, T::from_f64(core::f64::consts::TAU));
    product(&about_axis(&axis, angle), orientation)
}

/// With norm 1, of one that is not zero.
#[must_use]
#[inline]
pub fn unit<T: Real>(q: &Quaternion<T>) -> Quaternion<T> {
    q * (T::ONE / q.dot(q).square_root())
}

/// First `second`, then `first`: the product first * second.
#[must_use]
pub fn product<T: Real>(first: &Quaternion<T>, second: &Quaternion<T>) -> Quaternion<T> {
    let (a, b) = (vector_part(first), vector_part(second));
    let w = first[0] * second[0] - a.dot(&b);
    let v = b * first[0] + a * second[0] + a.cross(&b);
    Quaternion::from([w, v.x, v.y, v.z])
}

/// The unit quaternion of a rotation matrix (axes of the frame in its columns).
///
/// Of the four equal formulas, which divide by different components, the one
/// with the largest divisor is taken: accurate everywhere.
#[must_use]
pub fn of_rotation<T: Real>(r: &Matrix3<T>) -> Quaternion<T> {
    let one = T::ONE;
    let (x, y, z) = (r.m11, r.m22, r.m33);
    let candidates = [
        [one + x + y + z, r.m32 - r.m23, r.m13 - r.m31, r.m21 - r.m12],
        [r.m32 - r.m23, one + x - y - z, r.m21 + r.m12, r.m13 + r.m31],
        [r.m13 - r.m31, r.m21 + r.m12, one - x + y - z, r.m32 + r.m23],
        [r.m21 - r.m12, r.m13 + r.m31, r.m32 + r.m23, one - x - y + z],
    ];
    let [mut best, ..] = candidates;
    let mut largest = T::ZERO;
    for (i, candidate) in candidates.iter().enumerate() {
        let divisor = candidate[i];
        for (best, &entry) in best.iter_mut().zip(candidate) {
            *best = largest.choose_below(divisor, entry, *best);
        }
        largest = largest.choose_below(divisor, divisor, largest);
    }
    // The largest divisor is four times the square of the largest component, at least 1.
    Quaternion::from(best) * (T::HALF / largest.most(T::HALF).square_root())
}

/// The orientation of a frame that is turned by `turn` in a link, whose DH frame is turned by
/// `link` in the base-plate frame: a unit quaternion in base-plate axes.
#[must_use]
#[inline]
pub fn of_frame<T: Real>(link: &Matrix3<T>, turn: &Quaternion<T>) -> Quaternion<T> {
    let own = of_rotation(link);
    // The DH frame itself stays as it is to the last bit, signs of zeros too.
    if *turn == identity() {
        return own;
    }
    product(&own, turn)
}

/// The orientation error of the law: the chord 2 sin(theta / 2) of the angle theta
/// between the orientations, times the axis about which the actual one must turn the
/// short way; base-plate axes, \[1\]. It is twice the vector part of
/// desired * actual^-1. For small angles it equals the rotation vector; it is largest
/// (2) at half a turn. `desired` need not be normalised and its sign does not matter.
#[must_use]
#[inline]
pub fn chord<T: Real>(desired: &Quaternion<T>, actual: &Quaternion<T>) -> Vector3<T> {
    let (d, a) = (vector_part(desired), vector_part(actual));
    let w = desired.dot(actual);
    let v = d * actual[0] - a * desired[0] - d.cross(&a);
    let norm = desired.dot(desired).square_root();
    v * ((T::ONE + T::ONE).with_sign_of(w) / norm)
}

/// The rotation vector theta times axis \[rad\] that belongs to a chord: the angle
/// itself, for figures.
#[must_use]
pub fn rotation_vector(chord: &Vector3<f64>) -> Vector3<f64> {
    let length = libm::sqrt(chord.dot(chord));
    if length < 1e-8 {
        return *chord;
    }
    chord * (2.0 * libm::asin(f64::min(0.5 * length, 1.0)) / length)
}

fn vector_part<T: Real>(q: &Quaternion<T>) -> Vector3<T> {
    Vector3::from([q[1], q[2], q[3]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    /// Rotation about a unit axis by an angle, by Rodrigues' formula.
    fn rodrigues(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
        let (sin, cos) = angle.sine_cosine();
        let cross = Matrix3::new(
            0.0, -axis.z, axis.y, axis.z, 0.0, -axis.x, -axis.y, axis.x, 0.0,
        );
        Matrix3::identity() + cross * sin + cross * cross * (1.0 - cos)
    }

    /// All angles up to and beyond half a turn, both signs of the desired
    /// quaternion: the chord turns the short way, 2 sin of half the angle, and
    /// its rotation vector has the angle itself. The
    /// quaternion of a matrix is accurate to some units of rounding.
    #[test]
    fn the_chord_takes_the_shortest_path_whatever_the_sign() {
        let axes = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.6, 0.0, 0.8],
            [0.48, -0.6, 0.64],
        ];
        let start = about_axis(&Vector3::from([0.0, 0.6, 0.8]), 1.1);
        for axis in axes.map(Vector3::from) {
            for step in -62..=62 {
                let angle = f64::from(step) * 0.1;
                let desired = product(&about_axis(&axis, angle), &start);
                let expected = axis * {
                    let (half, cosine) = (angle * 0.5).sine_cosine();
                    2.0 * half * 1.0_f64.copysign(cosine)
                };
                for sign in [1.0, -1.0, 1.3] {
                    let e = chord(&(desired * sign), &start);
                    assert!((e - expected).amax() < 1e-14, "{angle} {e}");
                    // Near half a turn the arc sine loses half the digits.
                    let short = (angle.abs() + PI).rem_euclid(2.0 * PI) - PI;
                    let length = rotation_vector(&e).norm();
                    assert!((length - short.abs()).abs() < 1e-7, "{angle} {length}");
                }
                let matrix = rodrigues(&axis, angle);
                let q = of_rotation(&matrix);
                assert!((q.norm() - 1.0).abs() < 1e-14);
                assert!(
                    chord(&about_axis(&axis, angle), &q).amax() < 1e-13,
                    "{angle}"
                );
            }
        }
    }
}
