//! Why a conversation ends: the table of events.

use core::fmt;

use crate::error::Error;
use crate::kind::Kind;
use crate::modes::RobotMode;
use crate::robot_error::{RobotError, RobotErrors};
use crate::status::MoveStatus;

/// The end of a conversation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Why.
    pub cause: Cause,
    /// Whether a motion had begun.
    pub in_motion: bool,
}

/// Why, with what is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The host wished it, and the motion, if there was one, ended in good order.
    Finished,
    /// The host wished it at once.
    Halted,
    /// The external enabling device is let go.
    UserStop,
    /// The robot has aborted the motion, or was found so.
    Reflex(RobotErrors),
    /// The robot is in another mode than is needed.
    WrongMode {
        /// That of the robot.
        found: RobotMode,
        /// The one that is needed.
        needed: RobotMode,
    },
    /// The motion has another end than success, and no state says why.
    Aborted(MoveStatus),
    /// A request is refused.
    Refused {
        /// Which one.
        kind: Kind,
        /// Name of the status.
        status: &'static str,
        /// Mode in which the robot was.
        mode: RobotMode,
    },
    /// No version that both have.
    Version {
        /// The last one that was tried.
        ours: u16,
        /// That of the robot.
        robots: u16,
    },
    /// States come and something else does not.
    Late(Awaited),
    /// The TCP connection is closed.
    Closed,
    /// Nothing comes any more.
    Silent,
    /// The robot says what is no message, or cannot be asked.
    Protocol(Error),
}

/// What is waited for while states come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Awaited {
    /// The reply to a request; to Move the second one.
    Reply(Kind),
    /// That the state shows the motion.
    Motion,
    /// That it shows its end.
    End,
}

/// Kinds of [`Cause`]: the rows of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// [`Cause::Finished`].
    Finished,
    /// [`Cause::Halted`].
    Halted,
    /// [`Cause::UserStop`].
    UserStop,
    /// [`Cause::Reflex`] that is not of the next kind.
    Reflex,
    /// [`Cause::Reflex`] because of the connection: 20 commands in a row.
    Lost,
    /// [`Cause::WrongMode`].
    WrongMode,
    /// [`Cause::Aborted`].
    Aborted,
    /// [`Cause::Refused`].
    Refused,
    /// [`Cause::Version`].
    Version,
    /// [`Cause::Late`].
    Late,
    /// [`Cause::Closed`].
    Closed,
    /// [`Cause::Silent`].
    Silent,
    /// [`Cause::Protocol`].
    Protocol,
}

/// Exit code of a program whose robot took no motion.
const NO_MOTION: u8 = 4;
/// Exit code of a program whose motion was ended by something else than its wish.
const STOPPED: u8 = 3;

impl Stop {
    /// Exit code of a program: 0 done, 3 the motion was stopped, 4 there was none.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        self.cause.event().exit_code(self.in_motion)
    }
}

impl Cause {
    /// Its row of the table.
    #[must_use]
    pub fn event(&self) -> Event {
        match self {
            Self::Finished => Event::Finished,
            Self::Halted => Event::Halted,
            Self::UserStop => Event::UserStop,
            Self::Reflex(errors) => {
                if errors.contains(RobotError::CommunicationConstraintsViolation) {
                    Event::Lost
                } else {
                    Event::Reflex
                }
            }
            Self::WrongMode { .. } => Event::WrongMode,
            Self::Aborted(_) => Event::Aborted,
            Self::Refused { .. } => Event::Refused,
            Self::Version { .. } => Event::Version,
            Self::Late(_) => Event::Late,
            Self::Closed => Event::Closed,
            Self::Silent => Event::Silent,
            Self::Protocol(_) => Event::Protocol,
        }
    }
}

impl Event {
    /// All, in the order of the table.
    pub const ALL: [Self; 13] = [
        Self::Finished,
        Self::Halted,
        Self::UserStop,
        Self::Reflex,
        Self::Lost,
        Self::WrongMode,
        Self::Aborted,
        Self::Refused,
        Self::Version,
        Self::Late,
        Self::Closed,
        Self::Silent,
        Self::Protocol,
    ];

    /// A few words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Halted => "halted",
            Self::UserStop => "user stop",
            Self::Reflex => "reflex",
            Self::Lost => "20 commands lost",
            Self::WrongMode => "wrong mode",
            Self::Aborted => "aborted",
            Self::Refused => "refused",
            Self::Version => "wrong version",
            Self::Late => "late",
            Self::Closed => "connection closed",
            Self::Silent => "silence",
            Self::Protocol => "no message",
        }
    }

    /// How the client sees it.
    #[must_use]
    pub const fn seen(self) -> &'static str {
        match self {
            Self::Finished => "second reply to Move: success; the state shows no motion",
            Self::Halted => "replies to StopMove and Move; the state shows no motion",
            Self::UserStop => "robot mode user stopped",
            Self::Reflex => "robot mode reflex, its reasons in the state",
            Self::Lost => "robot mode reflex, communication_constraints_violation",
            Self::WrongMode => "for 1000 states before Move, or in the motion, another robot mode",
            Self::Aborted => "second reply to Move is no success, and no state says why",
            Self::Refused => "a reply that is no success, before the motion",
            Self::Version => "the reply to Connect names a version that is not the client's",
            Self::Late => "1000 states, and no reply or no end",
            Self::Closed => "TCP closed",
            Self::Silent => "nothing for 1 s: cable pulled, robot switched off",
            Self::Protocol => "bytes that are no reply; a number that cannot be sent",
        }
    }

    /// What the client does.
    #[must_use]
    pub const fn done(self) -> &'static str {
        match self {
            Self::Finished => "nothing",
            Self::Halted => "nothing: the robot brakes",
            Self::UserStop | Self::WrongMode | Self::Aborted => {
                "no more commands; the robot holds the arm"
            }
            Self::Reflex | Self::Lost => {
                "no more commands; AutomaticErrorRecovery once if that was asked for"
            }
            Self::Refused => "no Move",
            Self::Version => "closes; once more with the robot's version, if it is 5 to 10",
            Self::Late | Self::Protocol => "closes, by which the robot stops the arm",
            Self::Closed | Self::Silent => "no more commands; the robot stops the arm by itself",
        }
    }

    /// Exit code of a program, after a motion had begun and before.
    #[must_use]
    pub const fn exit_code(self, in_motion: bool) -> u8 {
        match self {
            Self::Finished => 0,
            Self::Halted => STOPPED,
            _ if in_motion => STOPPED,
            _ => NO_MOTION,
        }
    }

    /// A cause of this kind, as an example.
    #[must_use]
    pub const fn example(self) -> Cause {
        match self {
            Self::Finished => Cause::Finished,
            Self::Halted => Cause::Halted,
            Self::UserStop => Cause::UserStop,
            Self::Reflex => Cause::Reflex(RobotErrors::NONE.with(RobotError::CartesianReflex)),
            Self::Lost => {
                Cause::Reflex(RobotErrors::NONE.with(RobotError::CommunicationConstraintsViolation))
            }
            Self::WrongMode => Cause::WrongMode {
                found: RobotMode::Other,
                needed: RobotMode::Idle,
            },
            Self::Aborted => Cause::Aborted(MoveStatus::EmergencyAborted),
            Self::Refused => Cause::Refused {
                kind: Kind::SetLoad,
                status: "invalid argument",
                mode: RobotMode::Idle,
            },
            Self::Version => Cause::Version {
                ours: 10,
                robots: 4,
            },
            Self::Late => Cause::Late(Awaited::Reply(Kind::Move)),
            Self::Closed => Cause::Closed,
            Self::Silent => Cause::Silent,
            Self::Protocol => Cause::Protocol(Error::Code {
                field: "status of a setter",
                found: 9,
                max: 3,
            }),
        }
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finished => f.write_str("ended as wished"),
            Self::Halted => f.write_str("stopped at once by request"),
            Self::UserStop => f.write_str(
                "user stop: the enabling device is let go; press it again, and unlock the joints",
            ),
            Self::Reflex(errors) => match self.event() {
                Event::Lost => write!(
                    f,
                    "reflex: {errors}; 20 commands in a row were not there in time: \
                     look at the cable, the network card and `doctor`"
                ),
                _ => write!(f, "reflex: {errors}"),
            },
            Self::WrongMode { found, needed } => {
                write!(f, "robot mode: {found}; allowed: {needed}")?;
                match found {
                    RobotMode::Other => {
                        f.write_str(": open the brakes and enable FCI in the vendor's interface")
                    }
                    RobotMode::Guiding => f.write_str(": end the guiding"),
                    _ => Ok(()),
                }
            }
            Self::Aborted(status) => write!(f, "motion: {status}"),
            Self::Refused { kind, status, mode } => {
                write!(f, "{kind} refused: {status}, in robot mode {mode}")
            }
            Self::Version { ours, robots } => write!(
                f,
                "version of the robot: {robots}; tried: {ours}; allowed: 5 to 10"
            ),
            Self::Late(awaited) => {
                match awaited {
                    Awaited::Reply(kind) => write!(f, "reply to {kind}")?,
                    Awaited::Motion => f.write_str("state with the motion")?,
                    Awaited::End => f.write_str("state without the motion")?,
                }
                f.write_str(": none; allowed: within 1000 states")
            }
            Self::Closed => f.write_str("the robot closed the connection"),
            Self::Silent => {
                f.write_str("nothing came from the robot for 1 s: look at cable and power")
            }
            Self::Protocol(error) => write!(f, "the robot said what is no message: {error}"),
        }
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.cause)
    }
}
