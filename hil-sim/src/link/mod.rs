//! The way of datagrams between robot and client, and what may happen to them on
//! it: faults by the spec of a command line, in virtual time, seeded.

mod channel;
mod fault;
mod lockstep;

pub use channel::{Channel, Delivery};
pub use fault::{Direction, Fault, FaultKind, Window};
pub use lockstep::{Expect, LockStep, Peer};
