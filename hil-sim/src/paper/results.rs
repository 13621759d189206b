//! What the runs reached.

use std::collections::BTreeMap;

use super::plan::{Family, Planned};
use crate::report::{Recording, Run};
use crate::spread;
use crate::summary::Summary;
use cell::invalid::Invalid;
use cell::scenario::Scenario;
use record::run::Sample;

/// A finished run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its name.
    pub id: String,
    /// What it was.
    pub scenario: Scenario,
    /// What it reached.
    pub summary: Summary,
    /// Its time series; empty but of the first seed.
    pub recording: Recording,
}

impl Outcome {
    /// The run as figures need it.
    #[must_use]
    pub fn run(&self) -> Run<'_> {
        Run::new(&self.summary, &self.scenario, &self.recording)
    }
}

/// All finished runs by name.
#[derive(Clone, Debug, Default)]
pub struct Results(BTreeMap<String, Outcome>);

/// The worst of a family's figures, and the run it is from.
#[derive(Clone, Debug)]
pub struct Worst {
    /// The figure.
    pub value: f64,
    /// Name of the run.
    pub run: String,
}

impl Worst {
    /// How many times that of another family it is.
    #[must_use]
    pub fn over(self, other: &Self) -> Self {
        Self {
            value: self.value / other.value,
            ..self
        }
    }
}

impl Results {
    /// Runs everything, `workers` runs at the same time. `progress` is told how many of all are
    /// done. None where a signal ended it.
    ///
    /// # Errors
    /// A configuration that the core refuses: none for the built-in scenarios.
    pub fn of(
        runs: &[Planned],
        workers: usize,
        progress: impl Fn(usize, usize) + Sync,
    ) -> Result<Option<Self>, Invalid> {
        let outcomes = spread::in_order(runs, workers, progress, execute)?;
        let named = |outcome: Outcome| (outcome.id.clone(), outcome);
        Ok(outcomes.map(|outcomes| Self(outcomes.into_iter().map(named).collect())))
    }

    /// All runs, by name.
    pub fn outcomes(&self) -> impl Iterator<Item = &Outcome> {
        self.0.values()
    }

    /// The run of this name.
    ///
    /// # Panics
    /// If the plan has no such run: an error of this program.
    #[must_use]
    pub fn get(&self, id: &str) -> &Outcome {
        self.0
            .get(id)
            .unwrap_or_else(|| panic!("the plan has no run {id}"))
    }

    /// The first run of a family.
    #[must_use]
    pub fn first(&self, family: Family) -> &Outcome {
        self.get(&family.id(1))
    }

    /// The largest of a figure over the seeds of a family; NaN if a run has none.
    #[must_use]
    pub fn worst(&self, family: Family, figure: impl Fn(&Summary) -> Option<f64>) -> Worst {
        self.extreme(family, figure, |value, worst| value > worst)
    }

    /// The smallest of a figure over the seeds of a family.
    #[must_use]
    pub fn least(&self, family: Family, figure: impl Fn(&Summary) -> Option<f64>) -> Worst {
        self.extreme(family, figure, |value, least| value < least)
    }

    fn extreme(
        &self,
        family: Family,
        figure: impl Fn(&Summary) -> Option<f64>,
        replaces: impl Fn(f64, f64) -> bool,
    ) -> Worst {
        let mut extreme = Worst {
            value: f64::NAN,
            run: family.id(1),
        };
        for seed in family.seeds() {
            let run = family.id(seed);
            let Some(value) = figure(&self.get(&run).summary) else {
                return Worst {
                    value: f64::NAN,
                    run,
                };
            };
            if extreme.value.is_nan() || replaces(value, extreme.value) {
                extreme = Worst { value, run };
            }
        }
        extreme
    }
}

fn execute(run: &Planned) -> Result<Outcome, Invalid> {
    let experiment = &run.experiment;
    let controller = experiment.controller()?;
    let scenario = &experiment.scenario;
    let mut recording = Recording::new(scenario, experiment.contacts);
    let record = |sample: &Sample| {
        if experiment.seed == 1 {
            recording.push(sample);
        }
        Ok(())
    };
    let summary = experiment.run(&controller, record, |_| ());
    let summary = summary.map_err(Invalid::line)?;
    recording.finish();
    Ok(Outcome {
        id: run.id.clone(),
        scenario: scenario.clone(),
        summary,
        recording,
    })
}
