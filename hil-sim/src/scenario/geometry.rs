//! Orientation of a link, from the DH table alone.

use controller_core::arm::LWR_IV;
use controller_core::joint::{JointVector, Matrix3};
use controller_core::real::Real;
use controller_core::task::orientation::{self, Quaternion};

/// Orientation of the DH frame of `link` (1..=7) in a posture \[rad\], base-plate
/// frame. Mismatched plants have the same geometry.
#[must_use]
pub fn orientation(q: &JointVector<f64>, link: usize) -> Quaternion<f64> {
    let mut rotation = Matrix3::identity();
    for (angle, link) in q.iter().zip(&LWR_IV.links).take(link) {
        let (sin, cos) = angle.sine_cosine();
        let (sin_twist, cos_twist) = link.alpha.sine_cosine();
        let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        let twist = Matrix3::new(
            1.0, 0.0, 0.0, 0.0, cos_twist, -sin_twist, 0.0, sin_twist, cos_twist,
        );
        rotation = rotation * turn * twist;
    }
    orientation::of_rotation(&rotation)
}
