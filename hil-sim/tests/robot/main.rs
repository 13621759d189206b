//! The robot's side of the link against a client of a few lines, in this process.

mod client;
mod closed;
mod driving;
mod entry;
mod state;
