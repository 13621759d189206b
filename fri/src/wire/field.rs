//! Named byte ranges, and the check that reads nothing but their table.

use super::bytes;
use super::error::Error;

/// What the bytes of a field are. All little endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum Kind {
    /// IEEE-754 binary32, one or several; finite.
    F32,
    /// Signed 32 bit, one or several.
    I32,
    /// Unsigned 32 bit.
    U32,
    /// Unsigned 16 bit.
    U16,
    /// Unsigned 16 bit with a meaning from 0 to `max`.
    Code {
        /// The largest code with a meaning.
        max: u16,
    },
    /// No meaning: written as 0, not read.
    Fill,
}

/// A named byte range of a datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Field {
    /// The protocol's name, as errors print it.
    pub name: &'static str,
    /// Offset of the first byte.
    pub start: usize,
    /// Offset after the last byte.
    pub end: usize,
    /// What the bytes are.
    pub kind: Kind,
}

impl Field {
    /// `count` entries of a kind from offset `start` on.
    pub(super) const fn new(name: &'static str, start: usize, kind: Kind, count: usize) -> Self {
        let width = match kind {
            Kind::F32 | Kind::I32 | Kind::U32 => 4,
            Kind::U16 | Kind::Code { .. } | Kind::Fill => 2,
        };
        Self {
            name,
            start,
            end: start.saturating_add(count.saturating_mul(width)),
            kind,
        }
    }

    /// One binary32.
    pub(super) const fn f32(name: &'static str, start: usize) -> Self {
        Self::new(name, start, Kind::F32, 1)
    }

    /// `count` binary32.
    pub(super) const fn f32s(name: &'static str, start: usize, count: usize) -> Self {
        Self::new(name, start, Kind::F32, count)
    }

    /// One unsigned 16 bit.
    pub(super) const fn u16(name: &'static str, start: usize) -> Self {
        Self::new(name, start, Kind::U16, 1)
    }
}

/// Whether the fields follow one another without gap or overlap and end at `len`.
/// Evaluated by the compiler, once per datagram.
#[expect(
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    reason = "runs in the compiler"
)]
pub(super) const fn tile(fields: &[Field], len: usize) -> bool {
    let (mut i, mut end) = (0, 0);
    while i < fields.len() {
        if fields[i].start != end {
            return false;
        }
        end = fields[i].end;
        i += 1;
    }
    end == len
}

/// Exactly this long.
pub(super) fn check_len(data: &[u8], expected: usize) -> Result<(), Error> {
    let length = data.len();
    if length == expected {
        Ok(())
    } else {
        Err(Error::Length { length, expected })
    }
}

/// Every code known, every real finite.
pub(super) fn check_values(data: &[u8], fields: &[Field]) -> Result<(), Error> {
    for field in fields {
        match field.kind {
            Kind::F32 => check_finite(data, *field)?,
            Kind::Code { max } => {
                let value = bytes::u16(data, *field);
                if value > max {
                    return Err(Error::Unknown {
                        field: field.name,
                        value,
                        max,
                    });
                }
            }
            Kind::I32 | Kind::U32 | Kind::U16 | Kind::Fill => {}
        }
    }
    Ok(())
}

fn check_finite(data: &[u8], field: Field) -> Result<(), Error> {
    let refused = bytes::words(data, field)
        .enumerate()
        .find_map(|(index, word)| {
            let bits = u32::from_le_bytes(*word);
            let finite = f32::from_bits(bits).is_finite();
            (!finite).then_some(Error::NonFinite {
                field: field.name,
                index,
                bits,
            })
        });
    refused.map_or(Ok(()), Err)
}
