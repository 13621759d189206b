//! What a robot's run was: figures and verdict.

use super::arm::Robot;
use super::control_box::{ControlBox, Figures};
use crate::summary::{Conditions, Summary, Verdict};

impl<B: ControlBox> Robot<B> {
    /// Figures, verdict and link of the run so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let setup = &self.setup;
        let conditions = Conditions {
            plant: setup.plant,
            contacts: setup.contacts,
            measurement: B::MEASUREMENT,
            dead_cycles: setup.plant_options.dead_cycles,
        };
        let (metrics, ending) = (&self.metrics, &self.ending);
        let mut summary = Summary::of(&setup.scenario, &conditions, setup.seed, metrics, ending);
        let alone = "not in command state at the end".to_string();
        let alone = self.ended_alone.then_some(alone);
        if let Some(failure) = alone.or_else(|| self.control_box.failure())
            && !ending.has_begun()
        {
            summary.verdict = Verdict::Fail;
            summary.reason = Some(match summary.reason {
                Some(reason) => format!("{reason}; {failure}"),
                None => failure,
            });
        }
        match self.control_box.figures(self.counters.figures()) {
            Figures::Fri(link) => summary.link = Some(link),
            Figures::Fci(fci) => summary.fci = Some(fci),
        }
        summary
    }
}
