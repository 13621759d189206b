//! Tasks: what the levels track, what they should do, and the rows J, dJ/dt that they
//! make together.

mod axes;
pub mod orientation;
pub mod rows;
mod set;
mod target;
pub mod trajectory;

pub use axes::Axes;
pub(crate) use set::{LevelPoint, Levels};
pub use set::{Task, TaskGains, TaskSet, Tracked};
pub(crate) use target::HeldPlaces;
pub use target::{Reference, Target};
