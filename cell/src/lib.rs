//! What both programs read and say: `hil-sim`, the robot's side, and `firmware-host`, the
//! controller's. A cell is a robot with its job; here it is data. Nothing is simulated.
//!
//! Bottom-up: [`invalid`], errors for people; [`terminal`], what is printed;
//! [`ranges`], what may be asked for; [`names`], choices with a name; [`arguments`], values of
//! options and usage errors; [`mod@file`] and [`reader`], texts and what they say; [`keys`], what
//! keys of files are; [`arm`], an arm as a file; [`model`], an arm as a URDF; [`scenario`], an
//! experiment as a file. Beside them, of a program that has to keep a cycle:
//! [`realtime`], what the system gives it, and [`timing`], how long things took.

pub mod arguments;
pub mod arm;
pub mod document;
pub mod file;
pub mod invalid;
pub mod keys;
pub mod model;
pub mod names;
pub mod ranges;
pub mod reader;
pub mod realtime;
pub mod scenario;
pub mod terminal;
pub mod timing;
