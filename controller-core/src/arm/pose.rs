//! Where one frame is in another.

/// Pose of a frame in a parent frame. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Takes axes of the frame to those of the parent: its columns are the frame's axes.
    /// By rows.
    pub rotation: [[f64; 3]; 3],
    /// Origin of the frame \[m\], axes of the parent.
    pub shift: [f64; 3],
}

impl Pose {
    /// The parent frame itself.
    pub const IDENTITY: Self = Self::at([0.0; 3]);

    /// At `shift` \[m\], not turned.
    #[must_use]
    pub const fn at(shift: [f64; 3]) -> Self {
        Self {
            rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            shift,
        }
    }

    /// Pose in the parent frame of what has the pose `inner` in this frame.
    #[must_use]
    pub fn carrying(&self, inner: &Self) -> Self {
        Self {
            rotation: self.turned(&inner.rotation),
            shift: self.place(inner.shift),
        }
    }

    /// Rotation in the parent frame of what is turned by `inner` in this frame.
    #[must_use]
    pub fn turned(&self, inner: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        let [first, second, third] = inner;
        self.rotation
            .map(|[a, b, c]| core::array::from_fn(|i| a * first[i] + b * second[i] + c * third[i]))
    }

    /// Where `point` \[m\] of the frame is in the parent frame \[m\].
    #[must_use]
    pub fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = point;
        let mut placed = self.shift;
        for (along, row) in placed.iter_mut().zip(&self.rotation) {
            *along += row[0] * x + row[1] * y + row[2] * z;
        }
        placed
    }
}

/// Largest entry of R^T R - 1: 0 where the axes are orthogonal and of length 1. More than
/// 1 where they are a mirror image.
pub(crate) fn distortion(rotation: &[[f64; 3]; 3]) -> f64 {
    let rotation = nalgebra::Matrix3::from(*rotation); // transposed: no matter
    let gram = rotation.tr_mul(&rotation) - nalgebra::Matrix3::identity();
    let mirrored = if rotation.determinant() > 0.0 {
        0.0
    } else {
        2.0
    };
    gram.iter().fold(mirrored, |most, entry| {
        // Not lost in a maximum: NaN stays.
        if entry.abs() <= most {
            most
        } else {
            entry.abs()
        }
    })
}
