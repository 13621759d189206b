//! Options of `run`, what they refuse, and what they make for every robot.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bridge::protocol::{Protocol, Report};
use bridge::session::{Session, SessionConfig};
use cell::arguments::values::{address, device, number, peer, processor, whole};
use cell::invalid::Invalid;
use cell::names::{Named as _, NullStiffness, RobotInterface};
use cell::ranges::{DEAD_CYCLES, DURATION_S, Range, WAIT_S};
use cell::scenario::{Events, Scenario, ScenarioSource, built_in_names};
use cell::terminal::{print, tell};
use clap::Args;
use controller_core::Controller;
use controller_core::joint::JointVector;

use super::source::{Motion, Source};
use super::telling::{Flight, closing, place, prepare, unwritable};
use crate::changes;
use crate::stream::Stream;
use crate::summary::Summary;

/// How far the start posture may be required to be from the scenario's \[deg\].
const START_DEG: Range<f64> = Range::above(0.0, 360.0);

/// How long references may stay away \[ms\].
const TIMEOUT_MS: Range<f64> = Range::above(0.0, 10_000.0);

/// Thresholds of collisions \[Nm\], \[N\].
const COLLISION: Range<f64> = Range::above(0.0, 1000.0);

/// Options of `run`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct RunOptions {
    #[arg(value_name = "SCENARIO",
        help = format!("Built-in scenario ({}), or a TOML file, which says arm, mount and tool \
            [default: two-level of lwr, two-level-fr3 of fci]", built_in_names()))]
    experiment: Option<String>,
    /// The same
    #[arg(long, value_name = "SCENARIO", conflicts_with = "experiment")]
    scenario: Option<String>,
    /// The robot: lwr, a KUKA LWR by FRI; fci, a Panda or FR3 by the Franka Control Interface
    #[arg(long, default_value = "lwr")]
    robot: String,
    /// fci: address of the robot, port 1337
    #[arg(long, value_parser = device, value_name = "ADDR")]
    pub(super) address: Option<IpAddr>,
    /// fci: ask the robot once to recover from a reflex, before the motion or behind it
    #[arg(long)]
    pub(super) recover: bool,
    #[arg(long, value_parser = number(COLLISION), value_name = "NM",
        help = format!("fci: external torque of a joint that counts as a collision, in Nm, \
            {COLLISION} [default: 100]"))]
    pub(super) collision_torque: Option<f64>,
    #[arg(long, value_parser = number(COLLISION), value_name = "N",
        help = format!("fci: external force (moment) at the flange that counts as a collision, in N \
            (Nm), {COLLISION} [default: 100]"))]
    pub(super) collision_force: Option<f64>,
    /// lwr: address and port to which the robot sends [default: 127.0.0.1:49938]
    #[arg(long, value_parser = address, value_name = "ADDR:PORT")]
    pub(super) listen: Option<SocketAddr>,
    /// lwr: answer this address only [default: the first that sends three measurements in a row]
    #[arg(long, value_parser = peer, value_name = "ADDR:PORT")]
    pub(super) peer: Option<SocketAddr>,
    #[arg(long, value_parser = number(DURATION_S),
        help = format!("Length of the motion in s, {DURATION_S} [default: the scenario's]"))]
    duration: Option<f64>,
    #[arg(long, default_value_t = 0, value_parser = whole(DEAD_CYCLES),
        help = format!("Cycles between the arrival of a torque and its effect, {DEAD_CYCLES}"))]
    pub(super) dead_cycles: u8,
    /// lwr: what the robot adds to the torque: gravity, gravity-coriolis [default: gravity]
    #[arg(long)]
    pub(super) robot_adds: Option<String>,
    /// Null-space stiffness: low (x 0.2), normal, high (x 4)
    #[arg(long, default_value = "normal")]
    null_stiffness: String,
    #[arg(long, value_parser = number(START_DEG), value_name = "DEG",
        help = format!("Refuse a start posture that is farther from the scenario's than this, \
            in deg, {START_DEG}"))]
    require_start: Option<f64>,
    /// Take references from UDP datagrams at this address instead of the scenario: text, for
    /// each level in the order of the scenario x y z, velocity, acceleration (9 numbers; m, s), or of an
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
    pub(super) dry: bool,
    #[arg(long, default_value_t = 60.0, value_parser = number(WAIT_S),
        help = format!("Seconds to wait for the robot, {WAIT_S}"))]
    pub(super) wait: f64,
    /// Processor for the control thread, from 0
    #[arg(long, value_parser = processor)]
    pub(super) cpu: Option<usize>,
    /// Write a summary as JSON
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
    /// Write every cycle as CSV
    #[arg(long, value_name = "FILE")]
    pub(super) record: Option<PathBuf>,
    /// Write the last cycles before a fault as CSV
    #[arg(long, default_value = "out/flight-record.csv", value_name = "FILE")]
    flight_record: PathBuf,
}

impl RunOptions {
    /// The robot's interface.
    pub(super) fn robot(&self) -> Result<RobotInterface, Invalid> {
        RobotInterface::from_name(&self.robot)
    }

    /// The scenario that was asked for, or that of the robot.
    pub(super) fn scenario(&self) -> &str {
        let asked = self.experiment.as_deref().or(self.scenario.as_deref());
        asked.unwrap_or(match self.robot.as_str() {
            "fci" => "two-level-fr3",
            _ => "two-level",
        })
    }

    /// Options that mean nothing to a robot are mistakes.
    pub(super) fn refuse_options_of_others(&self, robot: RobotInterface) -> Result<(), Invalid> {
        let shown = |value: Option<f64>| value.map(|value| value.to_string());
        let address = |value: Option<SocketAddr>| value.map(|value| value.to_string());
        let options = [
            ("--listen", address(self.listen), RobotInterface::Lwr),
            ("--peer", address(self.peer), RobotInterface::Lwr),
            ("--robot-adds", self.robot_adds.clone(), RobotInterface::Lwr),
            (
                "--address",
                self.address.map(|address| address.to_string()),
                RobotInterface::Fci,
            ),
            (
                "--recover",
                self.recover.then(|| "given".to_string()),
                RobotInterface::Fci,
            ),
            (
                "--collision-torque",
                shown(self.collision_torque),
                RobotInterface::Fci,
            ),
            (
                "--collision-force",
                shown(self.collision_force),
                RobotInterface::Fci,
            ),
        ];
        for (option, value, of) in options {
            if let (Some(value), true) = (value, of != robot) {
                let allowed = format!("only with --robot {}", of.name());
                return Err(Invalid::new(option, value, allowed));
            }
        }
        Ok(())
    }

    /// The torque of a session that has only looked.
    pub(super) fn tell_dry<P: Protocol>(&self, session: &Session<P>) -> Result<(), Invalid> {
        let step = session.last().and_then(|cycle| cycle.step);
        let Some(step) = step.filter(|_| self.dry) else {
            return Ok(());
        };
        let torque: JointVector<f64> = step.torque - step.gravity;
        let torque: Vec<_> = torque.iter().map(|value| format!("{value:.2}")).collect();
        print(format_args!(
            "dry: the last torque would have been {} Nm\n",
            torque.join(" ")
        ))
    }

    /// Files and the closing lines.
    pub(super) fn report<R: Report>(
        &self,
        summary: &Summary,
        flight: &Flight<R>,
    ) -> Result<(), Invalid> {
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
    pub(super) fn prepare_files(&self) -> Result<(), Invalid> {
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

    /// What every robot's session has.
    pub(super) fn config(&self, scenario: &Scenario) -> Result<SessionConfig, Invalid> {
        let duration_s = self.duration.unwrap_or(scenario.duration_s);
        let robot = self.robot()?;
        let mut config = scenario.session_config_for(robot, self.dead_cycles, duration_s)?;
        let factor = NullStiffness::from_name(&self.null_stiffness)?.factor();
        config.controller.null_space = config.controller.null_space.stiffened(factor);
        config.dry = self.dry;
        // What the robot's cycle will be is not known yet; all else is checked now.
        Controller::<f64>::new(&config.arm, &config.controller)
            .map_err(|error| Invalid::line(error.named(&config.arm)).within(&scenario.name))?;
        Ok(config)
    }

    /// The scenario, or the stream that was asked for.
    pub(super) fn source(
        &self,
        scenario: &Scenario,
        config: &SessionConfig,
    ) -> Result<Source, Invalid> {
        let controller = (config.law)(&config.arm, &config.controller)
            .map_err(|error| Invalid::line(error.named(&config.arm)).within(&scenario.name))?;
        let (lines, changes) = changes::channel(scenario, &controller);
        let motion = match self.references {
            None => Motion::Scenario(ScenarioSource::new(scenario)),
            Some(address) => {
                let timeout = Duration::from_secs_f64(self.reference_timeout_ms / 1e3);
                let (from, tasks) = (self.references_from, &config.controller.tasks);
                Stream::listen(
                    address,
                    from,
                    tasks,
                    &scenario.arm(),
                    timeout,
                    Some(lines.clone()),
                )
                .map(Motion::Stream)
                .map_err(|error| {
                    let allowed = format!("an address of this PC and a free port ({error})");
                    Invalid::new("--references", address, allowed)
                })?
            }
        };
        lines.listen_to_console().map_err(Invalid::line)?;
        Ok(Source {
            motion,
            events: Events::new(scenario.transitions(&controller)?),
            changes,
        })
    }

    /// The scenario's start posture and how far the arm may be from it \[rad\].
    pub(super) fn required_start(&self, scenario: &Scenario) -> Option<(JointVector<f64>, f64)> {
        let degrees = self.require_start?;
        Some((scenario.start(), degrees.to_radians()))
    }
}

/// Set when the program is interrupted.
pub(super) fn stop_flag() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    // A second handler is the only error, and there is no first.
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    stop
}

/// Refuses a start posture \[rad\].
pub(super) fn wrong_start(q: &JointVector<f64>, tolerance: f64, scenario: &Scenario) -> Invalid {
    let degrees: Vec<_> = q.iter().map(|q| format!("{:.1}", q.to_degrees())).collect();
    Invalid::new(
        "start posture [deg]",
        degrees.join(" "),
        format!(
            "within {:.1} deg of {:?}",
            tolerance.to_degrees(),
            scenario.start_deg
        ),
    )
}
