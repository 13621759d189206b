//! What both programs read and say: `hil-sim`, the robot's side, and `firmware-host`, the
//! controller's. A cell is a robot with its job; here it is data. Nothing is simulated.
//!
//! Bottom-up: [`invalid`], errors for people; [`terminal`], what is printed;
//! [`ranges`], what may be asked for; [`names`], choices with a name; [`arguments`], values of
//! options and usage errors; [`mod@file`] and [`reader`], texts and what they say;
//! [`scenario`], an experiment as a file.

pub mod arguments;
pub mod file;
pub mod invalid;
pub mod names;
pub mod ranges;
pub mod reader;
pub mod scenario;
pub mod terminal;
