//! The command line as both programs read it.

pub mod usage;
pub mod values;
