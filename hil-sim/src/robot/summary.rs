//! What a robot's run was: figures and verdict.

use super::arm::Robot;
use crate::metrics::FaultCounts;
use crate::summary::{self, Conditions, Summary, Verdict};
use cell::names::{MeasurementKind, Named};

impl Robot {
    /// Figures, verdict and link of the run so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let setup = &self.setup;
        let scenario = &setup.scenario;
        let levels = self.metrics.levels(&scenario.levels);
        let conditions = Conditions {
            plant: setup.plant,
            contacts: setup.contacts,
            measurement: MeasurementKind::Fri,
            dead_cycles: setup.plant_options.dead_cycles,
        };
        let acceptance = summary::judge(scenario, &conditions, &levels);
        let (verdict, reason) = match &self.stop {
            Some(stop) => (Verdict::Stopped, Some(stop.to_string())),
            None => match summary::verdict(&acceptance) {
                (_, reason) if self.ended_in_monitor => {
                    let lost = "not in command state at the end".to_string();
                    let all = reason.map_or(lost.clone(), |reason| format!("{reason}; {lost}"));
                    (Verdict::Fail, Some(all))
                }
                judged => judged,
            },
        };
        Summary {
            scenario: scenario.name.clone(),
            controller: summary::CLIENT,
            plant: setup.plant.name(),
            contacts: setup.contacts,
            seed: setup.seed,
            cycle_ms: scenario.cycle_ms,
            duration_s: scenario.duration_s,
            cycles: self.metrics.cycles(),
            verdict,
            reason,
            acceptance,
            levels,
            residual: self.metrics.residual(),
            torque: self.metrics.torque(),
            joints: self.metrics.joints(),
            hand_force_max_n: self.contacts.has_hands().then(|| self.metrics.hand_force()),
            limits: self.metrics.limits(),
            faults: FaultCounts::default(),
            link: Some(self.counters.figures(&self.krc, &self.rating)),
        }
    }
}
