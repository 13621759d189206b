//! The robot's side of the link against a client of a few lines, in this process.

mod client;
mod driving;
mod entry;
mod state;
