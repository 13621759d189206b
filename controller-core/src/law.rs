//! The control law: all priorities from one factorisation, the motion split into task
//! and null-space parts, what is commanded, the torque demanded, the torque allowed.

pub mod allocation;
pub mod control;
pub mod gain_bound;
pub mod hierarchy;
pub mod limits;
pub mod motion;
pub mod null_space;
pub mod sampling;
pub mod views;
