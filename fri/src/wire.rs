//! Datagrams as bytes, views and values.
//!
//! Everything is little endian and lies at fixed offsets, so both datagrams are
//! tables: [`measurement::field`] and [`command::field`] name every byte. Header
//! and user data are the same in both directions ([`header`]).
//!
//! Two ways to look at a datagram:
//!
//! - a *view*, [`MeasurementPacket`] or [`CommandPacket`], wraps any buffer.
//!   `new_checked` checks it once; from then on every accessor gives what the
//!   datagram says. Accessors are total: on a view from `new_unchecked`, bytes
//!   beyond the buffer read as zero, an unknown code reads as the code 0 (off,
//!   unacceptable, other), and writes beyond the buffer are dropped.
//! - a *value*, [`Msr`] or [`Cmd`], is a plain structure with `parse`, `emit` and
//!   `BUFFER_LEN`. What `parse` returned emits the same bytes again, apart from
//!   the fill, which becomes zero.
//!
//! What a check refuses ([`Error`]): a length, a size field or an id that is not
//! exactly that of the datagram; a code without a meaning, 0xFFFF included; any
//! real that is not finite. Ids double as version tags, so that an unknown
//! code under a known id is damage rather than a newer peer. Reals are checked
//! whether or not a flag says that they are used: one rule, and a checked
//! datagram is finite as a whole.

mod bytes;
mod cartesian;
mod cmd;
mod codes;
pub mod command;
mod error;
mod field;
pub mod header;
pub mod measurement;
mod msr;

pub use cartesian::{Cartesian, Frame, Jacobian};
pub use cmd::Cmd;
pub use codes::{CommandFlags, ControlScheme, Quality, State};
pub use command::CommandPacket;
pub use error::Error;
pub use field::{Field, Kind};
pub use header::{Header, UserData};
pub use measurement::MeasurementPacket;
pub use msr::{Arm, Drives, Interface, Msr, Statistics};

/// Joints of the arm.
pub const JOINTS: usize = 7;

/// One number per joint, base to flange: A1 A2 E1 A3 A4 A5 A6.
pub type Joints = [f32; JOINTS];
