//! The robot's side of the loop on a PC: plant, contacts, experiments, reports.
//!
//! Bottom-up: [`plant`] is an arm that knows nothing of the controller;
//! [`contact`] pushes it; [`scenario`] is an experiment as data;
//! [`experiment`] closes the loop around `controller-core` with one of the
//! [`controllers`]; [`metrics`], [`trace`] and [`summary`] say what happened;
//! [`explain`] lays one cycle open; [`cli`] is the program.

pub mod cli;
pub mod contact;
pub mod controllers;
pub mod experiment;
pub mod explain;
pub mod invalid;
pub mod link;
pub mod loopback;
pub mod metrics;
pub mod names;
pub mod output;
pub mod paper;
pub mod plant;
pub mod report;
mod reworded;
pub mod robot;
pub mod scenario;
pub mod serve;
pub mod summary;
pub mod terminal;
pub mod trace;
