//! What the link of an LWR did in a run: the part `link` of summary.json.

use cell::realtime::Realtime;
use serde::Serialize;

use crate::robot::figures::{Event, LatencyFigures, OwnLateness, StateCycles};

/// Cycles per quality level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the levels of `Quality`")]
pub struct QualityCycles {
    pub unacceptable: u64,
    pub bad: u64,
    pub ok: u64,
    pub perfect: u64,
}

/// Datagrams that were not used, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Rejected {
    /// Not 376 bytes.
    pub length: u64,
    /// Another datagram id or size field.
    pub header: u64,
    /// A number that is not finite where a finite one is needed.
    pub not_finite: u64,
    /// Reflects no datagram that was sent.
    pub reflection: u64,
    /// jntPos jumps.
    pub jump: u64,
    /// addJntTrq is more than twice the joint's limit.
    pub torque: u64,
    /// cmdFlags differ from those at the beginning of command state.
    pub flags: u64,
}

impl Rejected {
    /// All together.
    #[must_use]
    pub fn total(&self) -> u64 {
        let unread = self.length + self.header + self.not_finite + self.reflection;
        unread + self.jump + self.torque + self.flags
    }
}

/// Figures of the link, from the first answer to the end of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LinkFigures {
    /// Cycles per state.
    pub state_cycles: StateCycles,
    /// Share of the cycles of the scenario in command state.
    pub command_share: Option<f64>,
    /// Cycles per quality level.
    pub quality_cycles: QualityCycles,
    /// Answers that were accepted.
    pub answers: u64,
    /// Cycles without answer in time.
    pub missed: u64,
    /// Accepted answers that came after their cycle.
    pub late: u64,
    /// Datagrams that were not used.
    pub rejected: Rejected,
    /// Answers that never came, by the client's counter.
    pub lost: u64,
    /// Answers that came more than once, or to a cycle already answered.
    pub repeated: u64,
    /// Answers older than one already accepted.
    pub old: u64,
    /// Latency.
    pub latency_ms: LatencyFigures,
    /// Standard deviation of the latency \[ms\].
    pub jitter_ms: Option<f64>,
    /// How often command state was lost.
    pub fallbacks: u64,
    /// How often it was reached again.
    pub recoveries: u64,
    /// Largest change of a joint's torque from one cycle to the next while the
    /// robot bridged a missing answer or changed its way of driving, without what
    /// the client ordered \[Nm\].
    pub largest_torque_step_nm: f64,
    /// The robot's own lateness, which is not the client's; none in virtual time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_lateness: Option<OwnLateness>,
    /// What the system gave to the robot; none in virtual time, which needs nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub realtime: Option<Realtime>,
    /// What happened, at most 200 of them.
    pub events: Vec<Event>,
}
