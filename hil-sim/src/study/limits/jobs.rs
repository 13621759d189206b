//! All runs of a study, on several processors.

use std::path::PathBuf;

use cell::invalid::Invalid;
use cell::names::PlantKind;
use cell::scenario::EquippedArm;
use serde::Serialize;

use super::case::Case;
use super::ground::Ground;
use super::import;
use super::outcome::Outcome;
use super::run::{self, Conditions, Law, Precision};
use super::set::Set;
use crate::spread;

/// What is to be run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The arm.
    pub arm: EquippedArm,
    /// As it is simulated.
    pub plant: PlantKind,
    /// Of the controller.
    pub precision: Precision,
    /// Which laws.
    pub laws: Vec<Law>,
    /// Which sets.
    pub sets: Vec<Set>,
    /// Runs of each set, from its first on; none: all that it has.
    pub runs: Option<usize>,
    /// Runs at the same time.
    pub jobs: usize,
    /// The folder that runs are read from; none: they are drawn.
    pub from: Option<PathBuf>,
}

/// What the runs of a set reached.
#[derive(Clone, Debug, Serialize)]
pub struct SetOutcome {
    /// The set.
    #[serde(serialize_with = "by_name")]
    pub set: Set,
    /// By the exact law; empty where it was not asked for.
    pub exact: Vec<Outcome>,
    /// By the law within limits; likewise.
    pub within_limits: Vec<Outcome>,
}

fn by_name<S: serde::Serializer>(set: &Set, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(cell::names::Named::name(*set))
}

/// One run of a plan.
#[derive(Clone, Copy)]
struct Job {
    set: Set,
    number: usize,
    law: Law,
}

impl Plan {
    /// Runs everything; `progress` is told how many of how many runs are done. None where a
    /// signal ended it.
    ///
    /// # Errors
    /// The first run that cannot be.
    pub fn run(
        &self,
        progress: impl Fn(usize, usize) + Sync,
    ) -> Result<Option<Vec<SetOutcome>>, Invalid> {
        let ground = Ground::new(&self.arm);
        let jobs = self.listed()?;
        let results = spread::in_order(&jobs, self.jobs, progress, |job| {
            let case = self.case(&ground, job)?;
            self.made(&case, job)
        })?;
        Ok(results.map(|results| self.collected(&jobs, results)))
    }

    /// Every run.
    fn listed(&self) -> Result<Vec<Job>, Invalid> {
        let mut jobs = Vec::new();
        for &set in &self.sets {
            let there = match &self.from {
                Some(folder) => import::count(folder, set)?,
                None if set.is_drawn() => self.runs.unwrap_or(set.size()),
                None => set.size(),
            };
            let count = self.runs.map_or(there, |runs| runs.min(there));
            for number in 0..count {
                jobs.extend(self.laws.iter().map(|&law| Job { set, number, law }));
            }
        }
        Ok(jobs)
    }

    fn case(&self, ground: &Ground, job: &Job) -> Result<Case, Invalid> {
        match &self.from {
            None => job.set.case(ground, job.number),
            Some(folder) => {
                let path = import::path(folder, job.set, job.number);
                import::case(&path, &self.arm, job.set, job.number)
            }
        }
    }

    fn made(&self, case: &Case, job: &Job) -> Result<Outcome, Invalid> {
        let conditions = Conditions {
            plant: self.plant,
            precision: self.precision,
            law: job.law,
        };
        run::run(case, &conditions)
    }

    fn collected(&self, jobs: &[Job], results: Vec<Outcome>) -> Vec<SetOutcome> {
        let mut sets: Vec<_> = self
            .sets
            .iter()
            .map(|&set| SetOutcome {
                set,
                exact: Vec::new(),
                within_limits: Vec::new(),
            })
            .collect();
        for (job, outcome) in jobs.iter().zip(results) {
            for of_set in sets.iter_mut().filter(|of_set| of_set.set == job.set) {
                let list = match job.law {
                    Law::Exact => &mut of_set.exact,
                    Law::WithinLimits => &mut of_set.within_limits,
                };
                list.push(outcome.clone());
            }
        }
        sets
    }
}
