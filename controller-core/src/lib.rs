#![no_std]
//! x
pub mod joint;
pub mod model;
pub mod real;
