//! The law within limits, against the exact law where nothing is at a limit, and piece by piece
//! against what defines the pieces.

#[path = "limits/clear_runs.rs"]
mod clear_runs;
#[path = "limits/equality.rs"]
mod equality;
#[path = "limits/projection.rs"]
mod projection;
#[path = "limits/rule.rs"]
mod rule;
#[path = "limits/way_out.rs"]
mod way_out;
