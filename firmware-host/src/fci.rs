//! A Franka robot over TCP and UDP: the sockets, and its own model against the table.
//!
//! - [`link`]: the sockets around the client's machine of the crate `fci`;
//! - [`load`]: the tool of the scenario as the robot's load;
//! - [`model`]: the URDF that the robot gives, against the arm of the scenario.

pub mod link;
pub mod load;
pub mod model;
