#![no_std]
//! x
pub mod config;
pub mod controller;
pub mod damping;
pub mod dynamics;
pub mod fault;
pub mod hierarchy;
pub mod joint;
pub mod kinematics;
pub mod law;
pub mod limits;
pub mod linalg;
pub mod measurement;
pub mod model;
pub mod observer;
pub mod real;
pub mod record;
mod spatial;
pub mod task;
pub mod trajectory;
