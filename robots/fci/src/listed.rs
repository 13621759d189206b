//! Enumerations whose codes are places in a list, and whose lists depend on the version:
//! an entry that a version does not have leaves no gap in it.

use crate::error::Error;
use crate::version::Version;

/// An entry of a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry<T> {
    pub(crate) value: T,
    pub(crate) name: &'static str,
    pub(crate) first: Version,
    pub(crate) last: Version,
}

impl<T> Entry<T> {
    fn is_in(&self, version: Version) -> bool {
        self.first <= version && version <= self.last
    }
}

/// The entry at a place of the list of a version.
pub(crate) fn at<T: Copy>(
    list: &[Entry<T>],
    field: &'static str,
    version: Version,
    code: u32,
) -> Result<T, Error> {
    let mut count = 0;
    for entry in list.iter().filter(|entry| entry.is_in(version)) {
        if count == code {
            return Ok(entry.value);
        }
        count += 1;
    }
    Err(Error::Code {
        field,
        found: code,
        max: count.saturating_sub(1),
    })
}

/// The place of an entry in the list of a version.
pub(crate) fn place<T: Copy + PartialEq>(
    list: &[Entry<T>],
    version: Version,
    value: T,
) -> Result<u32, Error> {
    let mut count = 0;
    for entry in list {
        if entry.is_in(version) {
            if entry.value == value {
                return Ok(count);
            }
            count += 1;
        } else if entry.value == value {
            return Err(Error::NotInVersion {
                what: entry.name,
                version: version.number(),
                first: entry.first.number(),
                last: entry.last.number(),
            });
        }
    }
    // Every value is in its list.
    Ok(0)
}

/// The versions that have an entry: all unless said.
macro_rules! versions {
    () => {
        ($crate::version::Version::V5, $crate::version::Version::V10)
    };
    ($first:ident $last:ident) => {
        (
            $crate::version::Version::$first,
            $crate::version::Version::$last,
        )
    };
}

/// An enumeration of this kind: variants with the name that people read, in the order of
/// their codes.
macro_rules! listed {
    ($(#[$doc:meta])* $type:ident, $field:literal, {
        $($(#[$variant_doc:meta])* $variant:ident = $name:literal $(in $first:ident..$last:ident)?,)+
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
        pub enum $type {
            $($(#[$variant_doc])* #[doc = concat!("*", $name, "*")] $variant,)+
        }

        impl $type {
            const LIST: &'static [$crate::listed::Entry<Self>] = &[
                $($crate::listed::Entry {
                    value: Self::$variant,
                    name: $name,
                    first: $crate::listed::versions!($($first $last)?).0,
                    last: $crate::listed::versions!($($first $last)?).1,
                },)+
            ];

            /// All that some version has.
            pub fn all() -> impl Iterator<Item = Self> {
                Self::LIST.iter().map(|entry| entry.value)
            }

            /// From the wire.
            ///
            /// # Errors
            /// A code that means nothing in this version.
            pub fn from_code(version: $crate::version::Version, code: u32) -> Result<Self, $crate::error::Error> {
                $crate::listed::at(Self::LIST, $field, version, code)
            }

            /// To the wire.
            ///
            /// # Errors
            /// This version does not have it.
            pub fn code(self, version: $crate::version::Version) -> Result<u32, $crate::error::Error> {
                $crate::listed::place(Self::LIST, version, self)
            }

            /// Its name, for people.
            #[must_use]
            pub fn name(self) -> &'static str {
                Self::LIST.get(self as usize).map_or("", |entry| entry.name)
            }
        }

        impl core::fmt::Display for $type {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

pub(crate) use {listed, versions};
