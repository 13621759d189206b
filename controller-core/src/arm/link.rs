//! Links by number; points and frames fixed to them.

use crate::arm::pose::Pose;

/// A link of the arm; link i moves with joint i. Of the seven there are, so that a
/// link that does not exist cannot be written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[repr(u8)]
#[expect(missing_docs, reason = "the number says it")]
pub enum Link {
    L1,
    L2,
    L3,
    L4,
    L5,
    L6,
    L7,
}

impl Link {
    /// Base to flange.
    pub const ALL: [Self; 7] = [
        Self::L1,
        Self::L2,
        Self::L3,
        Self::L4,
        Self::L5,
        Self::L6,
        Self::L7,
    ];

    /// The link with this number, 1..=7; none for any other.
    #[must_use]
    pub const fn from_number(number: usize) -> Option<Self> {
        match number {
            1 => Some(Self::L1),
            2 => Some(Self::L2),
            3 => Some(Self::L3),
            4 => Some(Self::L4),
            5 => Some(Self::L5),
            6 => Some(Self::L6),
            7 => Some(Self::L7),
            _ => None,
        }
    }

    /// Its number, 1..=7; also the index of its DH frame.
    #[must_use]
    #[inline(always)]
    pub const fn number(self) -> usize {
        self as usize + 1
    }

    /// Its DH frame.
    #[must_use]
    pub const fn frame(self) -> LinkFrame {
        LinkFrame {
            link: self,
            rotation: Pose::IDENTITY.rotation,
        }
    }
}

/// A point fixed to a link. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct LinkPoint {
    /// Link that carries it.
    pub link: Link,
    /// Position \[m\] in the DH frame of that link.
    pub offset: [f64; 3],
}

/// A frame fixed to a link, as far as it turns. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct LinkFrame {
    /// Link that carries it.
    pub link: Link,
    /// Takes axes of the frame to those of the link's DH frame, by rows.
    pub rotation: [[f64; 3]; 3],
}

/// A point of an arm with a name. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedPoint {
    /// Its name in scenario files.
    pub name: &'static str,
    /// The point.
    pub point: LinkPoint,
}
