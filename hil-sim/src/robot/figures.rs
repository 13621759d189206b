//! What the arm's side of every robot counts of a run.

use serde::Serialize;

/// Most events that are kept.
pub const EVENTS_MAX: usize = 200;

/// Something worth knowing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// Scenario time \[s\]; null before it runs.
    pub t_s: Option<f64>,
    /// Robot time \[s\]: 0 is the first cycle.
    pub robot_t_s: f64,
    /// One line.
    pub text: String,
}

/// Cycles per state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StateCycles {
    /// In which the robot moved or held the arm itself.
    pub monitor: u64,
    /// In which answers moved it.
    pub command: u64,
}

/// Time from a measurement to its answer, of all answers \[ms\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LatencyFigures {
    /// Mean.
    pub mean: Option<f64>,
    /// Largest.
    pub max: Option<f64>,
}

/// Who says when an answer has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stamp {
    /// The kernel, whenever the program reads it.
    Kernel,
    /// The program, when it reads it: its own late wake-ups count as the client's.
    Program,
}

impl Stamp {
    /// As in summary.json.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Kernel => "kernel",
            Self::Program => "program",
        }
    }
}

/// How the robot itself kept the wall clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OwnLateness {
    /// Cycles whose measurement left more than `bound_ms` after its time.
    pub cycles: u64,
    /// A tenth of the cycle \[ms\].
    pub bound_ms: f64,
    /// How late the measurements left \[ms\]: 99.9 % of them by less.
    pub p999_ms: f64,
    /// The latest \[ms\].
    pub max_ms: f64,
    /// Who says when answers arrived.
    pub stamp: Stamp,
}

/// What is counted whichever robot it is, from the first answer to the end of the run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counted {
    /// Cycles per state.
    pub state_cycles: StateCycles,
    /// Share of the cycles of the scenario in command state.
    pub command_share: Option<f64>,
    /// Answers that were accepted.
    pub answers: u64,
    /// Accepted answers that came after their cycle.
    pub late: u64,
    /// Latency.
    pub latency_ms: LatencyFigures,
    /// Standard deviation of the latency \[ms\].
    pub jitter_ms: Option<f64>,
    /// Largest change of a joint's torque from one cycle to the next while the robot bridged a
    /// missing answer or changed its way of driving, without what the client ordered \[Nm\].
    pub largest_torque_step_nm: f64,
    /// The robot's own lateness; none in virtual time.
    pub own_lateness: Option<OwnLateness>,
    /// What happened, the first 200 events.
    pub events: Vec<Event>,
}
