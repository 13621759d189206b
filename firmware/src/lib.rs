//! The controller core on a Cortex-M7, and what proves that it works there.
//!
//! - [`interlock`]: drive enable, heartbeat and emergency stop behind embedded-hal
//!   traits; [`interlocked_controller`]: the controller with interlock and recorder,
//!   one call per cycle. For whoever brings it to a board.
//! - [`scenario`]: two scenarios as constants; [`log`]: their inputs and
//!   torques as bytes, replayed on the target. For the self-test.
//! - [`workload`]: random and adverse inputs; [`stages`]: instructions of a cycle
//!   and of its parts. For the timing table.
//! - `mps2`: QEMU's board mps2-an500, bare metal only; `recording`: closed loops
//!   that make the log, host only.
//! - [`interlocked_session`]: the FRI session of the `bridge` with an interlock, on
//!   any datagram link. For a co-processor without a PC.
//!
//! Each image is also a host program with the same name: `selftest` writes the
//! log, `bench` prints what the target must compute, `arm` shows a run.

#![no_std]

#[cfg(any(test, not(target_os = "none")))]
extern crate std;

pub mod comparison;
pub mod interlock;
pub mod interlocked_controller;
pub mod interlocked_session;
pub mod log;
#[cfg(target_os = "none")]
pub mod mps2;
#[cfg(not(target_os = "none"))]
pub mod recording;
pub mod scenario;
pub mod stages;
pub mod workload;
