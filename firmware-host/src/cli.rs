//! The command line, and one line for everything that cannot be used.

mod telling;

use std::net::{SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bridge::lwr::{Lwr, RobotState};
use bridge::session::{Phase, RobotAdds, Session, SessionConfig};
use bridge::source::ReferenceSource;
use cell::arguments::usage;
use cell::arguments::values::{address, number, peer, processor, whole};
use cell::invalid::Invalid;
use cell::names::{Named, NullStiffness};
use cell::ranges::{CYCLE_MS, DEAD_CYCLES, DURATION_S, Range, WAIT_S};
use cell::scenario::{Scenario, ScenarioSource, built_in_names};
use cell::terminal::{print, tell};
use clap::{Args, Parser, Subcommand};
use controller_core::joint::JointVector;
use controller_core::{Controller, Reference, TaskSet};

use self::telling::{Flight, Teller, closing, place, prepare, unwritable};
use crate::doctor;
use crate::recorder::Recorder;
use crate::run::{Endpoint, converse};
use crate::stream::{Stream, StreamFigures};
use crate::summary::Summary;
use cell::realtime::Realtime;

/// How far the start posture may be required to be from the scenario's \[deg\].
const START_DEG: Range<f64> = Range::above(0.0, 360.0);

/// How long references may stay away \[ms\].
const TIMEOUT_MS: Range<f64> = Range::above(0.0, 10_000.0);

/// The torque controller of a KUKA LWR on a PC: answers the robot's FRI
/// datagrams.
#[derive(Debug, Parser)]
#[command(
    name = "firmware-host",
    version,
    after_help = "Exit codes: 0 done, 1 doctor: the cycle is not held, 2 usage or configuration error, \
                  3 stopped by safety, 4 no robot."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Answer the robot until the motion is over
    Run(Box<RunOptions>),
    /// Can this PC hold the cycle? Scheduling, jitter, latency, with advice. Exit code 1: no
    #[command(allow_negative_numbers = true)]
    Doctor {
        #[arg(long, default_value_t = 2.0, value_parser = number(CYCLE_MS),
            help = format!("Cycle in ms, {CYCLE_MS}"))]
        cycle_ms: f64,
        /// Processor for the control thread, from 0
        #[arg(long, value_parser = processor)]
        cpu: Option<usize>,
    },
}

/// Options of `run`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
struct RunOptions {
    #[arg(long, default_value = "two-level",
        help = format!("Built-in scenario ({}), or a TOML file, which says arm, mount and tool", built_in_names()))]
    scenario: String,
    /// Address and port to which the robot sends
    #[arg(long, default_value = "127.0.0.1:49938", value_parser = address, value_name = "ADDR:PORT")]
    listen: SocketAddr,
    /// Answer this address only [default: the first that sends three measurements in a row]
    #[arg(long, value_parser = peer, value_name = "ADDR:PORT")]
    peer: Option<SocketAddr>,
    #[arg(long, value_parser = number(DURATION_S),
        help = format!("Length of the motion in s, {DURATION_S} [default: the scenario's]"))]
    duration: Option<f64>,
    #[arg(long, default_value_t = 0, value_parser = whole(DEAD_CYCLES),
        help = format!("Cycles between the arrival of a torque and its effect, {DEAD_CYCLES}"))]
    dead_cycles: u8,
    /// What the robot adds to the torque: gravity, gravity-coriolis
    #[arg(long, default_value = "gravity")]
    robot_adds: String,
    /// Null-space stiffness: low (x 0.2), normal, high (x 4)
    #[arg(long, default_value = "normal")]
    null_stiffness: String,
    #[arg(long, value_parser = number(START_DEG), value_name = "DEG",
        help = format!("Refuse a start posture that is farther from the scenario's than this, \
            in deg, {START_DEG}"))]
    require_start: Option<f64>,
    /// Take references from UDP datagrams at this address instead of the scenario: text, for
    /// each level in priority order x y z, velocity, acceleration (9 numbers; m, s), or of an
    /// orientation w x y z, angular velocity, angular acceleration (10 numbers; rad, s)
    #[arg(long, value_parser = address, value_name = "ADDR:PORT")]
    references: Option<SocketAddr>,
    /// Take references from this address only [default: the first that sends one]
    #[arg(long, requires = "references", value_parser = peer, value_name = "ADDR:PORT")]
    references_from: Option<SocketAddr>,
    #[arg(long, default_value_t = 100.0, value_parser = number(TIMEOUT_MS),
        help = format!("Hold when no reference has come for so many ms, {TIMEOUT_MS}"))]
    reference_timeout_ms: f64,
    /// Never move the robot: check its model, show the torques as they would be
    #[arg(long)]
    dry: bool,
    #[arg(long, default_value_t = 60.0, value_parser = number(WAIT_S),
        help = format!("Seconds to wait for the robot, {WAIT_S}"))]
    wait: f64,
    /// Processor for the control thread, from 0
    #[arg(long, value_parser = processor)]
    cpu: Option<usize>,
    /// Write a summary as JSON
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
    /// Write every cycle as CSV
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Write the last cycles before a fault as CSV
    #[arg(long, default_value = "out/flight-record.csv", value_name = "FILE")]
    flight_record: PathBuf,
}

/// Runs the program with the arguments of the process.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage::report("firmware-host", &["run", "doctor"], &error),
    };
    let outcome = match cli.command {
        Command::Run(options) => options.run(),
        Command::Doctor { cycle_ms, cpu } => examine(cycle_ms, cpu),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            tell(format_args!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

fn examine(cycle_ms: f64, cpu: Option<usize>) -> Result<u8, Invalid> {
    let findings = doctor::examine(cycle_ms / 1e3, cpu)
        .map_err(|error| Invalid::line(error).within("loopback"))?;
    print(findings.report())?;
    Ok(u8::from(!findings.holds()))
}

/// Where references come from.
enum Source {
    Scenario(ScenarioSource),
    Stream(Stream),
}

impl Source {
    /// What came over the stream, if there is one.
    fn figures(&self) -> Option<StreamFigures> {
        match self {
            Self::Scenario(_) => None,
            Self::Stream(stream) => Some(stream.figures()),
        }
    }
}

impl ReferenceSource for Source {
    fn start(&mut self, origin: &Reference<f64>) {
        match self {
            Self::Scenario(source) => source.start(origin),
            Self::Stream(source) => source.start(origin),
        }
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        match self {
            Self::Scenario(source) => source.sample(t_s),
            Self::Stream(source) => source.sample(t_s),
        }
    }
}

impl RunOptions {
    fn run(&self) -> Result<u8, Invalid> {
        let scenario = Scenario::find(&self.scenario)?;
        let config = self.config(&scenario)?;
        let required = self.required_start(&scenario);
        let wait = Duration::from_secs_f64(self.wait);
        let tasks = config.controller.tasks;
        let mut source = self.source(&scenario, &tasks)?;
        let socket = UdpSocket::bind(self.listen).map_err(|error| {
            let allowed = format!("an address of this PC and a free port ({error})");
            Invalid::new("--listen", self.listen, allowed)
        })?;
        self.prepare_files()?;
        let mut recorder = match &self.record {
            Some(path) => Some(Recorder::create(path).map_err(|error| unwritable(path, &error))?),
            None => None,
        };
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        // A second handler is the only error, and there is no first.
        let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));

        let realtime = Realtime::ask(self.cpu);
        tell(realtime.line());
        tell(format_args!("waiting for the robot at {}", self.listen));
        let mut session = Session::new(Lwr::new(), config);
        let mut end = Endpoint {
            socket,
            peer: self.peer,
            wait,
            silence: Duration::from_secs(2),
            stop: &stop,
            tasks,
        };
        let mut flight = Flight::new();
        let mut teller = Teller::new();
        let mut refused = None;
        let counts = converse(
            &mut end,
            &mut session,
            &mut source,
            recorder.as_mut(),
            |session, cycle| {
                flight.push(cycle);
                teller.tell(session, cycle);
                if let (Some((start, tolerance)), Phase::Ready) = (&required, cycle.phase)
                    && refused.is_none()
                    && (cycle.joints.q - start).amax() > *tolerance
                {
                    refused = Some(cycle.joints.q);
                    stop.store(true, Ordering::Relaxed);
                }
            },
        )
        .map_err(Invalid::line)?;
        if let (Some(q), Some((_, tolerance))) = (refused, &required) {
            let degrees: Vec<_> = q.iter().map(|q| format!("{:.1}", q.to_degrees())).collect();
            return Err(Invalid::new(
                "start posture [deg]",
                degrees.join(" "),
                format!(
                    "within {:.1} deg of {:?}",
                    tolerance.to_degrees(),
                    scenario.start_deg
                ),
            ));
        }

        if session.phase() == Phase::Waiting {
            let (at, wait) = (self.listen, self.wait);
            let until = if stop.load(Ordering::Relaxed) {
                "before it was interrupted".to_string()
            } else {
                format!("within {wait} s")
            };
            tell(format_args!(
                "error: no robot: no measurement came to {at} {until}{}",
                counts.refusals()
            ));
            return Ok(4);
        }
        if let Some(step) = session
            .last()
            .and_then(|cycle| cycle.step)
            .filter(|_| self.dry)
        {
            let torque: JointVector<f64> = step.torque - step.gravity;
            let torque: Vec<_> = torque.iter().map(|value| format!("{value:.2}")).collect();
            print(format_args!(
                "dry: the last torque would have been {} Nm\n",
                torque.join(" ")
            ))?;
        }
        let names: Vec<_> = scenario.levels.iter().map(|level| level.label()).collect();
        let mut summary = counts.summary(&session, &self.scenario, &names, &realtime);
        let mut recorded = Ok(0);
        if let (Some(recorder), Some(path)) = (recorder.take(), &self.record) {
            recorded = recorder.finish().map_err(|error| unwritable(path, &error));
        }
        summary.references = source.figures();
        summary.recorder_dropped = *recorded.as_ref().unwrap_or(&0);
        // A record that failed does not take the rest with it.
        self.report(&summary, &flight)?;
        recorded?;
        Ok(summary.exit_code)
    }

    /// Files and the closing lines.
    fn report(&self, summary: &Summary, flight: &Flight<RobotState>) -> Result<(), Invalid> {
        if let Some(path) = &self.summary {
            let json = serde_json::to_string_pretty(summary).map_err(Invalid::line)?;
            std::fs::write(path, json + "\n").map_err(|error| unwritable(path, &error))?;
        }
        if summary.exit_code == 3 {
            let path = &self.flight_record;
            std::fs::write(path, flight.csv()).map_err(|error| unwritable(path, &error))?;
            tell(format_args!(
                "the last {} cycles are in {}",
                flight.len(),
                path.display()
            ));
        }
        print(closing(summary))
    }

    /// Tries every file that will be written.
    fn prepare_files(&self) -> Result<(), Invalid> {
        let files = [
            ("--summary", self.summary.as_deref()),
            ("--record", self.record.as_deref()),
            ("--flight-record", Some(self.flight_record.as_path())),
        ];
        let mut known: Vec<(&str, PathBuf)> = Vec::new();
        for (option, path) in files {
            let Some(path) = path else { continue };
            prepare(path)?;
            let place = place(path).map_err(|error| unwritable(path, &error))?;
            if let Some((other, _)) = known.iter().find(|(_, other)| *other == place) {
                let allowed = format!("another file than that of {other}");
                return Err(Invalid::new(option, path.display(), allowed));
            }
            known.push((option, place));
        }
        Ok(())
    }

    fn config(&self, scenario: &Scenario) -> Result<SessionConfig, Invalid> {
        let duration_s = self.duration.unwrap_or(scenario.duration_s);
        let mut config = scenario.session_config(self.dead_cycles, duration_s)?;
        let factor = NullStiffness::from_name(&self.null_stiffness)?.factor();
        config.controller.null_space = config.controller.null_space.stiffened(factor);
        config.robot_adds = match self.robot_adds.as_str() {
            "gravity" => RobotAdds::Gravity,
            "gravity-coriolis" => RobotAdds::GravityAndCoriolis,
            other => {
                let known = ["gravity", "gravity-coriolis"];
                return Err(Invalid::name("--robot-adds", other, &known));
            }
        };
        config.dry = self.dry;
        // What the robot's cycle will be is not known yet; all else is checked now.
        Controller::<f64>::new(&config.arm, &config.controller)
            .map_err(|error| Invalid::line(error.named(&config.arm)).within(&scenario.name))?;
        Ok(config)
    }

    fn source(&self, scenario: &Scenario, tasks: &TaskSet) -> Result<Source, Invalid> {
        let timeout = Duration::from_secs_f64(self.reference_timeout_ms / 1e3);
        let Some(address) = self.references else {
            return Ok(Source::Scenario(ScenarioSource::new(scenario)));
        };
        Stream::listen(
            address,
            self.references_from,
            tasks,
            &scenario.arm(),
            timeout,
        )
        .map(Source::Stream)
        .map_err(|error| {
            let allowed = format!("an address of this PC and a free port ({error})");
            Invalid::new("--references", address, allowed)
        })
    }

    /// The scenario's start posture and how far the arm may be from it \[rad\].
    fn required_start(&self, scenario: &Scenario) -> Option<(JointVector<f64>, f64)> {
        let degrees = self.require_start?;
        Some((scenario.start(), degrees.to_radians()))
    }
}
