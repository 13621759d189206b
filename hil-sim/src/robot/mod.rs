//! The robot's side of the LWR FRI: an arm, its controller, and what they report.
//!
//! A [`Robot`] is driven cycle by cycle and passes byte arrays, so that a
//! datagram socket and a client in the same process see exactly the same:
//!
//! ```text
//! loop {
//!     robot.measurement(&mut msr);       // cycle n, at t_n
//!     // ... the client's answers, in the order in which they arrive:
//!     robot.command(&cmd, since_t_n);
//!     robot.advance();                   // the newest command acts from t_n to t_n+1
//! }
//! ```
//!
//! An answer to the measurement of cycle n that arrives before the next one acts
//! in cycle n: there is no dead time. Dead cycles of the plant's options delay
//! the added torque; the robot's own gravity, springs and dampers act at once.
//!
//! Scenario time 0 is `settle_s` (1 s) after the cycle whose measurement first said
//! command state. References and q_d start from the position of that measurement,
//! as the binary32 numbers that the client saw. From time 0 on contacts act and
//! figures count; losing command state does not stop that clock.

mod driving;
mod figures;
mod model;
mod options;
mod rating;

pub use figures::{Event, LatencyFigures, LinkFigures, QualityCycles, Rejected, StateCycles};
pub use options::{Krl, RatingOptions, RobotAdds, RobotOptions, Scheme};
pub use rating::{Quality, Rating, Statistics};

use crate::experiment::Instant;
use crate::plant::{PlantKind, PlantOptions};
use crate::scenario::Scenario;
use crate::summary::Summary;

/// Bytes of a measurement datagram.
pub const MEASUREMENT_BYTES: usize = 916;

/// Which arm, which experiment, and how the robot behaves.
#[derive(Clone, Debug)]
pub struct RobotSetup {
    /// What is to be done: start, contacts, what is judged.
    pub scenario: Scenario,
    /// The arm.
    pub plant: PlantKind,
    /// Whether the scripted contacts act.
    pub contacts: bool,
    /// Seed of mismatch and noise.
    pub seed: u64,
    /// What the plant does beyond the reference.
    pub plant_options: PlantOptions,
    /// The robot's behaviour.
    pub options: RobotOptions,
}

/// What became of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The newest: it acts.
    Accepted,
    /// Seen before, or to a cycle that has its answer: no effect.
    Repeated,
    /// Older than one already accepted: no effect.
    Old,
    /// Not usable: no effect.
    Rejected,
}

/// A robot with its controller.
pub struct Robot {
    setup: RobotSetup,
}

impl Robot {
    /// A robot at rest in the scenario's start posture, in monitor state.
    #[must_use]
    pub fn new(setup: RobotSetup) -> Self {
        Self { setup }
    }

    /// The measurement of this cycle. Each call is a datagram of its own with the
    /// next counter; a cycle may send several.
    pub fn measurement(&mut self, out: &mut [u8; MEASUREMENT_BYTES]) {
        out.fill(0);
    }

    /// An answer has arrived, `since_cycle_start_s` \[s\] after this cycle's
    /// measurement. Its latency is that plus the cycles since the measurement
    /// which it answers. One that is not accepted has no effect but on counters.
    pub fn command(&mut self, datagram: &[u8], since_cycle_start_s: f64) -> Answer {
        let _ = (datagram, since_cycle_start_s);
        Answer::Rejected
    }

    /// Ends the cycle: rates the link, moves the arm. What the cycle was, if
    /// scenario time runs. Before the first answer nothing moves and no time passes.
    pub fn advance(&mut self) -> Option<Instant<'_>> {
        None
    }

    /// Scenario time of the coming cycle \[s\]; none before command state.
    #[must_use]
    pub fn time_s(&self) -> Option<f64> {
        None
    }

    /// Whether the scenario is over, or safety stopped it.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        false
    }

    /// Leaves command state for good; measurements say monitor from now on.
    pub fn leave(&mut self) {}

    /// Figures, verdict and link of the run so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let _ = &self.setup;
        unimplemented!()
    }
}
