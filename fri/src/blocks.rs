//! What both datagrams begin with: header and user data.

use crate::bytes::{f32s_at, get, i32s_at, put, put_f32s, put_i32s, u16_at};
use crate::error::Error;

/// Offsets of the common fields.
pub(crate) mod field {
    pub const COUNTER: usize = 0;
    pub const REFLECTED: usize = 2;
    pub const SIZE: usize = 4;
    pub const ID: usize = 6;
    pub const USER_REAL: usize = 8;
    pub const USER_INT: usize = 72;
    pub const USER_BOOL: usize = 136;
}

/// The counters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Header {
    /// Counter of the sender, one more for every datagram; 65535 is followed by 0.
    pub counter: u16,
    /// Counter of the last datagram that the sender has received; 0 before the first.
    pub reflected: u16,
}

/// Data between the client and the program on the robot ($FRI_TO_.. and
/// $FRI_FRM_..): the entry with index i is KRL's entry i + 1. No fixed meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct UserData {
    /// Reals.
    pub real: [f32; 16],
    /// Integers.
    pub int: [i32; 16],
    /// Booleans, bit i is index i.
    pub bool: u16,
}

impl Header {
    /// Reads the counters.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Self {
        Self {
            counter: u16_at(bytes, field::COUNTER),
            reflected: u16_at(bytes, field::REFLECTED),
        }
    }

    pub(crate) fn write(&self, bytes: &mut [u8], id: u16, size: u16) {
        put(bytes, field::COUNTER, self.counter.to_le_bytes());
        put(bytes, field::REFLECTED, self.reflected.to_le_bytes());
        put(bytes, field::SIZE, size.to_le_bytes());
        put(bytes, field::ID, id.to_le_bytes());
    }
}

impl UserData {
    /// Reads the block.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Self {
        Self {
            real: f32s_at(bytes, field::USER_REAL),
            int: i32s_at(bytes, field::USER_INT),
            bool: u16::from_le_bytes(get(bytes, field::USER_BOOL)),
        }
    }

    pub(crate) fn write(&self, bytes: &mut [u8]) {
        put_f32s(bytes, field::USER_REAL, &self.real);
        put_i32s(bytes, field::USER_INT, &self.int);
        put(bytes, field::USER_BOOL, self.bool.to_le_bytes());
        // The 16 bits behind it are fill.
        put(bytes, field::USER_BOOL + 2, [0, 0]);
    }
}

/// Checks length, id and size field.
pub(crate) fn check(bytes: &[u8], id: u16, size: u16) -> Result<(), Error> {
    let (found, expected) = (bytes.len(), usize::from(size));
    if found != expected {
        return Err(Error::Length { found, expected });
    }
    let found = u16_at(bytes, field::ID);
    if found != id {
        return Err(Error::Id {
            found,
            expected: id,
        });
    }
    let found = u16_at(bytes, field::SIZE);
    if found != size {
        return Err(Error::Size {
            found,
            expected: size,
        });
    }
    Ok(())
}

/// Checks that fields contain finite numbers only: (name, offset, count).
pub(crate) fn check_finite(
    bytes: &[u8],
    fields: &[(&'static str, usize, usize)],
) -> Result<(), Error> {
    for &(field, at, count) in fields {
        if let Some(index) = crate::bytes::first_not_finite(bytes, at, count) {
            return Err(Error::NotFinite { field, index });
        }
    }
    Ok(())
}
