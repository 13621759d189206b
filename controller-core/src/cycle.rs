//! The cycle: what enters it and when it is believed, its stages as one list, every
//! result as data, what comes out.

mod brake;
mod change_error;
pub mod config;
mod construction;
mod controller;
mod data;
pub mod delay;
mod inspection;
pub mod measurement;
pub mod observer;
pub mod parts;
pub mod record;
pub mod stages;
mod step;
mod tasks;
mod transition;
pub(crate) mod usable;
pub mod velocity;

pub use change_error::ChangeError;
pub use construction::MakeController;
pub(crate) use construction::check_exact_rows;
pub use controller::Controller;
pub use data::{Data, Input, State};
pub use inspection::Inspection;
pub use step::Step;
pub use tasks::ActiveTasks;
pub use transition::{Change, Transition};
