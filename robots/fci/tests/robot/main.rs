//! The robot's end, course by course: what the state shows and what replies say.

mod bench;
mod connection;
mod courses;
mod limits;
mod setters;
