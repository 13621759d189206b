//! The axes that a task controls.

use core::ops::BitOr;

use crate::joint::{Vector3, zeros};
use crate::real::Real;

/// Base-plate axes that a task controls, at least one: `Axes::X | Axes::Y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Axes(u8);

impl Axes {
    /// x alone.
    pub const X: Self = Self(1);
    /// y alone.
    pub const Y: Self = Self(2);
    /// z alone.
    pub const Z: Self = Self(4);
    /// The horizontal plane.
    pub const XY: Self = Self(3);
    /// All three axes.
    pub const XYZ: Self = Self(7);

    /// From bits, 1 for x, 2 for y, 4 for z; none for no axis or other bits.
    #[must_use]
    pub const fn from_bits(bits: u32) -> Option<Self> {
        match bits {
            1..=7 => Some(Self(bits as u8)),
            _ => None,
        }
    }

    /// From a name such as `xyz`, `xz` or `y`: each letter at most once, in
    /// this order. None for anything else.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let mut bits = 0;
        for letter in name.bytes() {
            let bit = match letter {
                b'x' => 1,
                b'y' => 2,
                b'z' => 4,
                _ => return None,
            };
            if bit <= bits {
                return None;
            }
            bits |= bit;
        }
        Self::from_bits(bits)
    }

    /// Whether axis `index` (0 x, 1 y, 2 z) is controlled.
    #[must_use]
    #[inline(always)]
    pub const fn contains(self, index: usize) -> bool {
        index < 3 && (self.0 >> index) & 1 != 0
    }

    /// The same for all three, x, y, z.
    #[must_use]
    pub const fn flags(self) -> [bool; 3] {
        [self.contains(0), self.contains(1), self.contains(2)]
    }

    /// Number of rows, 1 to 3.
    #[must_use]
    pub const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// `v` with the other axes set to zero.
    #[must_use]
    #[inline(always)]
    pub fn select<T: Real>(self, v: &Vector3<T>) -> Vector3<T> {
        let mut selected = zeros();
        for axis in 0..3 {
            if self.contains(axis) {
                selected[axis] = v[axis];
            }
        }
        selected
    }
}

impl BitOr for Axes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_names() {
        assert_eq!(Axes::from_name("xyz"), Some(Axes::XYZ));
        assert_eq!(Axes::from_name("xy"), Some(Axes::X | Axes::Y));
        assert_eq!(Axes::from_name("xz").unwrap().flags(), [true, false, true]);
        assert_eq!(Axes::from_name("z"), Some(Axes::Z));
        for wrong in ["", "yx", "xx", "xw", "a", "xyzx", "XY"] {
            assert_eq!(Axes::from_name(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn bits_are_one_to_seven() {
        let counts = (0..10).map(|bits| Axes::from_bits(bits).map_or(0, Axes::count));
        assert!(counts.eq([0, 1, 1, 2, 1, 2, 2, 3, 0, 0]));
    }
}
