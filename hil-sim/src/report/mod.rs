//! Reports: what a run was, whether it passed, and the figures that show why.
//!
//! Bottom-up: [`recording`] keeps the time series of a run, [`Run`] what it was; [`svg`] writes
//! drawings; [`ticks`] finds round numbers for axes; [`plot`] draws line charts
//! of stacked panels; [`scene`] draws paths and arm postures; [`diagram`] the
//! controller as blocks; [`figures`](mod@figures) are those of a run, with those of the limits
//! that it met, and
//! [`html`] binds them with the verdict and the tables into one file.
//!
//! Everything is text built in memory: deterministic, self-contained, no
//! scripts and nothing fetched from a network.

pub mod diagram;
mod figure;
pub mod figures;
pub mod html;
mod limits;
pub mod met;
pub mod palette;
pub mod plot;
pub mod recording;
mod run;
pub mod scene;
mod settings;
pub mod svg;
pub(crate) mod tables;
pub mod ticks;

pub use figures::figures;
pub use html::run_report;
pub use recording::Recording;
pub use run::{Choices, Run, letter};
