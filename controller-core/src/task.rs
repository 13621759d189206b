//! Tasks: what the levels track, what they should do, and the rows J, dJ/dt that they
//! make together.

mod axes;
mod decay;
mod filters;
mod followed;
pub(crate) mod level;
mod level_limits;
mod order;
pub mod orientation;
pub mod rows;
mod set;
mod target;
pub mod trajectory;

pub use axes::Axes;
pub(crate) use decay::{Clock, smoothstep};
pub(crate) use filters::LevelGains;
pub use followed::Followed;
pub(crate) use level::{Level, LevelPoint, Levels, gains_on};
pub use level_limits::LevelLimits;
pub use order::Order;
pub use set::{AfterStale, Capacity, Stale, Task, TaskGains, TaskSet, Tracked};
pub use target::{Reference, Target};
