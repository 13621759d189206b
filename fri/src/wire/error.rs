//! Why a datagram is refused.

use core::fmt;

/// Why a datagram is refused: the first thing that is wrong, in the order length,
/// size, id, then field by field as they lie on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The datagram is shorter or longer than its kind.
    Length {
        /// Its length \[byte\].
        length: usize,
        /// The length of its kind \[byte\].
        expected: usize,
    },
    /// The size in the header is not that of the datagram.
    Size {
        /// The size field \[byte\].
        value: u16,
        /// The size of its kind \[byte\].
        expected: u16,
    },
    /// The id in the header is that of another kind or version.
    Id {
        /// The id.
        value: u16,
        /// The id of its kind.
        expected: u16,
    },
    /// A code without a meaning.
    Unknown {
        /// Name of the field.
        field: &'static str,
        /// The code.
        value: u16,
        /// The largest code with a meaning; the smallest is 0.
        max: u16,
    },
    /// A real that is infinite or not a number.
    NonFinite {
        /// Name of the field.
        field: &'static str,
        /// Which entry of the field, in wire order from 0; 0 in a field of one real.
        index: usize,
        /// The bits of the binary32: errors stay comparable where NaN is not.
        bits: u32,
    },
}

impl Error {
    /// The name of the kind, for logs and counts.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Length { .. } => "length",
            Self::Size { .. } => "size",
            Self::Id { .. } => "id",
            Self::Unknown { .. } => "unknown",
            Self::NonFinite { .. } => "non_finite",
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Length { length, expected } => {
                write!(f, "datagram has {length} bytes; it must have {expected}")
            }
            Self::Size { value, expected } => {
                write!(f, "packetSize is {value}; it must be {expected}")
            }
            Self::Id { value, expected } => {
                write!(
                    f,
                    "datagramId is 0x{value:04x}; it must be 0x{expected:04x}"
                )
            }
            Self::Unknown { field, value, max } => {
                write!(f, "{field} is {value}; allowed 0 to {max}")
            }
            Self::NonFinite { field, index, bits } => {
                let value = f32::from_bits(bits);
                write!(f, "{field}[{index}] is {value}; it must be finite")
            }
        }
    }
}

impl core::error::Error for Error {}
