//! `hil-sim study`: many runs, and what the law keeps in all of them.

use std::io::{self, IsTerminal};
use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use crate::interrupt;
use crate::spread;
use crate::study::limits::acceptance::{self, Criterion};
use crate::study::limits::case::is_lwr;
use crate::study::limits::jobs::{Plan, SetOutcome};
use crate::study::limits::published;
use crate::study::limits::run::{Law, Precision};
use crate::study::limits::set::Set;
use crate::study::limits::table;
use cell::arguments::values::whole;
use cell::invalid::Invalid;
use cell::names::{Named, PlantKind};
use cell::ranges::Range;
use cell::scenario::EquippedArm;
use cell::terminal::{print, show};

/// Runs of a set, and at the same time.
const RUNS: Range<usize> = Range::new(1, 10_000);
const JOBS: Range<usize> = Range::new(1, 1024);

/// Exit code of a study that a signal ended.
const STOPPED: u8 = 3;

/// Options of `study`.
#[derive(Clone, Debug, Args)]
pub struct StudyOptions {
    #[command(subcommand)]
    study: Study,
}

#[derive(Clone, Debug, Subcommand)]
enum Study {
    /// The law near and beyond what an arm can do: singularities, ends of ranges, speed and torque limits
    Limits(LimitsOptions),
}

/// Options of `study limits`.
#[derive(Clone, Debug, Args)]
struct LimitsOptions {
    /// Read the runs from a folder with {pass,wrist,random,push}-NNN.csv.gz instead of drawing them; docs/limits-study.md
    #[arg(long)]
    from: Option<PathBuf>,
    /// Sets of runs: ordered, pass, wrist, random, push, give, straight, saturation [default: all that there are]
    #[arg(long = "set", num_args = 1..)]
    sets: Vec<String>,
    /// The arm, by its name or its arm file; others than lwr_iv have the sets pass, random and straight
    #[arg(long, default_value = "lwr_iv")]
    arm: String,
    /// How it is simulated: ideal, realistic
    #[arg(long, default_value = "ideal")]
    plant: String,
    /// Of the controller: f64, f32
    #[arg(long, default_value = "f64")]
    precision: String,
    /// The law: within-limits, exact, both
    #[arg(long, default_value = "both")]
    law: String,
    #[arg(long, value_parser = whole(RUNS),
        help = format!("Runs of each set, its first ones, {RUNS} [default: all of a set]"))]
    runs: Option<usize>,
    #[arg(long, value_parser = whole(JOBS),
        help = format!("Runs at the same time, {JOBS} [default: one per processor]"))]
    jobs: Option<usize>,
    /// Print the tables of docs/limits-study.md instead, of both plants, both precisions and all arms; with --from that of the runs from files
    #[arg(long, conflicts_with_all = ["sets", "arm", "plant", "precision", "law", "output"])]
    tables: bool,
    /// Write every figure of every run to this file, as JSON
    #[arg(long)]
    output: Option<PathBuf>,
}

/// What `--output` writes.
#[derive(Serialize)]
struct Report<'a> {
    arm: &'a str,
    plant: &'static str,
    precision: &'static str,
    sets: Vec<SetReport<'a>>,
}

#[derive(Serialize)]
struct SetReport<'a> {
    #[serde(flatten)]
    outcome: &'a SetOutcome,
    acceptance: Vec<Criterion>,
}

impl StudyOptions {
    /// Makes the study, prints its tables, gives the exit code.
    ///
    /// # Errors
    /// Whatever was given that cannot be used.
    pub fn run(&self) -> Result<u8, Invalid> {
        match &self.study {
            Study::Limits(options) => options.run(),
        }
    }
}

impl LimitsOptions {
    fn run(&self) -> Result<u8, Invalid> {
        let plan = self.plan()?;
        interrupt::heed();
        if self.tables {
            // Without runs a table has no rows, and is not printed.
            let text = published::all(&plan, &|plan| Ok(made(plan)?.unwrap_or_default()))?;
            if interrupt::stop().is_some() {
                return Ok(STOPPED);
            }
            print(text)?;
            return Ok(0);
        }
        let Some(outcomes) = made(&plan)? else {
            return Ok(STOPPED);
        };
        let sets: Vec<_> = outcomes
            .iter()
            .map(|outcome| SetReport {
                outcome,
                acceptance: acceptance::judge(outcome, &plan),
            })
            .collect();
        let report = Report {
            arm: plan.arm.parameters.name,
            plant: plan.plant.name(),
            precision: plan.precision.name(),
            sets,
        };
        if let Some(path) = &self.output {
            let json = serde_json::to_string_pretty(&report).map_err(Invalid::line)?;
            std::fs::write(path, json + "\n")
                .map_err(|error| Invalid::line(error).within(path.display()))?;
        }
        print(text(&report))?;
        let mut criteria = report.sets.iter().flat_map(|set| &set.acceptance);
        Ok(u8::from(criteria.any(|criterion| !criterion.met)))
    }

    fn plan(&self) -> Result<Plan, Invalid> {
        let arm = EquippedArm::new(&self.arm, None, None)?;
        let laws = match self.law.as_str() {
            "both" => vec![Law::Exact, Law::WithinLimits],
            name => vec![law(name)?],
        };
        let there = |set: &Set| match &self.from {
            Some(_) => Set::IN_FILES.contains(set),
            None => is_lwr(&arm) || set.is_for_any_arm(),
        };
        let mut sets: Vec<_> = Set::ALL.iter().map(|(_, set)| *set).filter(there).collect();
        if !self.sets.is_empty() {
            let known: Vec<_> = sets.iter().map(|set| set.name()).collect();
            let chosen = |name: &String| {
                let set = sets.iter().find(|set| set.name() == name);
                set.copied()
                    .ok_or_else(|| Invalid::name("set", name, &known))
            };
            sets = self.sets.iter().map(chosen).collect::<Result<_, _>>()?;
        }
        Ok(Plan {
            arm,
            plant: PlantKind::from_name(&self.plant)?,
            precision: Precision::from_name(&self.precision)?,
            laws,
            sets,
            runs: self.runs,
            jobs: self.jobs.unwrap_or_else(spread::processors),
            from: self.from.clone(),
        })
    }
}

/// The runs of a plan, with their progress on a terminal; none where a signal ended it.
fn made(plan: &Plan) -> Result<Option<Vec<SetOutcome>>, Invalid> {
    let terminal = io::stderr().is_terminal();
    let outcomes = plan.run(|done, all| {
        if terminal {
            show(format_args!("\r{done} of {all} runs "));
        }
    })?;
    if terminal {
        show("\r                              \r");
    }
    Ok(outcomes)
}

fn law(name: &str) -> Result<Law, Invalid> {
    let known = Law::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, law)| *law).ok_or_else(|| {
        let mut known: Vec<_> = Law::ALL.iter().map(|(name, _)| *name).collect();
        known.push("both");
        Invalid::name(Law::THING, name, &known)
    })
}

fn text(report: &Report<'_>) -> String {
    let Report {
        arm,
        plant,
        precision,
        sets,
    } = report;
    let mut text = format!("limits: {arm}, {plant} plant, controller in {precision}\n");
    for set in sets {
        text += "\n";
        text += &table::table(set.outcome, &set.acceptance);
        if set.outcome.set == Set::Ordered {
            for runs in [&set.outcome.exact, &set.outcome.within_limits] {
                if !runs.is_empty() {
                    text += "\n";
                    text += &table::one_by_one(runs);
                }
            }
        }
    }
    let criteria: Vec<_> = sets.iter().flat_map(|set| &set.acceptance).collect();
    let met = criteria.iter().filter(|criterion| criterion.met).count();
    text + &format!("\n{met} of {} limits met\n", criteria.len())
}
