//! Tasks and gains that change while the arm moves.

#[path = "transitions/change_run.rs"]
mod change_run;
#[path = "transitions/pose_above_elbow.rs"]
mod pose_above_elbow;
#[path = "transitions/refusals.rs"]
mod refusals;
#[path = "transitions/run.rs"]
mod run;
#[path = "transitions/same_bits.rs"]
mod same_bits;
#[path = "transitions/sequences.rs"]
mod sequences;
#[path = "transitions/stale.rs"]
mod stale;
