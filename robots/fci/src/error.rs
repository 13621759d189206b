//! Why bytes are no message that can be used, or a message cannot be sent.

use core::fmt;

/// What is wrong, with the value found and what is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// A version that this crate does not have.
    Version {
        /// The version.
        found: u16,
        /// The lowest that it has.
        min: u16,
        /// The highest.
        max: u16,
    },
    /// Something has another number of bytes.
    Length {
        /// What it is.
        what: &'static str,
        /// Bytes that it has, or says that it has.
        found: usize,
        /// The fewest.
        min: usize,
        /// The most; `usize::MAX` where there is no limit.
        max: usize,
    },
    /// A code that means nothing in this version.
    Code {
        /// The field.
        field: &'static str,
        /// Its value.
        found: u32,
        /// The largest that means something.
        max: u32,
    },
    /// A truth value that is neither 0 nor 1.
    Bool {
        /// The field.
        field: &'static str,
        /// Which value of the field, from 0.
        index: usize,
        /// The byte.
        found: u8,
    },
    /// A number is infinite or NaN.
    NotFinite {
        /// The field.
        field: &'static str,
        /// Which number of the field, from 0.
        index: usize,
    },
    /// A number that no robot takes.
    Range {
        /// The field.
        field: &'static str,
        /// Which number of the field, from 0.
        index: usize,
        /// Its value.
        found: f64,
        /// The least.
        min: f64,
        /// The greatest.
        max: f64,
    },
    /// Something that this version does not have.
    NotInVersion {
        /// What it is.
        what: &'static str,
        /// The version.
        version: u16,
        /// The first that has it.
        first: u16,
        /// The last.
        last: u16,
    },
    /// The buffer to write into is too short.
    Room {
        /// Its bytes.
        found: usize,
        /// Bytes of the message.
        needed: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Version { found, min, max } => {
                write!(f, "version: {found}; allowed: {min} to {max}")
            }
            Self::Length {
                what,
                found,
                min,
                max,
            } if min == max => write!(f, "length of {what}: {found} bytes; allowed: {max}"),
            Self::Length {
                what,
                found,
                min,
                max: usize::MAX,
            } => write!(
                f,
                "length of {what}: {found} bytes; allowed: {min} and more"
            ),
            Self::Length {
                what,
                found,
                min,
                max,
            } => write!(
                f,
                "length of {what}: {found} bytes; allowed: {min} to {max}"
            ),
            Self::Code { field, found, max } => write!(f, "{field}: {found}; allowed: 0 to {max}"),
            Self::Bool {
                field,
                index,
                found,
            } => write!(f, "{field}[{index}]: {found}; allowed: 0 and 1"),
            Self::NotFinite { field, index } => {
                write!(f, "{field}[{index}]: not finite; allowed: finite numbers")
            }
            Self::Range {
                field,
                index,
                found,
                min,
                max,
            } => write!(f, "{field}[{index}]: {found}; allowed: {min} to {max}"),
            Self::NotInVersion {
                what,
                version,
                first,
                last,
            } => write!(f, "{what} in version {version}; allowed: {first} to {last}"),
            Self::Room { found, needed } => write!(
                f,
                "room for a message: {found} bytes; allowed: {needed} and more"
            ),
        }
    }
}

impl core::error::Error for Error {}
