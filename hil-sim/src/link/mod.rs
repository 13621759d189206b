//! The way of datagrams between robot and client, and what may happen to them on
//! it: faults by the spec of a command line, in virtual time, seeded.

mod channel;
mod fault;
mod lockstep;

pub use channel::{Channel, Delivery};
pub use fault::{BURST, DELAY_MS, Direction, Fault, FaultKind, SHARE, Window};
pub use lockstep::{Expect, LockStep, Peer, finish, is_over};
