//! The robot's side of the loop on a PC: plant, contacts, experiments, reports.
//!
//! Bottom-up: [`plant`] is an arm that knows nothing of the controller;
//! [`contact`] pushes it; [`scenario`] is an experiment as data;
//! [`experiment`] closes the loop around `controller-core` with one of the
//! [`controllers`]; [`metrics`], [`trace`] and [`summary`] say what happened;
//! [`explain`] lays one cycle open; [`cli`] is the program.

pub mod arm_points;
pub mod cli;
pub mod contact;
pub mod controllers;
pub mod experiment;
pub mod explain;
pub mod link;
pub mod loopback;
pub mod metrics;
pub mod output;
pub mod paper;
pub mod plant;
pub mod report;
pub mod robot;
pub mod sample;
pub mod serve;
pub mod summary;
pub mod trace;
