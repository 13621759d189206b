//! What a report is about: a finished run and what was chosen for it.

use super::plot::{Band, Chart, Mark};
use super::recording::Recording;
use crate::experiment::Experiment;
use crate::plant::PlantOptions;
use crate::summary::{CLIENT, Summary, Verdict};
use cell::names::{MeasurementKind, NullStiffness};
use cell::scenario::{Hand, Interval, Push, Scenario};

/// A finished run, as the figures and the report need it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// What it reached.
    pub summary: &'a Summary,
    /// What it was.
    pub scenario: &'a Scenario,
    /// Its time series.
    pub recording: &'a Recording,
    /// What was chosen besides the scenario.
    pub choices: Choices,
    /// The command that repeats it; none: put together from the summary.
    pub command: Option<&'a str>,
}

/// Choices of a run that change what acts, and that its summary does not name.
#[derive(Clone, Copy, Debug)]
pub struct Choices {
    /// Factor on the scenario's null-space stiffness.
    pub null_stiffness: NullStiffness,
    /// How the controller saw the arm.
    pub measurement: MeasurementKind,
    /// What the plant did beyond the reference.
    pub options: PlantOptions,
}

impl Default for Choices {
    fn default() -> Self {
        Self {
            null_stiffness: NullStiffness::Normal,
            measurement: MeasurementKind::Direct,
            options: PlantOptions::default(),
        }
    }
}

impl Choices {
    /// Those of an experiment.
    #[must_use]
    pub fn of(experiment: &Experiment) -> Self {
        Self {
            null_stiffness: experiment.null_stiffness,
            measurement: experiment.way(),
            options: experiment.options,
        }
    }

    /// Whether the null-space damping is c M and not the scenario's D.
    pub(super) fn has_inertia_damping(&self) -> bool {
        let estimated = matches!(
            self.measurement,
            MeasurementKind::LikeFri | MeasurementKind::Fri
        );
        estimated || self.options.dead_cycles > 0
    }
}

impl<'a> Run<'a> {
    /// A run with nothing chosen besides the scenario.
    #[must_use]
    pub fn new(summary: &'a Summary, scenario: &'a Scenario, recording: &'a Recording) -> Self {
        Self {
            summary,
            scenario,
            recording,
            choices: Choices::default(),
            command: None,
        }
    }

    /// The scripted pushes that acted.
    #[must_use]
    pub fn pushes(&self) -> &'a [Push] {
        if self.summary.contacts {
            &self.scenario.pushes
        } else {
            &[]
        }
    }

    /// The hands that acted.
    #[must_use]
    pub fn hands(&self) -> &'a [Hand] {
        if self.summary.contacts {
            &self.scenario.hands
        } else {
            &[]
        }
    }

    /// Whether a client on the robot link controlled the arm: its gains are unknown.
    #[must_use]
    pub fn by_client(&self) -> bool {
        self.summary.controller == CLIENT
    }

    /// Whether the run came as far as `t_s`: a stopped one to its last cycle.
    #[must_use]
    pub fn reached(&self, t_s: f64) -> bool {
        match self.summary.verdict {
            Verdict::Stopped => self.recording.t().last().is_some_and(|&end| t_s <= end),
            _ => t_s < self.scenario.duration_s,
        }
    }

    /// When someone or something touched the arm: the pushes, then the hands,
    /// lettered in this order, as far as the run came.
    #[must_use]
    pub fn bands(&self) -> Vec<Band> {
        let pushes = self.pushes().iter().map(Push::interval);
        let intervals = pushes
            .chain(self.hands().iter().map(Hand::interval))
            .enumerate();
        intervals
            .filter(|(_, interval)| self.reached(interval.from_s))
            .map(|(index, Interval { from_s, to_s, .. })| Band {
                from: from_s,
                to: to_s,
                label: letter(index),
            })
            .collect()
    }

    /// When tasks and gains changed, numbered in the order of the scenario, as far as the run came.
    #[must_use]
    pub fn changes(&self) -> Vec<Band> {
        let events = (1..).zip(&self.scenario.events);
        events
            .filter(|(_, event)| self.reached(event.at_s()))
            .map(|(number, event)| Band {
                from: event.at_s(),
                to: event.ends_s(),
                label: number.to_string(),
            })
            .collect()
    }

    /// A chart without panels over the whole time of the run, with its contacts and the
    /// changes of its tasks, and where it was stopped.
    #[must_use]
    pub fn chart(&self, id: &str, title: impl Into<String>, description: &str) -> Chart {
        let mut chart = Chart::over_time(id, title, description);
        chart.x_range = Some([0.0, self.scenario.duration_s]);
        chart.bands = self.bands();
        chart.bands.extend(self.changes());
        if self.summary.verdict == Verdict::Stopped
            && let Some(&at) = self.recording.t().last()
        {
            let label = format!("stopped at {at:.2} s");
            chart.marks.push(Mark { at, label });
        }
        chart
    }

    /// "two-level, hierarchical, realistic plant, seed 1".
    #[must_use]
    pub fn label(&self) -> String {
        let Summary {
            scenario,
            controller,
            plant,
            seed,
            ..
        } = self.summary;
        format!("{scenario}, {controller}, {plant} plant, seed {seed}")
    }
}

/// Letters that number contacts: A to Z, then AA, AB and so on.
#[must_use]
pub fn letter(index: usize) -> String {
    let mut letters = Vec::new();
    let mut rest = index + 1;
    while rest > 0 {
        rest -= 1;
        letters.push(char::from(b'A' + (rest % 26) as u8));
        rest /= 26;
    }
    letters.iter().rev().collect()
}

#[cfg(test)]
mod tests {
    use super::letter;

    #[test]
    fn letters_go_on_after_z() {
        let known = [
            (0, "A"),
            (25, "Z"),
            (26, "AA"),
            (51, "AZ"),
            (52, "BA"),
            (702, "AAA"),
        ];
        for (index, name) in known {
            assert_eq!(letter(index), name);
        }
    }
}
