//! Three kinds of trouble stay apart. A configuration that cannot be is a
//! `Result` at construction ([`crate::error::ConfigError`]). A *fault* is latched: the arm is
//! braked and held ([`Mode`]) until the caller resets it. A *limit* that was active
//! is a flag of one cycle; its torque is valid.
//!
//! Faults and limits have numbers that go over wires and into logs. [`crate::numbers!`]
//! is the one list of them: the enumerations here, the names of the C interface and
//! the tables of docs/architecture.md are made from it or held against it.

use core::fmt;

use crate::arm::ArmParameters;
use crate::real::Real;

/// Calls `$define!` with every fault (32 to 95) and every limit (96 to 159):
/// `Variant = number, "name", CNAME, "meaning";`. A number is never used twice, not
/// even after its meaning is gone.
#[macro_export]
#[doc(hidden)]
macro_rules! numbers {
    ($define:ident) => {
        $define! {
            faults {
                Implausible = 32, "implausible", "IMPLAUSIBLE",
                    "a measurement or reference that cannot be true";
                NonFiniteTorque = 33, "non_finite_torque", "NON_FINITE_TORQUE",
                    "the law gave a torque that is not finite";
                WrongTarget = 34, "wrong_target", "WRONG_TARGET",
                    "a target of another kind than the task of its level";
            }
            limits {
                Saturated = 96, "saturated", "SATURATED",
                    "torque of a joint cut to its limit";
                Rank = 97, "rank", "RANK",
                    "task row without acceleration: the rows above leave no motion for it";
                TorqueRate = 98, "torque_rate", "TORQUE_RATE",
                    "torque of a joint cut to its largest change per cycle";
                Joining = 99, "joining", "JOINING",
                    "a level, or the posture, on its way to a reference that jumped";
                Degraded = 100, "degraded", "DEGRADED",
                    "a level near a singularity: along a direction it is driven less than it asks";
                Released = 101, "released", "RELEASED",
                    "a level in a singularity: a direction is given to the levels below";
                Shaped = 102, "shaped", "SHAPED",
                    "command of a level shortened: its error, or a direction that it loses";
                Scaled = 103, "scaled", "SCALED",
                    "a level, or the null space, gets a share of what it asks the joints for";
                Bounded = 104, "bounded", "BOUNDED",
                    "a joint at what its range or its speed limit allows";
                Unresolved = 105, "unresolved", "UNRESOLVED",
                    "bounds of the joints kept by a cut: too many at once to share out";
                Stuck = 106, "stuck", "STUCK",
                    "a level off its target in a singularity that no free motion leads out of";
                Changing = 107, "changing", "CHANGING",
                    "a level, or the null space, on its way to tasks or gains that were changed";
                Stale = 108, "stale", "STALE",
                    "a level whose reference is too old: it comes to rest";
            }
        }
    };
}

macro_rules! enumerations {
    (faults { $($fault:tt)* } limits { $($limit:tt)* }) => {
        enumeration! {
            /// What a fault is about, 32 to 95. The numbers are stable: they go over wires
            /// and into logs.
            FaultKind { $($fault)* }
        }
        enumeration! {
            /// What limited or degraded a cycle whose torque is valid, 96 to 159. The
            /// numbers are stable, as those of faults.
            LimitKind { $($limit)* }
        }
    };
}

macro_rules! enumeration {
    (
        $(#[doc = $about:literal])* $kind:ident {
            $($variant:ident = $number:literal, $name:literal, $c_name:literal,
                $meaning:literal;)*
        }
    ) => {
        $(#[doc = $about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
        #[non_exhaustive]
        #[repr(u8)]
        pub enum $kind {
            $(#[doc = $meaning] $variant = $number,)*
        }

        impl $kind {
            /// All of them, by number.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// Its stable number.
            #[must_use]
            pub const fn number(self) -> u8 {
                self as u8
            }

            /// The name used in logs and reports.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// What it means.
            #[must_use]
            pub const fn meaning(self) -> &'static str {
                match self { $(Self::$variant => $meaning,)* }
            }
        }
    };
}
numbers!(enumerations);

/// A set of up to eight indices: bit i is joint i + 1, or task row i + 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct IndexSet(pub u8);

impl IndexSet {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// Whether there is any index in it.
    #[must_use]
    pub fn any(self) -> bool {
        self.0 != 0
    }

    /// Whether `index` (from 0) is in it.
    #[must_use]
    pub fn contains(self, index: usize) -> bool {
        index < 8 && (self.0 >> index) & 1 != 0
    }

    /// Takes `index` (from 0) out.
    pub(crate) fn remove(&mut self, index: usize) {
        if index < 8 {
            self.0 &= !(1 << index);
        }
    }

    /// Adds `index` (from 0) where `on`.
    #[inline(always)]
    pub(crate) fn insert_if(&mut self, index: usize, on: bool) {
        if index < 8 {
            self.0 |= u8::from(on) << index;
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
    /// Distance of the target of a level from the shoulder \[m\].
    TargetDistance,
    /// Desired speed of a level \[m/s\].
    TargetSpeed,
    /// Desired acceleration of a level \[m/s2\].
    TargetAcceleration,
    /// Desired angular speed of a level \[rad/s\].
    TargetAngularSpeed,
    /// Desired angular acceleration of a level \[rad/s2\].
    TargetAngularAcceleration,
    /// The squared norm of the desired orientation of a level.
    Orientation,
    /// The kind of the target of a level: [`POSITION_CODE`] or [`ORIENTATION_CODE`].
    TargetKind,
    /// The desired posture of a joint \[rad\].
    PostureReference,
    /// The number of targets.
    TargetCount,
    /// The demanded torque of a joint \[Nm\].
    Torque,
    /// The speed that a resolver demands of a joint \[rad/s\].
    SpeedCommand,
}

/// A position, as value of [`Quantity::TargetKind`].
pub const POSITION_CODE: f64 = 1.0;

/// An orientation, as value of [`Quantity::TargetKind`].
pub const ORIENTATION_CODE: f64 = 2.0;

/// What the index of a fault counts.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Joint,
    Level,
    /// There is only one.
    Whole,
}

impl Quantity {
    /// With its unit, and what it is of.
    fn name(self) -> (&'static str, Place) {
        match self {
            Self::Position => ("position [rad] of", Place::Joint),
            Self::Speed => ("speed [rad/s] of", Place::Joint),
            Self::Interval => ("measured interval [s]", Place::Whole),
            Self::TargetDistance => (
                "distance [m] from the shoulder of the target of",
                Place::Level,
            ),
            Self::TargetSpeed => ("desired speed [m/s] of", Place::Level),
            Self::TargetAcceleration => ("desired acceleration [m/s2] of", Place::Level),
            Self::TargetAngularSpeed => ("desired angular speed [rad/s] of", Place::Level),
            Self::TargetAngularAcceleration => {
                ("desired angular acceleration [rad/s2] of", Place::Level)
            }
            Self::Orientation => ("squared quaternion norm of", Place::Level),
            Self::TargetKind => ("kind of target of", Place::Level),
            Self::PostureReference => ("desired posture [rad] of", Place::Joint),
            Self::TargetCount => ("number of targets", Place::Whole),
            Self::Torque => ("demanded torque [Nm] of", Place::Joint),
            Self::SpeedCommand => ("demanded speed [rad/s] of", Place::Joint),
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

/// A joint in a text: by the name that its maker gave it, without an arm by its number.
pub(crate) struct JointLabel<'a> {
    /// Counted from 1.
    pub number: usize,
    pub arm: Option<&'a ArmParameters>,
}

impl fmt::Display for JointLabel<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let link = self.number.wrapping_sub(1);
        match self.arm.and_then(|arm| arm.links.get(link)) {
            Some(link) => f.write_str(link.name),
            None => write!(f, "joint {}", self.number),
        }
    }
}

/// What is text with or without the names of an arm's joints.
pub(crate) trait NamesJoints {
    fn write(&self, f: &mut fmt::Formatter<'_>, arm: Option<&ArmParameters>) -> fmt::Result;
}

/// The text with them.
pub(crate) struct Named<'a, T> {
    pub of: &'a T,
    pub arm: &'a ArmParameters,
}

impl<T: NamesJoints> fmt::Display for Named<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.of.write(f, Some(self.arm))
    }
}

impl Fault {
    /// The same as text that calls joints by the names that their maker gave them.
    #[must_use]
    pub fn named<'a>(&'a self, arm: &'a ArmParameters) -> impl fmt::Display + 'a {
        Named { of: self, arm }
    }
}

impl NamesJoints for Fault {
    fn write(&self, f: &mut fmt::Formatter<'_>, arm: Option<&ArmParameters>) -> fmt::Result {
        let (name, place) = self.quantity.name();
        write!(f, "{}: {name}", self.kind.name())?;
        let number = self.index.into();
        match place {
            Place::Joint => write!(f, " {}", JointLabel { number, arm })?,
            Place::Level => write!(f, " level {number}")?,
            Place::Whole => (),
        }
        if self.quantity == Quantity::TargetKind {
            let word = |code: f64| {
                if code == ORIENTATION_CODE {
                    "an orientation"
                } else {
                    "a position"
                }
            };
            let (given, allowed) = (word(self.value), word(self.min));
            return write!(f, " is {given}; allowed hold or {allowed}");
        }
        if self.value.magnitude() < 1e9 {
            write!(f, " is {}; ", self.value)?;
        } else {
            write!(f, " is {:e}; ", self.value)?;
        }
        if self.min == f64::MIN {
            write!(f, "it must be finite")
        } else {
            write!(f, "allowed {} to {}", self.min, self.max)
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, None)
    }
}

impl core::error::Error for Fault {}

/// What a cycle is part of. Only the first two are without a fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
#[repr(u8)]
pub enum Mode {
    /// The law moves the arm.
    #[default]
    Running = 0,
    /// The law moves the arm, and a limit was active.
    Limited = 1,
    /// A fault is latched and the arm moves: g(q) - c M dq.
    Braking = 2,
    /// A fault is latched and the arm rests: the same torque, which is g(q) at rest.
    Resting = 3,
    /// A fault is latched and no measurement can be followed: the last believed gravity
    /// torque fades. The drives should close their brakes now.
    Blind = 4,
    /// The torque has faded to zero; only a reset leads out.
    Stopped = 5,
}

impl Mode {
    /// All of them, by number.
    pub const ALL: &[Self] = &[
        Self::Running,
        Self::Limited,
        Self::Braking,
        Self::Resting,
        Self::Blind,
        Self::Stopped,
    ];

    /// Its stable number.
    #[must_use]
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// The name used in logs and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Limited => "limited",
            Self::Braking => "braking",
            Self::Resting => "resting",
            Self::Blind => "blind",
            Self::Stopped => "stopped",
        }
    }
}

/// What limited or degraded one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Status {
    /// What the cycle is part of.
    pub mode: Mode,
    /// The latched fault: the arm is braked, see [`Mode`].
    pub fault: Option<Fault>,
    /// Joints of [`LimitKind::Saturated`].
    pub saturated: IndexSet,
    /// Task rows of [`LimitKind::Rank`].
    pub rank: IndexSet,
    /// Joints of [`LimitKind::TorqueRate`].
    pub rate_limited: IndexSet,
    /// Slots of levels of [`LimitKind::Joining`]; bit 7, the eighth, is the posture.
    pub joining: IndexSet,
    /// Slots of levels of [`LimitKind::Degraded`].
    pub degraded: IndexSet,
    /// Slots of levels of [`LimitKind::Released`].
    pub released: IndexSet,
    /// Slots of levels of [`LimitKind::Shaped`].
    pub shaped: IndexSet,
    /// Slots of levels of [`LimitKind::Scaled`]; bit 7, the eighth, is the null space.
    pub scaled: IndexSet,
    /// Joints of [`LimitKind::Bounded`] that may not go further down.
    pub at_least: IndexSet,
    /// Joints of [`LimitKind::Bounded`] that may not go further up.
    pub at_greatest: IndexSet,
    /// Whether [`LimitKind::Unresolved`].
    pub unresolved: bool,
    /// Slots of levels of [`LimitKind::Stuck`].
    pub stuck: IndexSet,
    /// Slots of [`LimitKind::Changing`]; bit 7, the eighth, is the null space.
    pub changing: IndexSet,
    /// Slots of [`LimitKind::Stale`].
    pub stale: IndexSet,
    /// Exchanges that the projection onto the bounds took, at most
    /// [`PIVOTS`](crate::ranges::PIVOTS); 0 where no bound was in the way.
    pub pivots: u8,
}

impl Status {
    /// No limit, no fault.
    pub const CLEAR: Self = Self {
        mode: Mode::Running,
        fault: None,
        saturated: IndexSet::NONE,
        rank: IndexSet::NONE,
        rate_limited: IndexSet::NONE,
        joining: IndexSet::NONE,
        degraded: IndexSet::NONE,
        released: IndexSet::NONE,
        shaped: IndexSet::NONE,
        scaled: IndexSet::NONE,
        at_least: IndexSet::NONE,
        at_greatest: IndexSet::NONE,
        unresolved: false,
        stuck: IndexSet::NONE,
        changing: IndexSet::NONE,
        stale: IndexSet::NONE,
        pivots: 0,
    };

    /// The same of a cycle without a fault: the limits that were active say its mode.
    #[inline(always)]
    pub(crate) const fn without_fault(self) -> Self {
        let sets = self.saturated.0
            | self.rank.0
            | self.rate_limited.0
            | self.joining.0
            | self.degraded.0
            | self.released.0
            | self.shaped.0
            | self.scaled.0
            | self.at_least.0
            | self.at_greatest.0
            | self.stuck.0
            | self.changing.0
            | self.stale.0;
        Self {
            mode: if sets != 0 || self.unresolved {
                Mode::Limited
            } else {
                Mode::Running
            },
            fault: None,
            ..self
        }
    }

    /// Nothing limited the cycle and there is no fault.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        *self == Self::CLEAR
    }

    /// The limits that were active.
    pub fn limits(&self) -> impl Iterator<Item = LimitKind> {
        let active = [
            (LimitKind::Saturated, self.saturated),
            (LimitKind::Rank, self.rank),
            (LimitKind::TorqueRate, self.rate_limited),
            (LimitKind::Joining, self.joining),
            (LimitKind::Degraded, self.degraded),
            (LimitKind::Released, self.released),
            (LimitKind::Shaped, self.shaped),
            (LimitKind::Scaled, self.scaled),
            (
                LimitKind::Bounded,
                IndexSet(self.at_least.0 | self.at_greatest.0),
            ),
            (LimitKind::Unresolved, IndexSet(u8::from(self.unresolved))),
            (LimitKind::Stuck, self.stuck),
            (LimitKind::Changing, self.changing),
            (LimitKind::Stale, self.stale),
        ];
        active
            .into_iter()
            .filter_map(|(kind, indices)| indices.any().then_some(kind))
    }
}
