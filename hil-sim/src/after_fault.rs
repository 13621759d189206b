//! The end of a run before its time, and what the arm does until then.

use controller_core::Fault;
use controller_core::fault::Mode;
use controller_core::joint::{JointState, JointVector};
use controller_core::ranges::{MOVING_SPEED, RESTING_SPEED};
use serde::Serialize;

use crate::sample::{Stop, UnsafeMotion};

/// How long a run goes on after a fault \[s\].
pub const AFTER_FAULT_S: f64 = 0.5;

/// From the cycle of the fault, or of the unsafe motion, on.
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
    pub mode: Option<&'static str>,
}

/// What acts in a cycle, and what the controller says of itself.
pub(crate) struct Acting {
    /// Torque of the motors \[Nm\].
    pub torque: JointVector<f64>,
    /// The latched fault.
    pub fault: Option<Fault>,
    /// None of a controller that does not tell.
    pub mode: Option<Mode>,
}

/// Whether and why a run ends before its time. A fault or an unsafe speed ends it after
/// [`AFTER_FAULT_S`], in which the arm is braked and watched; all else at once.
pub(crate) struct Ending {
    cycle_s: f64,
    stop: Option<Stop>,
    watch: Option<Watch>,
    over: bool,
    last_torque: Option<JointVector<f64>>,
}

impl Ending {
    /// Of a run in cycles of `cycle_s` \[s\] that has no reason to end.
    pub fn new(cycle_s: f64) -> Self {
        Self {
            cycle_s,
            stop: None,
            watch: None,
            over: false,
            last_torque: None,
        }
    }

    /// Nothing can act on the arm any more, or nobody wants to.
    pub fn at_once(&mut self, stop: Stop) {
        self.stop.get_or_insert(stop);
        self.over = true;
    }

    /// A cycle at `t_s` \[s\]. `truth` is finite; where it is unsafe, the fault that the
    /// controller makes of it is not the reason.
    pub fn cycle(
        &mut self,
        t_s: f64,
        truth: &JointState<f64>,
        unsafe_motion: Option<UnsafeMotion>,
        acting: &Acting,
    ) {
        let trouble = unsafe_motion.map(Stop::Unsafe);
        self.stop = (self.stop).or(trouble).or(acting.fault.map(Stop::Fault));
        let last = self.last_torque.replace(acting.torque);
        if self.stop.is_none() {
            return;
        }
        let watch = self.watch.get_or_insert_with(|| Watch::new(t_s, truth));
        let since_s = watch.cycles as f64 * self.cycle_s;
        let change = acting.torque - last.unwrap_or(acting.torque);
        watch.add(since_s, truth, change.amax(), acting.mode);
        self.over |= watch.cycles as f64 * self.cycle_s > AFTER_FAULT_S;
    }

    /// Whether the run has a reason to end: its cycles are no longer in the figures.
    pub fn has_begun(&self) -> bool {
        self.stop.is_some()
    }

    /// Whether the run has ended.
    pub fn is_over(&self) -> bool {
        self.over
    }

    pub fn stop(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }

    pub fn seen(&self) -> Option<AfterFault> {
        self.watch.as_ref().map(|watch| watch.seen)
    }
}

/// Watches the arm to the end of a run.
struct Watch {
    start: JointVector<f64>,
    cycles: u32,
    seen: AfterFault,
}

impl Watch {
    fn new(t_s: f64, truth: &JointState<f64>) -> Self {
        Self {
            start: truth.q,
            cycles: 0,
            seen: AfterFault {
                t_s,
                torque_step_nm: 0.0,
                rest_after_s: None,
                travel_deg: 0.0,
                mode: None,
            },
        }
    }

    /// A cycle, that of the fault included, `since_s` \[s\] after it. As in the controller,
    /// an arm that rests moves again above another speed: noise of the torque is no motion.
    fn add(
        &mut self,
        since_s: f64,
        truth: &JointState<f64>,
        torque_step_nm: f64,
        mode: Option<Mode>,
    ) {
        self.cycles += 1;
        let seen = &mut self.seen;
        seen.torque_step_nm = seen.torque_step_nm.max(torque_step_nm);
        let travel_deg = (truth.q - self.start).amax().to_degrees();
        seen.travel_deg = seen.travel_deg.max(travel_deg);
        let fastest = truth.dq.amax();
        seen.rest_after_s = match seen.rest_after_s {
            None => (fastest < RESTING_SPEED).then_some(since_s),
            since => since.filter(|_| fastest < MOVING_SPEED),
        };
        seen.mode = mode.map(Mode::name);
    }
}
