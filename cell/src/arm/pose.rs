//! Poses in files: a shift and three angles.

use controller_core::arm::Pose;
use controller_core::joint::Matrix3;
use controller_core::real::Real;

use crate::invalid::Invalid;
use crate::keys::keys;
use crate::ranges::{ANGLE_DEG, LENGTH_M};

keys! {
    /// Pose of a frame in its parent.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct PoseSpec {
        /// Origin of the frame in its parent.
        pub shift_m: [f64; 3] = [0.0; 3], "m", LENGTH_M;
        /// Roll, pitch, yaw of the frame in its parent, Rz(yaw) Ry(pitch) Rx(roll).
        pub rpy_deg: [f64; 3] = [0.0; 3], "deg", ANGLE_DEG;
    }
}

impl PoseSpec {
    /// # Errors
    /// A length or an angle outside its range.
    pub fn pose(&self) -> Result<Pose, Invalid> {
        self.check_keys()?;
        Ok(Pose {
            rotation: rotation(self.rpy_deg),
            shift: self.shift_m,
        })
    }
}

/// Rotation from a frame to its parent by roll, pitch and yaw \[deg\], turns about x, then y,
/// then z of the parent, by rows: Rz(yaw) Ry(pitch) Rx(roll).
#[must_use]
pub fn rotation(rpy_deg: [f64; 3]) -> [[f64; 3]; 3] {
    rotation_of(rpy_deg.map(f64::to_radians))
}

/// The same of angles in \[rad\].
#[must_use]
pub fn rotation_of(rpy: [f64; 3]) -> [[f64; 3]; 3] {
    // Right angles are exact, so that zeros stay zeros.
    let exact = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
    let [(sr, cr), (sp, cp), (sy, cy)] = rpy.map(|angle| {
        let (sine, cosine) = angle.sine_cosine();
        (exact(sine), exact(cosine))
    });
    let x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cr, -sr, 0.0, sr, cr);
    let y = Matrix3::new(cp, 0.0, sp, 0.0, 1.0, 0.0, -sp, 0.0, cp);
    let z = Matrix3::new(cy, -sy, 0.0, sy, cy, 0.0, 0.0, 0.0, 1.0);
    // nalgebra gives columns.
    (z * y * x).transpose().into()
}

/// Roll, pitch and yaw \[rad\] of a rotation by rows; with a pitch of a right angle the yaw is 0
/// where that leaves it open.
#[must_use]
pub fn roll_pitch_yaw(rotation: &[[f64; 3]; 3]) -> [f64; 3] {
    let [[xx, _, _], [yx, yy, yz], [zx, _, _]] = *rotation;
    let [[_, xy, xz], ..] = *rotation;
    let across = xx.hypot(yx);
    let yaw = if across < 1e-14 { 0.0 } else { yx.atan2(xx) };
    let pitch = (-zx).atan2(across);
    // What is left without the yaw: as exact beside a right angle as anywhere.
    let (sine, cosine) = yaw.sin_cos();
    let roll = (sine * xz - cosine * yz).atan2(cosine * yy - sine * xy);
    [roll, pitch, yaw]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_about_fixed_axes_in_the_order_x_y_z() {
        // x to z by a quarter turn about -y ..
        assert_eq!(
            rotation([0.0, -90.0, 0.0]),
            [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
        );
        // .. and y: first about x to z, then about the parent's z, which leaves it.
        let [_, _, z] = rotation([90.0, 0.0, 90.0]);
        assert_eq!(z, [0.0, 1.0, 0.0]);
        let turn = Matrix3::from(rotation([31.0, -57.0, 143.0])).transpose();
        assert!((turn * turn.transpose() - Matrix3::identity()).amax() < 1e-15);
        assert!((turn.determinant() - 1.0).abs() < 1e-15);
    }

    /// Also on and beside a pitch of a right angle, where roll and yaw are one.
    #[test]
    fn angles_give_their_rotation_again() {
        for pitch in [
            -90.0,
            -89.999_999,
            -90.0 + 1e-9,
            -30.0,
            0.0,
            57.0,
            90.0 - 1e-7,
            90.0,
        ] {
            for (roll, yaw) in [(0.0, 0.0), (31.0, -143.0), (180.0, 90.0), (-90.0, 45.0)] {
                let there = rotation([roll, pitch, yaw]);
                let again = rotation_of(roll_pitch_yaw(&there));
                let off = Matrix3::from(there) - Matrix3::from(again);
                // Beside a right angle the cosine is what is left of two numbers near 1.
                assert!(off.amax() < 1e-14, "{roll} {pitch} {yaw}: {}", off.amax());
            }
        }
    }
}
