//! Tasks: what the levels track, what they should do, and the rows J, dJ/dt that they
//! make together.

mod axes;
mod decay;
mod filters;
mod followed;
pub(crate) mod level;
mod level_limits;
pub mod orientation;
pub mod rows;
mod set;
mod target;
pub mod trajectory;

pub use axes::Axes;
pub use followed::Followed;
pub(crate) use level::{LevelPoint, Levels};
pub use level_limits::LevelLimits;
pub use set::{Task, TaskGains, TaskSet, Tracked};
pub use target::{Reference, Target};
