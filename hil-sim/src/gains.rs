//! Gains for an arm and a cycle: what a scenario file needs, and what limits each
//! (docs/gains.md).
//!
//! Bottom-up: [`matrix`], of any size; [`sampled`], the loop as a matrix; [`link`], what is between
//! law and arm; [`kind`], what a level asks of the joints; [`near_rest`], the core's law as a
//! matrix; [`bounds`] of the bandwidth; [`null_space`], its compliance; [`workspace`], the whole
//! loop in many postures; [`text`], a proposal as TOML.

pub mod bounds;
pub mod kind;
pub mod link;
pub mod matrix;
pub mod near_rest;
pub mod null_space;
pub mod proposal;
pub mod sampled;
pub mod text;
pub mod workspace;
