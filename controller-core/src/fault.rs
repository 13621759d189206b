//! Three kinds of trouble stay apart. A configuration that cannot be is a
//! `Result` at construction ([`crate::config::ConfigError`]). A *fault* is latched: the arm is
//! held by gravity torque until the caller resets it. A *limit* that was active
//! is a flag of one cycle; its torque is valid.

use core::fmt;

/// A set of up to eight joints or rows: bit i is joint i + 1 or task row i + 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Flags(pub u8);

impl Flags {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// Whether any flag is set.
    #[must_use]
    pub fn any(self) -> bool {
        self.0 != 0
    }

    /// Whether flag `index` (from 0) is set.
    #[must_use]
    pub fn contains(self, index: usize) -> bool {
        index < 8 && (self.0 >> index) & 1 != 0
    }

    /// Sets flag `index` (from 0) where `on`.
    #[inline(always)]
    pub fn set_if(&mut self, index: usize, on: bool) {
        if index < 8 {
            self.0 |= u8::from(on) << index;
        }
    }
}

/// What a fault is about. The numbers are stable: they go over wires and into logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
#[repr(u8)]
pub enum FaultKind {
    /// A measurement or reference that cannot be true.
    Implausible = 32,
    /// The law gave a torque that is not finite.
    NonFiniteTorque = 33,
}

impl FaultKind {
    /// The name used in logs and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Implausible => "implausible",
            Self::NonFiniteTorque => "non_finite_torque",
        }
    }
}

/// The quantity that made a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum Quantity {
    /// q of a joint \[rad\].
    Position,
    /// dq of a joint \[rad/s\].
    Speed,
    /// h, the measured interval \[s\].
    Interval,
    /// The reference of a task level.
    TaskReference,
    /// The squared norm of the desired orientation of a level.
    Orientation,
    /// The desired posture of a joint \[rad\].
    PostureReference,
    /// The number of task references.
    ReferenceCount,
    /// The demanded torque of a joint \[Nm\].
    Torque,
}

impl Quantity {
    fn name(self) -> &'static str {
        match self {
            Self::Position => "position [rad] of joint",
            Self::Speed => "speed [rad/s] of joint",
            Self::Interval => "measured interval [s]",
            Self::TaskReference => "reference of level",
            Self::Orientation => "squared quaternion norm of level",
            Self::PostureReference => "desired posture [rad] of joint",
            Self::ReferenceCount => "number of task references",
            Self::Torque => "demanded torque [Nm] of joint",
        }
    }
}

/// A latched fault: what, where, how much, and what would have been allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Fault {
    /// Stable kind.
    pub kind: FaultKind,
    /// The quantity.
    pub quantity: Quantity,
    /// Joint or level, counted from 1; 0 where there is only one.
    pub index: u8,
    /// Its value.
    pub value: f64,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind.name(), self.quantity.name())?;
        if self.index > 0 {
            write!(f, " {}", self.index)?;
        }
        write!(f, " is {}; ", self.value)?;
        if self.min == f64::MIN {
            write!(f, "it must be finite")
        } else {
            write!(f, "allowed {} to {}", self.min, self.max)
        }
    }
}

impl core::error::Error for Fault {}

/// What limited or degraded one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Status {
    /// The latched fault: the torque is the gravity torque of the last
    /// plausible posture.
    pub fault: Option<Fault>,
    /// Joints whose torque was cut to its limit. Limit number 96.
    pub saturated: Flags,
    /// Task rows without acceleration, because the rows above them leave no
    /// motion for them. Limit number 97.
    pub rank: Flags,
}

impl Status {
    /// No limit, no fault.
    pub const CLEAR: Self = Self {
        fault: None,
        saturated: Flags::NONE,
        rank: Flags::NONE,
    };

    /// Nothing limited the cycle and there is no fault.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        *self == Self::default()
    }
}
