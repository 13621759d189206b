//! Cartesian quantities in the order of the wire, and in the order x, y, z.
//!
//! The wire keeps rotational components in the order Z, Y, X, that of KUKA's angles
//! A, B, C. Swapping the fourth and the sixth entry converts either way. These
//! are components of rotation *vectors* (moment, angular velocity), not rates of
//! the angles.

use super::JOINTS;

/// A frame: the upper three rows \[R p\] of a homogenous matrix. R has no unit, p is
/// in m. Base and tool are those of the KRL stiffness structure, `$STIFFNESS`.
///
/// The rotation is kept as it came: nothing checks that R is orthonormal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Frame(pub [[f32; 4]; 3]);

impl Frame {
    /// Tool on base.
    pub const IDENTITY: Self = Self([
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]);

    /// A frame of a rotation (row by row, the tool's axes are its columns) and a
    /// position x, y, z \[m\].
    #[must_use]
    pub const fn new(rotation: [[f32; 3]; 3], position: [f32; 3]) -> Self {
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = rotation;
        let [x, y, z] = position;
        Self([[xx, xy, xz, x], [yx, yy, yz, y], [zx, zy, zz, z]])
    }

    /// Position x, y, z of the tool \[m\].
    #[must_use]
    pub const fn position(&self) -> [f32; 3] {
        let [[_, _, _, x], [_, _, _, y], [_, _, _, z]] = self.0;
        [x, y, z]
    }

    /// Rotation, row by row; the tool's axes are its columns.
    #[must_use]
    pub const fn rotation(&self) -> [[f32; 3]; 3] {
        let [[xx, xy, xz, _], [yx, yy, yz, _], [zx, zy, zz, _]] = self.0;
        [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]
    }
}

/// The identity: the frame of a datagram in which nobody set one.
impl Default for Frame {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// Six Cartesian components in the order of the wire, X Y Z RZ RY RX: a wrench
/// Fx Fy Fz Tz Ty Tx \[N, Nm\], a stiffness \[N/m, Nm/rad\] or a normalised damping.
/// They refer to the task frame of `$STIFFNESS`, which is configurable: compare
/// it with the motion before relying on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Cartesian(pub [f32; 6]);

impl Cartesian {
    /// From components X Y Z RX RY RZ.
    #[must_use]
    pub const fn from_xyz(xyz: [f32; 6]) -> Self {
        let [x, y, z, rx, ry, rz] = xyz;
        Self([x, y, z, rz, ry, rx])
    }

    /// Components X Y Z RX RY RZ.
    #[must_use]
    pub const fn to_xyz(&self) -> [f32; 6] {
        let [x, y, z, rz, ry, rx] = self.0;
        [x, y, z, rx, ry, rz]
    }

    /// The part along x, y, z: of a wrench the force \[N\].
    #[must_use]
    pub const fn linear(&self) -> [f32; 3] {
        let [x, y, z, ..] = self.0;
        [x, y, z]
    }

    /// The part about x, y, z: of a wrench the moment \[Nm\].
    #[must_use]
    pub const fn angular(&self) -> [f32; 3] {
        let [.., rz, ry, rx] = self.0;
        [rx, ry, rz]
    }
}

/// The geometric Jacobian, 6 rows in the order of the wire X Y Z RZ RY RX, 7 columns:
/// joint speeds \[rad/s\] to velocity \[m/s\] and angular velocity \[rad/s\] of the tool,
/// in the task frame of `$STIFFNESS`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Jacobian(pub [[f32; JOINTS]; 6]);

impl Jacobian {
    /// From rows X Y Z RX RY RZ.
    #[must_use]
    pub const fn from_xyz(xyz: [[f32; JOINTS]; 6]) -> Self {
        let [x, y, z, rx, ry, rz] = xyz;
        Self([x, y, z, rz, ry, rx])
    }

    /// Rows X Y Z RX RY RZ.
    #[must_use]
    pub const fn to_xyz(&self) -> [[f32; JOINTS]; 6] {
        let [x, y, z, rz, ry, rx] = self.0;
        [x, y, z, rx, ry, rz]
    }
}
