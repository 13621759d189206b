//! The paper in one command.
pub mod stability;
