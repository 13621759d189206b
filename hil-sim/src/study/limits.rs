//! The law near and beyond what an arm can do: hundreds of runs, and the table of what it keeps.
//! docs/limits-study.md describes the runs and the figures.
//!
//! - [`parameters`]: what is drawn for a run; [`case`](mod@case): a run as data; [`set`]: the sets of runs;
//! - [`ground`]: what an arm can reach; [`passes`], [`wrist`], [`random`], [`push`], [`saturation`],
//!   [`straight`], [`ordered`]: the runs; [`import`]: runs from files;
//! - [`run`]: one run in the closed loop; [`outcome`]: its figures; [`truth`]: where levels really
//!   are;
//! - [`acceptance`]: what must hold; [`table`]: figures and acceptance for people; [`published`]:
//!   the tables of the document; [`jobs`]: all runs.

pub mod acceptance;
pub mod case;
pub mod ground;
pub mod import;
pub mod jobs;
pub mod ordered;
pub mod outcome;
pub mod parameters;
pub mod passes;
pub mod published;
pub mod push;
pub mod random;
pub mod run;
pub mod saturation;
pub mod set;
pub mod straight;
pub mod table;
pub mod truth;
pub mod wrist;
