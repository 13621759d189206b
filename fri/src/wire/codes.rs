//! Enumerations and bit sets.

use core::ops::BitOr;

/// State of the interface. Only the KRC switches it; the PC can ask for it through
/// user data that the KRL program reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[repr(u16)]
pub enum State {
    /// No interface. Entered by `friClose`; nothing is sent in it, so that it is
    /// hardly ever seen on the wire.
    #[default]
    Off = 0,
    /// Measurements flow, answers are expected and rated, commands have no
    /// effect. Entered by `friOpen`, by `friStop`, and from command by any error or
    /// a bad link.
    Monitor = 1,
    /// Commands move the robot and must keep their time. Entered by `friStart`,
    /// once the timing was good for some time.
    Command = 2,
}

impl State {
    /// The state of a code, where it has one.
    #[must_use]
    pub const fn from_raw(raw: u16) -> Option<Self> {
        match raw {
            0 => Some(Self::Off),
            1 => Some(Self::Monitor),
            2 => Some(Self::Command),
            _ => None,
        }
    }

    /// The code on the wire.
    #[must_use]
    pub const fn raw(self) -> u16 {
        self as u16
    }
}

/// How the KRC rates the link, from worst to best.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[repr(u16)]
pub enum Quality {
    /// Commanding is forbidden.
    #[default]
    Unacceptable = 0,
    /// Commanding is possible.
    Bad = 1,
    /// Commanding is possible.
    Ok = 2,
    /// What KRL programs usually wait for before they start.
    Perfect = 3,
}

impl Quality {
    /// The quality of a code, where it has one.
    #[must_use]
    pub const fn from_raw(raw: u16) -> Option<Self> {
        match raw {
            0 => Some(Self::Unacceptable),
            1 => Some(Self::Bad),
            2 => Some(Self::Ok),
            3 => Some(Self::Perfect),
            _ => None,
        }
    }

    /// The code on the wire.
    #[must_use]
    pub const fn raw(self) -> u16 {
        self as u16
    }

    /// Whether the KRC lets the PC command on such a link.
    #[must_use]
    pub fn allows_command(self) -> bool {
        self > Self::Unacceptable
    }
}

/// The control law that runs on the robot. Changes in monitor state only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[repr(u16)]
pub enum ControlScheme {
    /// None of those below.
    #[default]
    Other = 0,
    /// Joint positions; `$STIFFNESS.STRATEGY` 10.
    Position = 1,
    /// Spring, damper and wrench at the tool; `$STIFFNESS.STRATEGY` 20.
    CartesianImpedance = 2,
    /// Spring, damper and torque per joint; `$STIFFNESS.STRATEGY` 30.
    JointImpedance = 3,
}

impl ControlScheme {
    /// The scheme of a code, where it has one.
    #[must_use]
    pub const fn from_raw(raw: u16) -> Option<Self> {
        match raw {
            0 => Some(Self::Other),
            1 => Some(Self::Position),
            2 => Some(Self::CartesianImpedance),
            3 => Some(Self::JointImpedance),
            _ => None,
        }
    }

    /// The code on the wire.
    #[must_use]
    pub const fn raw(self) -> u16 {
        self as u16
    }
}

/// Which fields of a command the KRC shall use: one bit per field. A field whose
/// bit is clear is ignored, and the KRL program's value applies.
///
/// The set must stay the same throughout command state; a robot stops when it
/// changes. Choose it in monitor state. Any 32 bits are a set: what lies outside
/// of [`CommandFlags::SUPPORTED`] is kept and left to the receiver to judge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct CommandFlags(pub u32);

impl CommandFlags {
    /// No field.
    pub const NONE: Self = Self(0);
    /// Joint positions.
    pub const JOINT_POSITION: Self = Self(0x0001);
    /// Additional joint torque.
    pub const JOINT_TORQUE: Self = Self(0x0004);
    /// Joint stiffness.
    pub const JOINT_STIFFNESS: Self = Self(0x0010);
    /// Joint damping.
    pub const JOINT_DAMPING: Self = Self(0x0020);
    /// Tool frame.
    pub const FRAME: Self = Self(0x0100);
    /// Additional wrench at the tool.
    pub const WRENCH: Self = Self(0x0400);
    /// Cartesian stiffness.
    pub const CARTESIAN_STIFFNESS: Self = Self(0x1000);
    /// Cartesian damping.
    pub const CARTESIAN_DAMPING: Self = Self(0x2000);

    /// All that [`ControlScheme::JointImpedance`] uses, 0x0035.
    pub const JOINT_IMPEDANCE: Self = Self(0x0035);
    /// All that [`ControlScheme::CartesianImpedance`] uses, 0x3501; the joint
    /// positions guide the null space.
    pub const CARTESIAN_IMPEDANCE: Self = Self(0x3501);
    /// Every bit with a field. Of the others, 0x0002 and 0x0200 are reserved for
    /// velocities, which no controller supports.
    pub const SUPPORTED: Self = Self(0x3535);

    /// Whether every flag of `other` is set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The flags without a field, reserved ones included.
    #[must_use]
    pub const fn unsupported(self) -> Self {
        Self(self.0 & !Self::SUPPORTED.0)
    }
}

impl BitOr for CommandFlags {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
