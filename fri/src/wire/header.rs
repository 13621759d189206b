//! What both directions begin with: header (8 bytes) and user data (132 bytes).

/// Byte ranges that both datagrams share.
pub mod field {
    use crate::wire::field::{Field, Kind};

    /// The sender's own counter, +1 per datagram sent, modulo 65536.
    pub const SEND_SEQ: Field = Field::u16("sendSeq", 0);
    /// The counter of the last datagram received from the peer, 0 before the first.
    pub const REFL_SEQ: Field = Field::u16("reflSeq", 2);
    /// Length of the datagram \[byte\].
    pub const PACKET_SIZE: Field = Field::u16("packetSize", 4);
    /// Kind and version of the datagram.
    pub const DATAGRAM_ID: Field = Field::u16("datagramId", 6);
    /// 16 reals of user data.
    pub const REAL: Field = Field::f32s("real", 8, 16);
    /// 16 integers of user data.
    pub const INT: Field = Field::new("int", 72, Kind::I32, 16);
    /// 16 booleans of user data, bit i is index i.
    pub const BOOL: Field = Field::u16("bool", 136);
    /// Fill.
    pub const FILL: Field = Field::new("fill", 138, Kind::Fill, 1);
}

/// The counters of a datagram. Size and id are not in it: they follow from the
/// kind of datagram, and `emit` writes them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Header {
    /// The sender's own counter: +1 per datagram, 65535 is followed by 0. Any start
    /// is valid.
    pub sequence: u16,
    /// The counter of the datagram this one answers; on the KRC's side that of the
    /// last command received. 0 before the first.
    pub reflected: u16,
}

/// The KRL block: numbers for the KRL program and from it, without a fixed meaning.
/// KRL counts from 1: index i here is `$FRI_TO_REA[i+1]` in a measurement and
/// `$FRI_FRM_REA[i+1]` in a command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct UserData {
    /// Reals, finite.
    pub reals: [f32; 16],
    /// Integers.
    pub ints: [i32; 16],
    /// Booleans, bit i is index i.
    pub bools: u16,
}

impl UserData {
    /// Boolean `index` (from 0); false beyond 15.
    #[must_use]
    pub const fn bool(&self, index: u32) -> bool {
        matches!(self.bools.checked_shr(index), Some(bits) if bits & 1 != 0)
    }

    /// Sets boolean `index` (from 0); nothing beyond 15.
    pub const fn set_bool(&mut self, index: u32, on: bool) {
        if let Some(bit) = 1u16.checked_shl(index) {
            self.bools = if on {
                self.bools | bit
            } else {
                self.bools & !bit
            };
        }
    }
}
