//! The cycle: what enters it and when it is believed, its stages as one list, every
//! result as data, what comes out.

mod brake;
pub mod config;
mod construction;
mod controller;
mod data;
pub mod delay;
mod inspection;
pub mod measurement;
pub mod observer;
pub mod record;
pub mod stages;
mod step;
pub(crate) mod usable;
pub mod velocity;

pub use construction::MakeController;
pub use controller::Controller;
pub use data::{Data, Input, State};
pub use inspection::Inspection;
pub use step::Step;
