//! The controller core on a PC, linked to a robot by KUKA's FRI or the Franka Control Interface.
//!
//! All that is here is around the conversation, which is in the `bridge` crate. Scenario
//! files, scheduling and histograms are those of `cell`, rows of a record those of `record`; no simulator is linked.
//!
//! - [`cli`]: the command line;
//! - [`run`]: the socket loop of an LWR: one datagram in, one out; [`peer`]: whom it answers;
//! - [`mod@fci`]: a Franka robot: its sockets, its model;
//! - [`recorder`]: every cycle to a file, without blocking the loop;
//! - [`changes`]: changes of tasks and gains, over UDP or typed;
//! - [`stream`]: references that arrive over UDP;
//! - [`summary`]: what a run was;
//! - [`doctor`]: can this PC hold the cycle?
//!
//! docs/fri.md leads from a fresh PC to a moving robot.

pub mod changes;
pub mod cli;
pub mod doctor;
pub mod fci;
pub mod peer;
pub mod recorder;
pub mod run;
pub mod stream;
pub mod summary;
