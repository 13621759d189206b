//! The datagrams of KUKA's Fast Research Interface, version 1.0 (LWR IV, LWR IV+).
//!
//! The robot sends a *measurement* (916 bytes) every cycle, its client answers
//! each with one *command* (376 bytes). Both are little endian; reals are
//! binary32 in rad, m, Nm, N and s. Joints count from the base to the flange.
//!
//! Bottom up:
//!
//! - [`bytes`]: numbers at an offset, for whoever adds a field;
//! - [`measurement`] and [`command`]: each as a view over bytes, checked once and
//!   total afterwards (`MeasurementPacket`, `CommandPacket`), and as a plain value
//!   ([`Measurement`], [`Command`]); a value that can be made can be sent, and a
//!   datagram that passes the check can be read;
//! - [`blocks`]: what both have in common: header and user data;
//! - [`sequence`]: counters: what was lost, repeated or overtaken.
//!
//! Nothing here panics or allocates, whatever the bytes.
//!
//! Rotational components of Cartesian values are in the order z, y, x; accessors
//! named `.._xyz` turn them round. Frames are the upper three rows of a
//! homogenous matrix, row by row.

#![no_std]

#[cfg(test)]
extern crate std;

pub mod blocks;
pub mod bytes;
pub mod command;
mod error;
mod frame;
pub mod measurement;
pub mod sequence;

pub use blocks::{Header, UserData};
pub use command::{Command, CommandPacket, Flags};
pub use error::Error;
pub use frame::{DOF, Frame, position};
pub use measurement::{ControlScheme, InterfaceState, Measurement, MeasurementPacket, Quality};
