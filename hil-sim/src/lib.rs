//! The robot's side of the loop on a PC: plant, contacts, experiments, reports.
//!
//! An experiment as data, errors and choices are in the crate `cell`, what is recorded of a
//! cycle in the crate `record`: the controller's program has them too. Bottom-up:
//!
//! - [`plant`]: an arm that knows nothing of the controller; [`arm_points`]: where its points
//!   and links are; [`contact`]: what pushes it;
//! - [`controllers`]: the laws that are compared;
//! - [`sample`]: what is looked at in a cycle, and why a run is ended; [`interrupt`]: by a
//!   signal; [`spread`]: many runs on all processors; [`metrics`], [`after_fault`] and [`summary`]: figures and verdict;
//! - [`robot`]: the robot controller of the FRI link; [`link`]: what may happen to datagrams;
//! - [`experiment`]: the loop around `controller-core` with one of the laws; [`loopback`]: the
//!   same through datagrams, robot and bridge in one process; [`explain`]: one cycle laid open;
//! - [`output`], [`trace`], [`report`]: the files of a run; [`paper`]: every experiment and
//!   claim of the paper; [`study`]: many runs near and beyond limits;
//! - [`model`]: arms of others, from a URDF; what an arm is like; [`gains`]: gains for one;
//! - [`serve`]: the robot on a socket or a serial line; [`cli`]: the program.

pub mod after_fault;
pub mod arm_points;
pub mod cli;
pub mod contact;
pub mod controllers;
pub mod experiment;
pub mod explain;
pub mod gains;
pub mod interrupt;
pub mod limit_events;
pub mod link;
pub mod loopback;
pub mod metrics;
pub mod model;
pub mod output;
pub mod paper;
pub mod plant;
pub mod report;
pub mod robot;
pub mod sample;
pub mod serve;
pub mod spread;
pub mod study;
pub mod summary;
pub mod trace;
