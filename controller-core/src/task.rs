//! Tasks: what the levels track, what they should do, and the rows J, dJ/dt that they
//! make together.

mod axes;
mod decay;
mod followed;
mod level_limits;
pub mod orientation;
pub mod rows;
pub(crate) mod set;
mod target;
pub mod trajectory;

pub use axes::Axes;
pub use followed::Followed;
pub use level_limits::LevelLimits;
pub(crate) use set::{LevelPoint, Levels};
pub use set::{Task, TaskGains, TaskSet, Tracked};
pub use target::{Reference, Target};
