//! What a robot with the FCI did in a run: the part `fci` of summary.json.

use cell::realtime::Realtime;
use serde::Serialize;

use crate::robot::figures::{Event, OwnLateness};

/// Figures of the interface, from the connection to the end of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FciFigures {
    /// Version of the interface.
    pub version: u16,
    /// Motions that have begun.
    pub motions: u64,
    /// Those of them that a reflex has aborted.
    pub reflexes: u64,
    /// Errors that have aborted motions, by the vendor's names.
    pub errors: Vec<&'static str>,
    /// Share of the cycles of the scenario in which the client's torque acted.
    pub command_share: Option<f64>,
    /// Commands that came in time.
    pub commands: u64,
    /// Cycles of motions, behind the first command, without one.
    pub lost: u64,
    /// Least `control_command_success_rate` from 100 cycles behind the first command of a motion on.
    pub success_rate_min: Option<f64>,
    /// Commands to an older state, or to one that was not sent.
    pub late: u64,
    /// Commands to a state that had one.
    pub repeated: u64,
    /// Datagrams while no motion ran.
    pub idle: u64,
    /// Datagrams that cannot be used.
    pub unreadable: u64,
    /// Largest change of a joint's commanded torque in a cycle \[Nm\].
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
