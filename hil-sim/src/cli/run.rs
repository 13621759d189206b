//! `hil-sim run` and the comparison that runs without arguments.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use controller_core::Controller;

use super::files::{Files, announce, is_none};
use super::notes;
use crate::controllers::{ControllerKind, TorqueLaw};
use crate::experiment::Experiment;
use crate::explain::state_at;
use crate::interrupt;
use crate::output::Folder;
use crate::plant::PlantOptions;
use crate::report::Choices;
use crate::summary::{Summary, Verdict};
use cell::arguments::values::{number, whole};
use cell::invalid::Invalid;
use cell::names::{MeasurementKind, Named, NullStiffness, PlantKind, Switch};
use cell::ranges::{CYCLE_MS, DEAD_CYCLES, DURATION_S, Range, SEED, TIME_S};
use cell::scenario::{Scenario, built_in_names};
use cell::terminal::{print, show};

/// Size of a trace \[GB\].
const TRACE_GB: Range<f64> = Range::above(0.0, 1e6);

/// Largest trace where nothing else is said \[GB\].
const MOST_GB: f64 = 4.0;

/// Options of `run`. Choices are plain text here, so that an unknown one gets
/// the same one-line answer as everything else.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct RunOptions {
    #[arg(help = format!("Built-in scenario ({}), or a TOML file, which says arm, mount and tool", built_in_names()))]
    scenario: String,
    /// The arm: ideal, realistic
    #[arg(long, default_value = "realistic")]
    plant: String,
    /// The scenario's pushes and hands: on, off
    #[arg(long, default_value = "on")]
    contacts: String,
    /// The law: hierarchical, no-observer, literal, as-printed, acceleration-level, acceleration-level-estimate
    #[arg(long, default_value = "hierarchical")]
    controller: String,
    /// Null-space stiffness: low (x 0.2), normal, high (x 4)
    #[arg(long, default_value = "normal")]
    null_stiffness: String,
    /// How the controller sees the arm: direct; link: through the bytes of the arm's robot link, held for a second before time 0: of Panda and FR3 the FCI, of any other FRI; fri: that of FRI for every arm, speeds estimated; like-fri: the same without datagrams
    #[arg(long, default_value = "direct")]
    measurement: String,
    #[arg(long, value_parser = whole(DEAD_CYCLES),
        help = format!("Cycles between the torque and its effect, {DEAD_CYCLES}; above 0 the \
            null-space damping is the scenario's inertia-shaped one [default: the plant's own]"))]
    dead_cycles: Option<u8>,
    /// True stiction instead of smooth friction (realistic plant): on, off
    #[arg(long, default_value = "off")]
    stiction: String,
    /// Elastic joints (realistic plant): on, off
    #[arg(long, default_value = "off")]
    elasticity: String,
    /// Seed of mismatch and noise (realistic plant), whole numbers from 0
    #[arg(long, default_value_t = 1, value_parser = whole(SEED))]
    seed: u64,
    #[arg(long, value_parser = number(DURATION_S),
        help = format!("Length in s, {DURATION_S} [default: the scenario's]"))]
    duration: Option<f64>,
    #[arg(long, value_parser = number(CYCLE_MS),
        help = format!("Control cycle in ms, {CYCLE_MS} [default: the scenario's]"))]
    cycle_ms: Option<f64>,
    #[arg(long, value_parser = number(TRACE_GB),
        help = format!("Largest trace.csv that may be written, in GB, {TRACE_GB} \
            [default: {MOST_GB}]"))]
    max_trace_gb: Option<f64>,
    #[arg(long, value_parser = number(TIME_S),
        help = format!("Also write the cycle at this time in s, {TIME_S}, as state.json for explain"))]
    state_at: Option<f64>,
    /// Output folder, or none: no file is written, figures and verdict are printed [default: out/SCENARIO]
    #[arg(long)]
    out: Option<PathBuf>,
}

impl RunOptions {
    /// Runs one experiment, prints its row, gives its exit code.
    ///
    /// # Errors
    /// Whatever was given that cannot be used.
    pub fn run(&self) -> Result<u8, Invalid> {
        let experiment = self.experiment()?;
        let command = self.command();
        let out = self.folder(&experiment.scenario)?;
        let controller = experiment.controller()?;
        let summary = match &out {
            None => {
                interrupt::heed();
                figures_only(&experiment, &controller)?
            }
            Some(out) => {
                announce(&experiment.scenario, self.max_trace_gb.unwrap_or(MOST_GB))?;
                let state = self.state_at.map(|t_s| state_at(&experiment, t_s));
                let state = state.transpose()?;
                let mut folder = Folder::claim(out)?;
                if let Some(state) = state {
                    folder.add("state.json", &state)?;
                }
                interrupt::heed();
                execute(&experiment, &controller, folder, Some(&command))?
            }
        };
        let mut text = experiment_heading(&experiment);
        text += &table(&[&summary]);
        text += &footer(&summary, out.as_deref());
        print(&text)?;
        Ok(summary.verdict.exit_code())
    }

    /// The output folder; none where nothing is to be written.
    fn folder(&self, scenario: &Scenario) -> Result<Option<PathBuf>, Invalid> {
        let Some(out) = &self.out else {
            return Ok(Some(Path::new("out").join(&scenario.name)));
        };
        if !is_none(out) {
            return Ok(Some(out.clone()));
        }
        let files = [
            ("--state-at", self.state_at, "state.json"),
            ("--max-trace-gb", self.max_trace_gb, "trace.csv"),
        ];
        for (option, value, file) in files {
            if let Some(value) = value {
                let allowed = format!("left out with --out none, which writes no {file}");
                return Err(Invalid::new(option, value, allowed));
            }
        }
        Ok(None)
    }

    /// The command line that repeats this run.
    fn command(&self) -> String {
        let mut words = vec![
            "hil-sim".to_string(),
            "run".to_string(),
            self.scenario.clone(),
        ];
        let mut option = |name: &str, value: &str, default: &str| {
            if value != default {
                words.extend([format!("--{name}"), value.to_string()]);
            }
        };
        option("plant", &self.plant, "realistic");
        option("contacts", &self.contacts, "on");
        option("controller", &self.controller, "hierarchical");
        option("null-stiffness", &self.null_stiffness, "normal");
        option("measurement", &self.measurement, "direct");
        if let Some(cycles) = self.dead_cycles {
            option("dead-cycles", &cycles.to_string(), "");
        }
        option("stiction", &self.stiction, "off");
        option("elasticity", &self.elasticity, "off");
        option("seed", &self.seed.to_string(), "1");
        let most_gb = self.max_trace_gb.unwrap_or(MOST_GB);
        option("max-trace-gb", &most_gb.to_string(), "4");
        for (name, value) in [("duration", self.duration), ("cycle-ms", self.cycle_ms)] {
            if let Some(value) = value {
                option(name, &value.to_string(), "");
            }
        }
        let words: Vec<_> = words.iter().map(|word| quoted(word)).collect();
        words.join(" ")
    }

    fn experiment(&self) -> Result<Experiment, Invalid> {
        let mut scenario = Scenario::find(&self.scenario)?;
        scenario.duration_s = self.duration.unwrap_or(scenario.duration_s);
        scenario.cycle_ms = self.cycle_ms.unwrap_or(scenario.cycle_ms);
        let plant = PlantKind::from_name(&self.plant)?;
        let option = |name: &str, value: &str| {
            let on = switch(name, value)?;
            if on && plant == PlantKind::Ideal {
                return Err(Invalid::new(name, value, "off with --plant ideal"));
            }
            Ok(on)
        };
        let controller = ControllerKind::from_name(&self.controller)?;
        let measurement = MeasurementKind::from_name(&self.measurement)?;
        if measurement != MeasurementKind::Direct && controller != TorqueLaw::Hierarchical.into() {
            let measurement = &self.measurement;
            let allowed = format!(
                "hierarchical with --measurement {measurement}, which runs the product alone"
            );
            return Err(Invalid::new("controller", &self.controller, allowed));
        }
        let own = PlantOptions::of(plant, &scenario.arm().parameters);
        Ok(Experiment {
            scenario,
            plant,
            contacts: switch("--contacts", &self.contacts)?,
            controller,
            null_stiffness: NullStiffness::from_name(&self.null_stiffness)?,
            measurement,
            seed: self.seed,
            options: PlantOptions {
                stiction: option("--stiction", &self.stiction)?,
                elasticity: option("--elasticity", &self.elasticity)?,
                dead_cycles: self.dead_cycles.map_or(own.dead_cycles, usize::from),
                substeps_factor: 0,
            },
        })
    }
}

/// A word as a shell takes it.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=@,+~".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_string();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

pub(super) fn switch(option: &str, value: &str) -> Result<bool, Invalid> {
    Ok(Switch::from_name(value)
        .map_err(|error| error.within(option))?
        .0)
}

/// The two-level experiment with every controller, as `cargo run` does it. The
/// product's files go to out/two-level, those of the others to folders inside.
///
/// # Errors
/// The output folder cannot be written.
pub fn comparison() -> Result<u8, Invalid> {
    let out = Path::new("out").join("two-level");
    let product = Experiment {
        scenario: Scenario::find("two-level")?,
        plant: PlantKind::Realistic,
        contacts: true,
        controller: TorqueLaw::Hierarchical.into(),
        null_stiffness: NullStiffness::Normal,
        measurement: MeasurementKind::Direct,
        seed: 1,
        options: PlantOptions::default(),
    };
    let folder = Folder::claim(&out)?;
    let others = [TorqueLaw::NoObserver, TorqueLaw::AccelerationLevel].map(ControllerKind::from);
    let folders = others.map(|controller| Folder::claim(&out.join(controller.name())));
    let folders: Vec<_> = folders.into_iter().collect::<Result<_, _>>()?;
    interrupt::heed();
    let summary = execute(&product, &product.controller()?, folder, None)?;
    let mut rows = vec![summary.clone()];
    for (controller, folder) in others.into_iter().zip(folders) {
        if interrupt::stop().is_some() {
            break;
        }
        let other = Experiment {
            controller,
            ..product.clone()
        };
        rows.push(execute(&other, &other.controller()?, folder, None)?);
    }
    let mut text = experiment_heading(&product);
    text += &table(&rows.iter().collect::<Vec<_>>());
    text += &footer(&summary, Some(&out));
    text += "Only hierarchical has to pass: the others are there for comparison.\n";
    print(&text)?;
    let verdict = match interrupt::stop() {
        Some(_) => Verdict::Stopped,
        None => summary.verdict,
    };
    Ok(verdict.exit_code())
}

/// Runs an experiment and writes its files.
fn execute(
    experiment: &Experiment,
    controller: &Controller<f64>,
    folder: Folder,
    command: Option<&str>,
) -> Result<Summary, Invalid> {
    let scenario = &experiment.scenario;
    let mut files = Files::create(folder, scenario, experiment.contacts)?;

    notes::tell_all(experiment, controller);
    let mut progress = Progress::new(experiment.controller.name());
    let written = experiment.run(
        controller,
        |instant| files.push(instant),
        |share| progress.show(share),
    );
    progress.clear();
    let summary = written.map_err(|error| files.failed(error))?;
    files.finish(scenario, &summary, Choices::of(experiment), command)?;
    Ok(summary)
}

/// Runs an experiment of which nothing is written.
fn figures_only(experiment: &Experiment, controller: &Controller<f64>) -> Result<Summary, Invalid> {
    notes::tell_all(experiment, controller);
    let mut progress = Progress::new(experiment.controller.name());
    let summary = experiment.run(controller, |_| Ok(()), |share| progress.show(share));
    progress.clear();
    summary.map_err(Invalid::line)
}

fn experiment_heading(experiment: &Experiment) -> String {
    heading(
        &experiment.scenario,
        experiment.plant,
        experiment.contacts,
        experiment.seed,
    )
}

pub(super) fn heading(scenario: &Scenario, plant: PlantKind, contacts: bool, seed: u64) -> String {
    format!(
        "{}: {} plant, contacts {}, seed {}, {} s in cycles of {} ms\n\n",
        scenario.name,
        plant.name(),
        Switch(contacts).name(),
        seed,
        scenario.duration_s,
        scenario.cycle_ms,
    )
}

pub(super) fn footer(summary: &Summary, out: Option<&Path>) -> String {
    let reason = summary
        .reason
        .as_ref()
        .map(|reason| format!("{reason}\n"))
        .unwrap_or_default();
    match out {
        Some(out) => format!(
            "\n{reason}report.html, summary.json, trace.csv and figures are in {}\n",
            out.display()
        ),
        None => format!("\n{reason}No file was written.\n"),
    }
}

/// One row per run and level.
pub(super) fn table(runs: &[&Summary]) -> String {
    let mut text = format!(
        "{:<28} {:<26} {:>9} {:>9} {:>11} {:>12}  {}\n",
        "controller", "level", "rms", "max", "plateau", "r error Nm", "verdict"
    );
    for run in runs {
        for (number, level) in (1..).zip(&run.levels) {
            let [controller, residual, verdict] = match number {
                1 => [
                    run.controller,
                    &figure(run.residual.rms_error_nm),
                    run.verdict_word(),
                ],
                _ => [""; 3],
            };
            text += &format!(
                "{controller:<28} {:<26} {:>9} {:>9} {:>11} {residual:>12}  {verdict}\n",
                format!("{number} {}, {}", level.name, level.unit().suffix()),
                figure(level.rms()),
                figure(level.max()),
                figure(level.worst_plateau()),
            );
        }
    }
    for run in runs {
        for remark in run.remarks() {
            text += &format!("{}: {remark}\n", run.controller);
        }
    }
    text
}

fn figure(value: Option<f64>) -> String {
    match value {
        None => "-".to_string(),
        Some(value) if value < 0.01 => format!("{value:.5}"),
        Some(value) => format!("{value:.3}"),
    }
}

/// Share done, on a terminal, once a run takes longer than a second.
struct Progress {
    label: &'static str,
    start: Instant,
    shown: bool,
}

impl Progress {
    fn new(label: &'static str) -> Self {
        Self {
            label,
            start: Instant::now(),
            shown: false,
        }
    }

    fn show(&mut self, share: f64) {
        if self.start.elapsed() > Duration::from_secs(1) && io::stderr().is_terminal() {
            self.shown = true;
            show(format_args!("\r{}: {:3.0} %", self.label, share * 100.0));
        }
    }

    fn clear(&self) {
        if self.shown {
            show(format_args!("\r{:40}\r", ""));
        }
    }
}
