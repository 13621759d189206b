//! The robot with Franka's interface: its model, its arm, its sockets.

mod arm;
mod client;
mod measurement;
mod model;
mod sockets;
