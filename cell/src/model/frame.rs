//! Frames as matrices, for what is computed once.

use controller_core::arm::Pose;
use controller_core::joint::{Matrix3, Vector3};

/// Pose of a frame in a parent frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Takes axes of the frame to those of the parent.
    pub rotation: Matrix3<f64>,
    /// Origin \[m\], axes of the parent.
    pub shift: Vector3<f64>,
}

impl Frame {
    /// The parent itself.
    #[must_use]
    pub fn identity() -> Self {
        Self {
            rotation: Matrix3::identity(),
            shift: Vector3::zeros(),
        }
    }

    /// A turn by `angle` \[rad\] about the line through `point` along the unit vector `axis`
    /// (Rodrigues).
    #[must_use]
    pub fn turn(axis: &Vector3<f64>, point: &Vector3<f64>, angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        let across = axis.cross_matrix();
        let rotation = Matrix3::identity() + across * sine + across * across * (1.0 - cosine);
        Self {
            rotation,
            shift: point - rotation * point,
        }
    }

    /// Pose in the parent of what has the pose `inner` in this frame.
    #[must_use]
    pub fn carrying(&self, inner: &Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            shift: self.place(&inner.shift),
        }
    }

    /// Where `point` \[m\] of the frame is in the parent \[m\].
    #[must_use]
    pub fn place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.shift
    }

    /// Pose of the parent in this frame.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            rotation: self.rotation.transpose(),
            shift: -self.rotation.tr_mul(&self.shift),
        }
    }

    /// As a table says it.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose {
            // nalgebra gives columns.
            rotation: self.rotation.transpose().into(),
            shift: self.shift.into(),
        }
    }
}

impl From<&Pose> for Frame {
    fn from(pose: &Pose) -> Self {
        Self {
            rotation: Matrix3::from(pose.rotation).transpose(),
            shift: pose.shift.into(),
        }
    }
}
