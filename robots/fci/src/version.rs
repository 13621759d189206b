//! Versions of the interface. Both ends must have the same one.

use crate::error::Error;

/// A version of the interface, as Connect names it.
///
/// | version | robot system | arm | what differs from the one before |
/// |---|---|---|---|
/// | 5 | 4.2.1 and later 4.x | Panda | |
/// | 6 | 5.2 | FR3 | GetCartesianLimit and SetFilters are gone, statuses of the safety function come in |
/// | 7 | 5.5 | FR3 | commands have `torque_command_finished` |
/// | 8 | 5.7.0 | FR3 | GetRobotModel |
/// | 9 | 5.7.2 | FR3 | nothing |
/// | 10 | 5.9.0 and later | FR3 | reals of the state are binary32, accelerometers; LoadModelLibrary is gone; Move has fields of the asynchronous generator; torque without a motion generator |
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[repr(u16)]
#[allow(missing_docs)] // the table above
pub enum Version {
    V5 = 5,
    V6,
    V7,
    V8,
    V9,
    V10,
}

impl Version {
    /// All that there are here.
    pub const ALL: [Self; 6] = [Self::V5, Self::V6, Self::V7, Self::V8, Self::V9, Self::V10];

    /// From the number in Connect.
    ///
    /// # Errors
    /// A version that is not among [`Self::ALL`].
    pub fn from_number(found: u16) -> Result<Self, Error> {
        let mut all = Self::ALL.into_iter();
        all.find(|it| it.number() == found).ok_or(Error::Version {
            found,
            min: Self::V5.number(),
            max: Self::V10.number(),
        })
    }

    /// The number in Connect.
    #[must_use]
    pub const fn number(self) -> u16 {
        self as u16
    }

    /// Whether reals of the state are binary32; everything else has binary64.
    pub(crate) const fn is_single(self) -> bool {
        matches!(self, Self::V10)
    }

    /// Whether Move has the fields of the asynchronous generator.
    pub(crate) const fn has_asynchronous(self) -> bool {
        matches!(self, Self::V10)
    }

    /// Whether torque is commanded without a motion generator, and ended by
    /// `torque_command_finished`. Versions 7 to 9 have the byte, but no client of the
    /// vendor's that uses it.
    pub(crate) const fn has_torque_alone(self) -> bool {
        matches!(self, Self::V10)
    }

    /// Whether commands have `torque_command_finished`.
    pub(crate) const fn has_torque_finished(self) -> bool {
        !matches!(self, Self::V5 | Self::V6)
    }
}
