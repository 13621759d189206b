//! Arms of one's own: a table as a file. [`mod@file`] reads it, [`text`] writes it, [`robot`] finds
//! the arm that a scenario names, in the crate `arms` or in a file.

pub mod file;
pub mod joint;
pub mod joint_limits;
pub mod pose;
pub mod robot;
pub mod text;
