//! The controller core behind a robot's own interface: one datagram in, at most one
//! datagram out.
//!
//! Pure code: no socket, no clock, no allocation. Counters and the period in the
//! datagrams are the time, so the same [`session::Session`] runs behind a UDP socket, inside
//! the simulator, and on a microcontroller.
//!
//! - [`source`]: where the wanted motion comes from;
//! - [`protocol`]: what differs from robot to robot;
//! - [`lwr`]: the LWR by the Fast Research Interface;
//! - [`fci`]: Panda and FR3 by the Franka Control Interface, its real-time part;
//! - `belief`: which measured positions an arm can have reached;
//! - `link_monitor`: counters, and whether the link carries a motion;
//! - [`framing`]: datagrams on a serial line;
//! - [`transport`]: the link under a session, and its form on a serial line;
//! - [`audit`]: the robot's model against the controller's;
//! - [`session`]: the states of the conversation, and the cycle.
//!
//! What the robot adds itself is not sent: torque_sent = tau - g, and - C dq where
//! so configured. docs/fri.md is for users, the `fri` crate describes the LWR's datagrams.

#![no_std]

#[cfg(test)]
extern crate std;

pub mod audit;
mod belief;
pub mod fci;
pub mod framing;
mod link_monitor;
pub mod lwr;
pub mod protocol;
pub mod session;
pub mod source;
pub mod transport;
