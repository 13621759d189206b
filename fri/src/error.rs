//! Why bytes are not a datagram that can be used.

use core::fmt;

/// What is wrong, with the value found and the one expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The datagram has another length.
    Length {
        /// Bytes that came.
        found: usize,
        /// Bytes of this kind of datagram.
        expected: usize,
    },
    /// The id is another one: another kind of datagram, or another version.
    Id {
        /// The id that came.
        found: u16,
        /// The id of this kind of datagram.
        expected: u16,
    },
    /// The size field disagrees with the length.
    Size {
        /// Its value.
        found: u16,
        /// The length.
        expected: u16,
    },
    /// A number is infinite or NaN.
    NotFinite {
        /// The field.
        field: &'static str,
        /// Which number of the field, from 0.
        index: usize,
    },
    /// A code that means nothing.
    Code {
        /// The field.
        field: &'static str,
        /// Its value.
        found: u16,
        /// The largest that means something, apart from 65535, invalid.
        max: u16,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Length { found, expected } => {
                write!(f, "length: {found} bytes; allowed: {expected}")
            }
            Self::Id { found, expected } => write!(f, "id: {found:#06x}; allowed: {expected:#06x}"),
            Self::Size { found, expected } => write!(f, "size field: {found}; allowed: {expected}"),
            Self::NotFinite { field, index } => {
                write!(f, "{field}[{index}]: not finite; allowed: finite numbers")
            }
            Self::Code { field, found, max } => {
                write!(f, "{field}: {found}; allowed: 0 to {max}, 65535")
            }
        }
    }
}

impl core::error::Error for Error {}
