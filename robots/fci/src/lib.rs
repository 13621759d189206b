//! The messages of the Franka Control Interface (FCI), versions 5 (Panda) to 10 (FR3).
//!
//! The robot sends a *state* by UDP every millisecond; while a motion runs its client answers
//! each with a *command*. *Requests* and *replies* go over TCP beside them. All are little
//! endian and packed; what differs from version to version: [`Version`].
//!
//! Bottom up:
//!
//! - [`version`], [`modes`], [`robot_error`], [`status`], [`kind`]: what is counted, with names
//!   and, by version, the codes of the wire;
//! - [`state`]: a view over bytes, checked once and total afterwards ([`StatePacket`]), and a
//!   plain value ([`State`]); [`command`]: a plain value ([`Command`]);
//! - [`stream`]: messages in a stream of bytes that comes in any pieces ([`Stream`]);
//! - [`request`] and [`reply`]: what they say ([`Request`], [`Reply`]), each written and read,
//!   so that both ends of the connection can be made of them;
//! - [`sequence`]: which states count;
//! - [`robot`]: the robot's end as a state machine, without sockets, clocks or an arm;
//! - [`client`]: the client's end of the connection over TCP, likewise.
//!
//! What can be read is read, bit by bit; whether its numbers can be used is a second question:
//! [`StatePacket::check_finite`], [`Command::check`], [`Request::check`]. Nothing here panics
//! or allocates, whatever the bytes.

#![no_std]

#[cfg(test)]
extern crate std;

mod bytes;
pub mod client;
pub mod command;
mod error;
pub mod kind;
mod listed;
pub mod modes;
pub mod reply;
pub mod request;
pub mod robot;
pub mod robot_error;
pub mod sequence;
pub mod state;
pub mod status;
pub mod stream;
pub mod version;

pub use command::Command;
pub use error::Error;
pub use kind::Kind;
pub use modes::{Controller, ControllerMode, Generator, MotionGeneratorMode, RobotMode};
pub use reply::{Reply, Setter};
pub use request::{Connect, Move, Request};
pub use robot_error::{RobotError, RobotErrors};
pub use sequence::Sequence;
pub use state::{DOF, Pose, State, StatePacket};
pub use stream::{Message, Stream};
pub use version::Version;
