//! The arm: parameter tables as constants, the validated model that the algorithms
//! read, its kinematics and its dynamics.
//!
//! Conventions. Frames follow the standard Denavit-Hartenberg table: frame i
//! moves with link i, axis z of frame i - 1 is the axis of joint i, frame 0 is
//! fixed at `base` of the tables. Positions are expressed in
//! the base-plate frame, z up.

mod check;
pub mod dynamics;
mod exchange;
pub mod kinematics;
pub mod limits;
mod link;
mod model;
mod moments;
mod parameters;
mod pose;
#[cfg(test)]
pub(crate) mod test_arm;
mod tool;
mod transform;

pub use check::ArmError;
pub use limits::JointLimits;
pub use link::{Link, LinkFrame, LinkPoint, NamedPoint};
pub use model::ArmModel;
pub(crate) use model::LinkModel;
pub use parameters::{ArmParameters, EndApproach, Friction, LinkParameters};
pub use pose::Pose;
pub(crate) use pose::distortion;
pub use tool::Tool;
