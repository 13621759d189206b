//! The command (CMD), PC to KRC: 376 bytes, the answer to one measurement.
//!
//! What the quantities mean is said at [`Cmd`](super::Cmd).

use super::bytes;
use super::field::{check_len, check_values};
use super::{Cartesian, CommandFlags, Error, Frame, Joints};

/// Length of a command \[byte\].
pub const LEN: usize = 376;
/// The same as its size field says it.
pub const SIZE: u16 = 376;
/// Id of a command of interface version 1.0.
pub const ID: u16 = 0x1005;

/// Byte ranges of a command, in wire order. The bit of
/// [`CommandFlags`](super::CommandFlags) says whether the KRC uses a field.
pub mod field {
    pub use crate::wire::header::field::*;

    use super::LEN;
    use crate::wire::field::{Field, Kind, tile};

    /// Which of the fields below are used.
    pub const CMD_FLAGS: Field = Field::new("cmdFlags", 140, Kind::U32, 1);
    /// Joint positions \[rad\], 7. Bit 0x0001.
    pub const JNT_POS: Field = Field::f32s("jntPos", 144, 7);
    /// Tool frame \[m\], 3 rows of 4. Bit 0x0100.
    pub const CART_POS: Field = Field::f32s("cartPos", 172, 12);
    /// Additional joint torque \[Nm\], 7. Bit 0x0004.
    pub const ADD_JNT_TRQ: Field = Field::f32s("addJntTrq", 220, 7);
    /// Additional wrench Fx Fy Fz Tz Ty Tx \[N, Nm\]. Bit 0x0400.
    pub const ADD_TCP_FT: Field = Field::f32s("addTcpFT", 248, 6);
    /// Joint stiffness \[Nm/rad\], 7. Bit 0x0010.
    pub const JNT_STIFFNESS: Field = Field::f32s("jntStiffness", 272, 7);
    /// Joint damping, normalised, 7. Bit 0x0020.
    pub const JNT_DAMPING: Field = Field::f32s("jntDamping", 300, 7);
    /// Cartesian stiffness X Y Z RZ RY RX \[N/m, Nm/rad\]. Bit 0x1000.
    pub const CART_STIFFNESS: Field = Field::f32s("cartStiffness", 328, 6);
    /// Cartesian damping X Y Z RZ RY RX, normalised. Bit 0x2000.
    pub const CART_DAMPING: Field = Field::f32s("cartDamping", 352, 6);

    /// Every field, in wire order, without gap.
    pub const ALL: [Field; 17] = [
        SEND_SEQ,
        REFL_SEQ,
        PACKET_SIZE,
        DATAGRAM_ID,
        REAL,
        INT,
        BOOL,
        FILL,
        CMD_FLAGS,
        JNT_POS,
        CART_POS,
        ADD_JNT_TRQ,
        ADD_TCP_FT,
        JNT_STIFFNESS,
        JNT_DAMPING,
        CART_STIFFNESS,
        CART_DAMPING,
    ];

    const _: () = assert!(tile(&ALL, LEN));
}

/// View of a command over a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommandPacket<T> {
    buffer: T,
}

impl<T: AsRef<[u8]>> CommandPacket<T> {
    /// A view without any check: to write a datagram, or to look at a bad one.
    pub const fn new_unchecked(buffer: T) -> Self {
        Self { buffer }
    }

    /// A view of a datagram that [`check`](Self::check) accepts.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong.
    pub fn new_checked(buffer: T) -> Result<Self, Error> {
        let packet = Self::new_unchecked(buffer);
        packet.check()?;
        Ok(packet)
    }

    /// All checks: length, header, values.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), Error> {
        self.check_len()?;
        self.check_header()?;
        self.check_values()
    }

    /// The buffer has exactly [`LEN`] bytes.
    ///
    /// # Errors
    ///
    /// [`Error::Length`]
    pub fn check_len(&self) -> Result<(), Error> {
        check_len(self.buffer.as_ref(), LEN)
    }

    /// The header has the size [`SIZE`] and the id [`ID`].
    ///
    /// # Errors
    ///
    /// [`Error::Size`], [`Error::Id`]
    pub fn check_header(&self) -> Result<(), Error> {
        let (size, id) = (self.packet_size(), self.datagram_id());
        if size != SIZE {
            return Err(Error::Size {
                value: size,
                expected: SIZE,
            });
        }
        if id != ID {
            return Err(Error::Id {
                value: id,
                expected: ID,
            });
        }
        Ok(())
    }

    /// Every code has a meaning and every real is finite.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`], [`Error::NonFinite`]
    pub fn check_values(&self) -> Result<(), Error> {
        check_values(self.buffer.as_ref(), &field::ALL)
    }

    /// Gives the buffer back.
    pub fn into_inner(self) -> T {
        self.buffer
    }

    /// The sender's own counter.
    #[must_use]
    pub fn sequence(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::SEND_SEQ)
    }

    /// The counter of the peer's datagram this one reflects, 0 before the first.
    #[must_use]
    pub fn reflected(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::REFL_SEQ)
    }

    /// The size field \[byte\].
    #[must_use]
    pub fn packet_size(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::PACKET_SIZE)
    }

    /// The id field.
    #[must_use]
    pub fn datagram_id(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::DATAGRAM_ID)
    }

    /// Reals of the user data.
    #[must_use]
    pub fn reals(&self) -> [f32; 16] {
        bytes::f32s(self.buffer.as_ref(), field::REAL)
    }

    /// Integers of the user data.
    #[must_use]
    pub fn ints(&self) -> [i32; 16] {
        bytes::i32s(self.buffer.as_ref(), field::INT)
    }

    /// Booleans of the user data, bit i is index i.
    #[must_use]
    pub fn bools(&self) -> u16 {
        bytes::u16(self.buffer.as_ref(), field::BOOL)
    }

    /// Which fields are used.
    #[must_use]
    pub fn flags(&self) -> CommandFlags {
        CommandFlags(bytes::u32(self.buffer.as_ref(), field::CMD_FLAGS))
    }

    /// Joint positions \[rad\].
    #[must_use]
    pub fn joint_position(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::JNT_POS)
    }

    /// Tool frame \[m\].
    #[must_use]
    pub fn frame(&self) -> Frame {
        Frame(bytes::rows(self.buffer.as_ref(), field::CART_POS))
    }

    /// Additional joint torque \[Nm\].
    #[must_use]
    pub fn joint_torque(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::ADD_JNT_TRQ)
    }

    /// Additional wrench at the tool \[N, Nm\].
    #[must_use]
    pub fn wrench(&self) -> Cartesian {
        Cartesian(bytes::f32s(self.buffer.as_ref(), field::ADD_TCP_FT))
    }

    /// Joint stiffness \[Nm/rad\].
    #[must_use]
    pub fn joint_stiffness(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::JNT_STIFFNESS)
    }

    /// Joint damping, normalised.
    #[must_use]
    pub fn joint_damping(&self) -> Joints {
        bytes::f32s(self.buffer.as_ref(), field::JNT_DAMPING)
    }

    /// Cartesian stiffness \[N/m, Nm/rad\].
    #[must_use]
    pub fn cartesian_stiffness(&self) -> Cartesian {
        Cartesian(bytes::f32s(self.buffer.as_ref(), field::CART_STIFFNESS))
    }

    /// Cartesian damping, normalised.
    #[must_use]
    pub fn cartesian_damping(&self) -> Cartesian {
        Cartesian(bytes::f32s(self.buffer.as_ref(), field::CART_DAMPING))
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> CommandPacket<T> {
    /// Writes what makes the bytes a command: size, id and a fill of zero.
    pub fn set_format(&mut self) {
        bytes::set_u16(self.buffer.as_mut(), field::PACKET_SIZE, SIZE);
        bytes::set_u16(self.buffer.as_mut(), field::DATAGRAM_ID, ID);
        bytes::set_u16(self.buffer.as_mut(), field::FILL, 0);
    }

    /// The sender's own counter.
    pub fn set_sequence(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::SEND_SEQ, value);
    }

    /// The counter of the peer's datagram this one reflects, 0 before the first.
    pub fn set_reflected(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::REFL_SEQ, value);
    }

    /// Reals of the user data.
    pub fn set_reals(&mut self, value: &[f32; 16]) {
        bytes::set_f32s(self.buffer.as_mut(), field::REAL, value);
    }

    /// Integers of the user data.
    pub fn set_ints(&mut self, value: &[i32; 16]) {
        bytes::set_i32s(self.buffer.as_mut(), field::INT, value);
    }

    /// Booleans of the user data, bit i is index i.
    pub fn set_bools(&mut self, value: u16) {
        bytes::set_u16(self.buffer.as_mut(), field::BOOL, value);
    }

    /// Which fields are used.
    pub fn set_flags(&mut self, value: CommandFlags) {
        bytes::set_u32(self.buffer.as_mut(), field::CMD_FLAGS, value.0);
    }

    /// Joint positions \[rad\].
    pub fn set_joint_position(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::JNT_POS, value);
    }

    /// Tool frame \[m\].
    pub fn set_frame(&mut self, value: &Frame) {
        bytes::set_f32s(
            self.buffer.as_mut(),
            field::CART_POS,
            value.0.as_flattened(),
        );
    }

    /// Additional joint torque \[Nm\].
    pub fn set_joint_torque(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::ADD_JNT_TRQ, value);
    }

    /// Additional wrench at the tool \[N, Nm\].
    pub fn set_wrench(&mut self, value: &Cartesian) {
        bytes::set_f32s(self.buffer.as_mut(), field::ADD_TCP_FT, &value.0);
    }

    /// Joint stiffness \[Nm/rad\].
    pub fn set_joint_stiffness(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::JNT_STIFFNESS, value);
    }

    /// Joint damping, normalised.
    pub fn set_joint_damping(&mut self, value: &Joints) {
        bytes::set_f32s(self.buffer.as_mut(), field::JNT_DAMPING, value);
    }

    /// Cartesian stiffness \[N/m, Nm/rad\].
    pub fn set_cartesian_stiffness(&mut self, value: &Cartesian) {
        bytes::set_f32s(self.buffer.as_mut(), field::CART_STIFFNESS, &value.0);
    }

    /// Cartesian damping, normalised.
    pub fn set_cartesian_damping(&mut self, value: &Cartesian) {
        bytes::set_f32s(self.buffer.as_mut(), field::CART_DAMPING, &value.0);
    }
}
