//! What the robot makes of what it gets.

use core::fmt;

use crate::command::Command;
use crate::error::Error;
use crate::kind::Kind;
use crate::modes::{Controller, Generator, RobotMode};
use crate::request::Request;
use crate::robot_error::{RobotError, RobotErrors};
use crate::state::DOF;
use crate::status::MoveStatus;

/// What the person at the robot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operator {
    /// The brakes are open and the interface is switched on in the vendor's web interface.
    pub ready: bool,
    /// The stop for users is pressed.
    pub user_stop: bool,
    /// The external activating device is let go.
    pub released: bool,
    /// The arm is guided by hand, by the buttons on it.
    pub guiding: bool,
}

impl Operator {
    /// Nobody interferes.
    pub const ABSENT: Self = Self {
        ready: true,
        user_stop: false,
        released: false,
        guiding: false,
    };

    pub(super) const fn stops(&self) -> bool {
        self.user_stop || self.released
    }
}

/// A request that has its reply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handled {
    /// Id of the request.
    pub id: u32,
    /// Which one it is.
    pub kind: Kind,
    /// What it says; none if it says what nothing means.
    pub request: Option<Request>,
    /// Why it is refused; the status of the reply says it as far as the interface can.
    pub refused: Option<Refused>,
}

/// Why the robot does not do what it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// The client has another version.
    Version {
        /// The client's.
        found: u16,
        /// The robot's.
        expected: u16,
    },
    /// Not in this mode of the robot.
    Mode(RobotMode),
    /// A motion runs, or is about to.
    InMotion,
    /// No motion runs.
    NoMotion,
    /// This robot has no such motion.
    Motion(Controller, Generator),
    /// This robot has no asynchronous generator.
    Asynchronous,
    /// A number or a code.
    Argument(Error),
    /// A joint is beyond its range: the arm has to be moved by hand.
    Beyond {
        /// From 1.
        joint: usize,
    },
    /// There is no wall with this number.
    Wall(i32),
    /// The robot does not give it away.
    Absent(Kind),
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Version { found, expected } => {
                write!(f, "version: {found}; allowed: {expected}")
            }
            Self::Mode(mode) => write!(f, "robot mode {mode}"),
            Self::InMotion => f.write_str("a motion runs"),
            Self::NoMotion => f.write_str("no motion runs"),
            Self::Motion(controller, generator) => write!(
                f,
                "controller {controller} with motion generator {generator}; allowed: external \
                 with none or joint velocity"
            ),
            Self::Asynchronous => {
                f.write_str("asynchronous motion generator; allowed: a command every cycle")
            }
            Self::Argument(error) => error.fmt(f),
            Self::Beyond { joint } => {
                write!(f, "joint {joint} beyond its range: to be moved by hand")
            }
            Self::Wall(number) => write!(f, "wall {number}: there is none"),
            Self::Absent(kind) => write!(f, "{kind}: this robot has none"),
        }
    }
}

/// Why the connection is of no use any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Broken {
    /// What has come is no request.
    Stream(Error),
    /// A request before Connect, or behind one that was refused.
    NotConnected(Kind),
    /// Connect for the second time.
    Connected,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stream(error) => error.fmt(f),
            Self::NotConnected(kind) => write!(f, "{kind} before Connect"),
            Self::Connected => f.write_str("Connect for the second time"),
        }
    }
}

impl core::error::Error for Broken {}

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Received {
    /// It acts from now on.
    Accepted,
    /// It ends the motion.
    Last,
    /// The state has its command already: no effect.
    Repeated,
    /// To an older state, or to one that has not been sent: no effect.
    Late,
    /// No motion runs, or no state has shown it: no effect.
    NoMotion,
    /// It cannot be read, or has a number that is none: no effect.
    Unreadable(Error),
    /// It aborts the motion.
    Reflex(RobotError),
}

/// What the arm does in a cycle.
#[allow(clippy::large_enum_variant)] // there is no box
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// It is held where it is, or braked.
    Hold,
    /// Joint torque \[Nm\]; the robot adds that of gravity and of its motors' friction, and no other.
    Torque([f64; DOF]),
    /// The robot's own controllers follow this, where they exist:
    /// [`Motions::All`](super::Motions::All).
    Follow(Command),
}

/// A motion that has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ended {
    /// As its client is told.
    pub status: MoveStatus,
    /// Errors that have aborted it.
    pub reason: RobotErrors,
    /// Commands that came in time.
    pub commands: u64,
    /// Cycles behind the first command without one.
    pub lost: u64,
}

/// Commands since the robot's start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counters {
    /// Motions that have begun.
    pub motions: u64,
    /// Those of them that a reflex has aborted.
    pub reflexes: u64,
    /// Commands that came in time.
    pub commands: u64,
    /// Cycles of motions behind the first command without one.
    pub lost: u64,
    /// Commands to a state that had one.
    pub repeated: u64,
    /// Commands to an older state, or to one that was not sent.
    pub late: u64,
    /// Datagrams while no motion ran.
    pub idle: u64,
    /// Datagrams that cannot be used.
    pub unreadable: u64,
    /// Largest change of a joint's torque by a command \[Nm\], that of reflexes included.
    pub largest_torque_step_nm: f64,
}
