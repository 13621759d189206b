//! What an arm does once its controller has a fault.

use controller_core::joint::{JointState, JointVector};
use controller_core::ranges::RESTING_SPEED;
use serde::Serialize;

/// How long a run goes on after a fault \[s\].
pub const AFTER_FAULT_S: f64 = 0.5;

/// From the cycle of the fault on.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(
    missing_docs,
    reason = "the fields are those of summary.json, described in docs/files.md"
)]
pub struct AfterFault {
    pub t_s: f64,
    pub torque_step_nm: f64,
    pub rest_after_s: Option<f64>,
    pub travel_deg: f64,
    pub mode: &'static str,
}

/// Watches a run from its fault to its end.
pub(crate) struct Watch {
    start: JointVector<f64>,
    seen: AfterFault,
}

impl Watch {
    /// The cycle of the fault: time \[s\], true state, and by how much the torque of a joint
    /// changed most \[Nm\].
    pub fn new(t_s: f64, truth: &JointState<f64>, torque_step_nm: f64) -> Self {
        Self {
            start: truth.q,
            seen: AfterFault {
                t_s,
                torque_step_nm,
                rest_after_s: None,
                travel_deg: 0.0,
                mode: "",
            },
        }
    }

    /// A cycle with a finite state, that of the fault included. The arm rests from the last time on at which it
    /// came to rest.
    pub fn add(&mut self, t_s: f64, truth: &JointState<f64>, mode: &'static str) {
        let seen = &mut self.seen;
        let travel_deg = (truth.q - self.start).amax().to_degrees();
        seen.travel_deg = seen.travel_deg.max(travel_deg);
        let rests = truth.dq.iter().all(|speed| speed.abs() < RESTING_SPEED);
        seen.rest_after_s = match seen.rest_after_s {
            _ if !rests => None,
            None => Some(t_s - seen.t_s),
            since => since,
        };
        seen.mode = mode;
    }

    /// Whether the time is over at `t_s` \[s\].
    pub fn is_over(&self, t_s: f64) -> bool {
        t_s - self.seen.t_s > AFTER_FAULT_S
    }

    pub fn seen(&self) -> AfterFault {
        self.seen
    }
}
