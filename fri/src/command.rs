//! The command (CMD): the client's answer to a measurement.

use crate::blocks::{Header, UserData, check, check_finite};
use crate::bytes::{f32s_at, put, put_f32s, u32_at};
use crate::error::Error;
use crate::frame::{DOF, Frame};

/// Bytes of a command.
pub const LEN: usize = 376;

/// Its id, also the version of the interface.
pub const ID: u16 = 0x1005;

/// Offsets.
mod field {
    pub const FLAGS: usize = 140;
    pub const JOINT_POSITION: usize = 144;
    pub const FRAME: usize = 172;
    pub const JOINT_TORQUE: usize = 220;
    pub const WRENCH: usize = 248;
    pub const JOINT_STIFFNESS: usize = 272;
    pub const JOINT_DAMPING: usize = 300;
    pub const CARTESIAN_STIFFNESS: usize = 328;
    pub const CARTESIAN_DAMPING: usize = 352;
}

/// Every field with reals: name, offset, count.
const REALS: &[(&str, usize, usize)] = &[
    ("user data real", crate::blocks::field::USER_REAL, 16),
    ("joint position", field::JOINT_POSITION, DOF),
    ("frame", field::FRAME, 12),
    ("added joint torque", field::JOINT_TORQUE, DOF),
    ("added wrench", field::WRENCH, 6),
    ("joint stiffness", field::JOINT_STIFFNESS, DOF),
    ("joint damping", field::JOINT_DAMPING, DOF),
    ("cartesian stiffness", field::CARTESIAN_STIFFNESS, 6),
    ("cartesian damping", field::CARTESIAN_DAMPING, 6),
];

/// Which fields of a command count. For the others the values of the robot's
/// program apply. They must not change in command state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Flags(pub u32);

impl Flags {
    /// Joint positions.
    pub const JOINT_POSITION: Self = Self(0x0001);
    /// Added joint torque.
    pub const JOINT_TORQUE: Self = Self(0x0004);
    /// Joint stiffness.
    pub const JOINT_STIFFNESS: Self = Self(0x0010);
    /// Joint damping.
    pub const JOINT_DAMPING: Self = Self(0x0020);
    /// Frame.
    pub const FRAME: Self = Self(0x0100);
    /// Added wrench.
    pub const WRENCH: Self = Self(0x0400);
    /// Cartesian stiffness.
    pub const CARTESIAN_STIFFNESS: Self = Self(0x1000);
    /// Cartesian damping.
    pub const CARTESIAN_DAMPING: Self = Self(0x2000);
    /// All that joint impedance uses: 0x35.
    pub const JOINT_IMPEDANCE: Self = Self(0x0035);

    /// Whether all of `other` are set.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// Bytes that have passed the check of a command.
#[derive(Clone, Copy, Debug)]
pub struct CommandPacket<T: AsRef<[u8]>> {
    bytes: T,
}

impl<T: AsRef<[u8]>> CommandPacket<T> {
    /// Checks length, id, size field, and that every real is finite.
    ///
    /// # Errors
    /// The first thing that is wrong, in this order.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        let slice = bytes.as_ref();
        check(slice, ID, LEN as u16)?;
        check_finite(slice, REALS)?;
        Ok(Self { bytes })
    }

    fn slice(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    /// Counters.
    #[must_use]
    pub fn header(&self) -> Header {
        Header::read(self.slice())
    }

    /// Data for the robot's program.
    #[must_use]
    pub fn user(&self) -> UserData {
        UserData::read(self.slice())
    }

    /// Which fields count.
    #[must_use]
    pub fn flags(&self) -> Flags {
        Flags(u32_at(self.slice(), field::FLAGS))
    }

    /// Joint angles \[rad\].
    #[must_use]
    pub fn joint_position(&self) -> [f32; DOF] {
        f32s_at(self.slice(), field::JOINT_POSITION)
    }

    /// Torque added at the joints \[Nm\].
    #[must_use]
    pub fn joint_torque(&self) -> [f32; DOF] {
        f32s_at(self.slice(), field::JOINT_TORQUE)
    }
}

/// A command as a plain value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Counters.
    pub header: Header,
    /// $FRI_FRM_..: data for the robot's program.
    pub user: UserData,
    /// Which of the following count.
    pub flags: Flags,
    /// Joint angles \[rad\].
    pub joint_position: [f32; DOF],
    /// Tool frame.
    pub frame: Frame,
    /// Torque added at the joints \[Nm\].
    pub joint_torque: [f32; DOF],
    /// Force \[N\] and torque \[Nm\] added at the tool: Fx Fy Fz Tz Ty Tx.
    pub wrench: [f32; 6],
    /// Joint stiffness \[Nm/rad\].
    pub joint_stiffness: [f32; DOF],
    /// Joint damping, 1 is critical.
    pub joint_damping: [f32; DOF],
    /// x y z \[N/m\], then rotations z y x \[Nm/rad\].
    pub cartesian_stiffness: [f32; 6],
    /// The same order, 1 is critical.
    pub cartesian_damping: [f32; 6],
}

impl Command {
    /// Bytes of the datagram.
    pub const LEN: usize = LEN;

    /// Everything in a checked datagram.
    #[must_use]
    pub fn parse<T: AsRef<[u8]>>(packet: &CommandPacket<T>) -> Self {
        let bytes = packet.slice();
        Self {
            header: packet.header(),
            user: packet.user(),
            flags: packet.flags(),
            joint_position: packet.joint_position(),
            frame: f32s_at(bytes, field::FRAME),
            joint_torque: packet.joint_torque(),
            wrench: f32s_at(bytes, field::WRENCH),
            joint_stiffness: f32s_at(bytes, field::JOINT_STIFFNESS),
            joint_damping: f32s_at(bytes, field::JOINT_DAMPING),
            cartesian_stiffness: f32s_at(bytes, field::CARTESIAN_STIFFNESS),
            cartesian_damping: f32s_at(bytes, field::CARTESIAN_DAMPING),
        }
    }

    /// The datagram. Reals are sent as they are: what is not finite will be
    /// refused at the other end.
    pub fn emit(&self, bytes: &mut [u8; LEN]) {
        self.header.write(bytes, ID, LEN as u16);
        self.user.write(bytes);
        put(bytes, field::FLAGS, self.flags.0.to_le_bytes());
        for (at, values) in [
            (field::JOINT_POSITION, &self.joint_position[..]),
            (field::FRAME, &self.frame),
            (field::JOINT_TORQUE, &self.joint_torque),
            (field::WRENCH, &self.wrench),
            (field::JOINT_STIFFNESS, &self.joint_stiffness),
            (field::JOINT_DAMPING, &self.joint_damping),
            (field::CARTESIAN_STIFFNESS, &self.cartesian_stiffness),
            (field::CARTESIAN_DAMPING, &self.cartesian_damping),
        ] {
            put_f32s(bytes, at, values);
        }
    }
}
