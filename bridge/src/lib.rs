//! The controller core behind KUKA's Fast Research Interface: one datagram in,
//! one datagram out.
//!
//! Pure code: no socket, no clock, no allocation. Counters and the period in the
//! datagrams are the time, so the same [`session::Session`] runs behind a UDP socket, inside
//! the simulator, and on a microcontroller.
//!
//! - [`source`]: where the wanted motion comes from;
//! - `wire`: what the session reads of a measurement and writes into an answer;
//! - `belief`: which measured positions an arm can have reached;
//! - `link_monitor`: counters, and whether the link carries a motion;
//! - [`framing`]: datagrams on a serial line;
//! - [`transport`]: the link under a session, and its form on a serial line;
//! - `sent`: which of the torques sent acted on the arm;
//! - [`audit`]: the robot's model against the controller's;
//! - [`session`]: the states of the conversation, and the cycle.
//!
//! What the robot adds itself is not sent: torque_sent = tau - g, and - C dq where
//! so configured; stiffness and damping are zero and the position mirrors the
//! measured one, so that the robot's own spring and damper do not act. docs/fri.md
//! is for users, the `fri` crate describes the datagrams.

#![no_std]

#[cfg(test)]
extern crate std;

pub mod audit;
mod belief;
pub mod framing;
mod link_monitor;
mod sent;
pub mod session;
pub mod source;
pub mod transport;
mod wire;
