//! x
pub mod plant;
