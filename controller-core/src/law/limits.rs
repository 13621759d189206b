//! The law within limits: the hierarchy where directions get lost, joints come near the ends of
//! their ranges, and levels ask for more than there is. docs/limits.md says what it does,
//! docs/hierarchy.md derives it. Where nothing is at a limit it is the exact law, term by term.
//!
//! In the order of a cycle:
//!
//! ```text
//! spectrum    A_i = J_i L^-T, what the levels above leave of it, its directions and mobilities z
//! motion      dq split by the spectrum: n, w, F
//! way out     of an arm that is straight: what bends it, through the null space
//! wish        what levels and null space ask for, scaled to what joints can do: a*
//! bounds      lo <= a <= hi of every joint, from its range and its speed limit
//! projection  a: the nearest to a* within the bounds, nearest for the upper levels first
//! ```

mod asked;
pub mod bounds;
mod eigen;
pub mod memory;
pub mod motion;
pub mod projection;
mod rule;
pub mod spectrum;
mod tableau;
pub mod way_out;
pub mod wish;

pub use rule::{joint_limits, own_joint_limits};
