//! The robot with Franka's interface: its model, its arm, its sockets.

mod arm;
mod client;
mod model;
mod sockets;
