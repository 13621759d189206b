//! The controller core on a Cortex-M7, and what proves that it works there.
//!
//! - [`guard`]: drive enable, heartbeat and emergency stop behind embedded-hal
//!   traits; [`machine`]: the controller with guard and recorder, one call per
//!   cycle. For whoever brings it to a board.
//! - [`job`]: the two experiments as constants; [`log`]: their inputs and
//!   torques as bytes, replayed on the target. For the self-test.
//! - [`workload`]: random and adverse inputs; [`stages`]: instructions of a cycle
//!   and of its parts. For the timing table.
//! - `mps2`: QEMU's board mps2-an500, bare metal only; `recording`: closed loops
//!   that make the log, host only.
//! - [`remote`]: the FRI session of the `bridge` with a guard, on any datagram
//!   link. For a co-processor without a PC.
//!
//! Each image is also a host program with the same name: `selftest` writes the
//! log, `bench` prints what the target must compute, `arm` shows a run.

#![no_std]

#[cfg(any(test, not(target_os = "none")))]
extern crate std;

pub mod guard;
pub mod job;
pub mod log;
pub mod machine;
#[cfg(target_os = "none")]
pub mod mps2;
#[cfg(not(target_os = "none"))]
pub mod recording;
pub mod remote;
pub mod stages;
pub mod workload;
