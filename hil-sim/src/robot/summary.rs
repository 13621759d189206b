//! What a robot's run was: figures and verdict.

use super::arm::Robot;
use super::control_box::ControlBox;
use crate::summary::{Conditions, Summary, Verdict};
use cell::names::MeasurementKind;

impl<B: ControlBox> Robot<B> {
    /// Figures, verdict and link of the run so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let setup = &self.setup;
        let conditions = Conditions {
            plant: setup.plant,
            contacts: setup.contacts,
            measurement: MeasurementKind::Fri,
            dead_cycles: setup.plant_options.dead_cycles,
        };
        let (metrics, ending) = (&self.metrics, &self.ending);
        let mut summary = Summary::of(&setup.scenario, &conditions, setup.seed, metrics, ending);
        if self.ended_alone && !ending.has_begun() {
            let lost = "not in command state at the end".to_string();
            summary.verdict = Verdict::Fail;
            summary.reason = Some(match summary.reason {
                Some(reason) => format!("{reason}; {lost}"),
                None => lost,
            });
        }
        summary.link = Some(self.control_box.figures(self.counters.figures()));
        summary
    }
}
