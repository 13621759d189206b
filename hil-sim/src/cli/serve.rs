//! `hil-sim serve`: the robot's side on a socket.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use clap::Args;

use super::files::Files;
use super::run::{footer, heading, quoted, switch, table};
use crate::link::{Fault, Window};
use crate::plant::PlantOptions;
use crate::report::Choices;
use crate::robot::{
    Krl, LinkFigures, RatingOptions, Robot, RobotAdds, RobotOptions, RobotSetup, scheme_named,
};
use crate::serve::{Client, End, Operator, Serial, Service, Transport, Udp};
use cell::arguments::values::{dead_cycles, number, peer, seed};
use cell::invalid::{Invalid, in_range, positive};
use cell::names::{MeasurementKind, Named, PlantKind};
use cell::ranges::{CYCLE_RANGE_MS, DURATION_MAX_S};
use cell::scenario::Scenario;
use cell::terminal::{print, tell};
use record::run::Sample;

/// Exit code when no client came, or none that could be let into command state.
const NO_CLIENT: u8 = 4;

/// Port of the client's side.
const PORT: u16 = 49_938;

/// Cycles that the protocol has \[ms\].
const FRI_CYCLE_MIN_MS: f64 = 1.0;

/// Options of `serve`.
#[derive(Clone, Debug, Args)]
pub struct ServeOptions {
    /// Built-in scenario (two-level, case-1, case-2, hand), or a TOML file: start, contacts, what is judged
    #[arg(long, default_value = "two-level")]
    scenario: String,
    /// The arm: ideal, realistic
    #[arg(long, default_value = "realistic")]
    plant: String,
    /// The scenario's pushes and hands: on, off
    #[arg(long, default_value = "on")]
    contacts: String,
    /// Seed of mismatch, noise and faults, whole numbers from 0
    #[arg(long, default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Where the client is, ADDRESS:PORT [default: 127.0.0.1:49938]
    #[arg(long)]
    remote: Option<String>,
    /// Short for --remote 127.0.0.1:PORT
    #[arg(long, allow_negative_numbers = true)]
    port: Option<String>,
    /// A serial line instead: device or pseudo terminal
    #[arg(long, value_name = "PATH")]
    serial: Option<PathBuf>,
    /// Own port, 1 to 65535; 0: any
    #[arg(long, default_value = "0", allow_negative_numbers = true)]
    local_port: String,
    /// Cycle in ms, 1 to 20 [default: the scenario's]
    #[arg(long, value_parser = number, allow_negative_numbers = true)]
    cycle_ms: Option<f64>,
    /// Length in s, above 0, at most 3600 [default: the scenario's]
    #[arg(long, value_parser = number, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Cycles between the added torque and its effect, 0 to 8
    #[arg(long, default_value_t = 0, value_parser = dead_cycles, allow_negative_numbers = true)]
    dead_cycles: u8,
    /// Virtual time: as fast as both sides can, the same bytes every time
    #[arg(long)]
    lockstep: bool,
    /// Who decides on command state: auto, handshake (the client, by user data)
    #[arg(long, default_value = "auto")]
    krl: String,
    /// What the robot makes of answers: joint-impedance, position
    #[arg(long, default_value = "joint-impedance")]
    scheme: String,
    /// What the robot adds to the torque itself: gravity, gravity-coriolis
    #[arg(long, default_value = "gravity")]
    robot_adds: String,
    /// What goes wrong on the link: DIR to-client, to-robot, both; KIND drop=P duplicate=P
    /// reorder=P corrupt=P burst=PxN (P 0 to 1, N 1 to 10000 in a row) delay=MS jitter=MS
    /// (0 to 10000) freeze; FROM-TO in s of the scenario. May be given more than once
    #[arg(long, value_name = "DIR:KIND[@FROM-TO]")]
    fault: Vec<String>,
    /// Scenario time during which the drives are off, in s
    #[arg(long, value_name = "FROM-TO")]
    drives_off: Option<String>,
    /// Time to wait for the first answer, and then for command state, in s, above 0
    #[arg(long, default_value = "60", value_parser = number, allow_negative_numbers = true)]
    wait: f64,
    /// Output folder [default: out/serve-SCENARIO]
    #[arg(long)]
    out: Option<PathBuf>,
    // Last: what follows would be listed under its heading.
    #[command(flatten)]
    thresholds: Thresholds,
}

/// When the robot is content.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Thresholds")]
struct Thresholds {
    /// Least share of answers in time for quality perfect, 0 to 1
    #[arg(long, default_value = "0.99", value_parser = number, allow_negative_numbers = true)]
    perfect_rate: f64,
    /// The same for quality ok, not above that of perfect
    #[arg(long, default_value = "0.95", value_parser = number, allow_negative_numbers = true)]
    ok_rate: f64,
    /// The same for quality bad, not above that of ok; below it: unacceptable
    #[arg(long, default_value = "0.8", value_parser = number, allow_negative_numbers = true)]
    bad_rate: f64,
    /// Largest jitter for quality perfect, in cycles, 0 to 1000
    #[arg(long, default_value = "0.25", value_parser = number, allow_negative_numbers = true)]
    perfect_jitter: f64,
    /// Missing answers in a row that are borne, whole numbers 0 to 1000000
    #[arg(long, default_value = "10", value_parser = number, allow_negative_numbers = true)]
    misses: f64,
    /// Time with quality ok before command state, in s, 0 to 60
    #[arg(long, default_value = "0.2", value_parser = number, allow_negative_numbers = true)]
    good_for: f64,
    /// Largest distance of jntPos from the commanded position on entry, in mrad, 0 to 1000
    #[arg(long, default_value = "5", value_parser = number, allow_negative_numbers = true)]
    entry_mrad: f64,
    /// Largest added torque on entry, in Nm, 0 to 200
    #[arg(long, default_value = "1", value_parser = number, allow_negative_numbers = true)]
    entry_nm: f64,
    /// Speed limit of jntPos over the data sheet's, above 0, at most 10
    #[arg(long, default_value = "1.1", value_parser = number, allow_negative_numbers = true)]
    speed_factor: f64,
    /// Stiffness of the robot program, in Nm/rad, above 0, at most 2000
    #[arg(long, default_value = "1000", value_parser = number, allow_negative_numbers = true)]
    krl_stiffness: f64,
    /// Damping ratio of the robot program, 0 to 1
    #[arg(long, default_value = "0.7", value_parser = number, allow_negative_numbers = true)]
    krl_damping: f64,
}

impl Thresholds {
    fn options(&self) -> Result<RobotOptions, Invalid> {
        let share = |name: &str, value| in_range(name, value, 0.0, 1.0);
        let misses = in_range("--misses", self.misses, 0.0, 1e6)?;
        if misses.fract() != 0.0 {
            return Err(Invalid::new(
                "--misses",
                misses,
                "whole numbers 0 to 1000000",
            ));
        }
        let rating = RatingOptions {
            perfect_rate: share("--perfect-rate", self.perfect_rate)?,
            ok_rate: share("--ok-rate", self.ok_rate)?,
            bad_rate: share("--bad-rate", self.bad_rate)?,
            perfect_jitter: in_range("--perfect-jitter", self.perfect_jitter, 0.0, 1e3)?,
            misses_max: misses as u32,
        };
        if !(rating.bad_rate <= rating.ok_rate && rating.ok_rate <= rating.perfect_rate) {
            let given = format_args!(
                "{} {} {}",
                rating.bad_rate, rating.ok_rate, rating.perfect_rate
            )
            .to_string();
            let thing = "--bad-rate, --ok-rate, --perfect-rate";
            return Err(Invalid::new(thing, given, "not falling in this order"));
        }
        Ok(RobotOptions {
            rating,
            good_for_s: in_range("--good-for", self.good_for, 0.0, 60.0)?,
            entry_position_rad: in_range("--entry-mrad", self.entry_mrad, 0.0, 1e3)? * 1e-3,
            entry_torque_nm: in_range("--entry-nm", self.entry_nm, 0.0, 200.0)?,
            speed_factor: positive("--speed-factor", self.speed_factor, 10.0)?,
            stiffness: positive("--krl-stiffness", self.krl_stiffness, 2000.0)?,
            damping: share("--krl-damping", self.krl_damping)?,
            ..RobotOptions::default()
        })
    }
}

impl ServeOptions {
    /// Serves, writes the files, prints the rows, gives the exit code.
    ///
    /// # Errors
    /// Whatever was given that cannot be used, and the socket's errors.
    pub fn run(&self) -> Result<u8, Invalid> {
        let service = self.service()?;
        let setup = self.setup()?;
        let scenario = setup.scenario.clone();
        let out = self
            .out
            .clone()
            .unwrap_or_else(|| Path::new("out").join(format!("serve-{}", scenario.name)));
        let mut client: Box<dyn Transport> = match &service.client {
            Client::Udp { remote, local_port } => Box::new(Udp::open(*remote, *local_port)?),
            Client::Serial(path) => Box::new(Serial::open(path)?),
        };
        let mut files = Files::create(&out, &scenario, setup.contacts)?;
        tell(format_args!(
            "robot at the start posture, measurements go to {}; lines on standard input: push, \
             release, drives off|on, quit",
            service.client
        ));
        let mut operator = Operator::at_the_terminal();
        let mut robot = Robot::new(setup);
        let mut sink = |instant: &Sample| files.push(&scenario, instant);
        let end = service
            .run(&mut robot, &mut operator, &mut *client, &mut sink)
            .map_err(|error| Invalid::line(error).within(&service.client))?;
        match end {
            End::Finished => (),
            End::NoClient(why) => {
                tell(format_args!("error: {why}"));
                return Ok(NO_CLIENT);
            }
        }
        let summary = robot.summary();
        let command = own_command();
        let setup = robot.setup();
        let choices = Choices {
            measurement: MeasurementKind::Fri,
            options: setup.plant_options,
            ..Choices::default()
        };
        files.finish(&scenario, &summary, choices, Some(&command))?;
        let mut text = heading(&scenario, setup.plant, setup.contacts, setup.seed);
        text += &table(&[&summary]);
        if let Some(link) = &summary.link {
            text += &link_line(link);
        }
        text += &footer(&summary, &out);
        print(&text)?;
        Ok(summary.verdict.exit_code())
    }

    fn service(&self) -> Result<Service, Invalid> {
        let port = |name: &str, text: &str, least: u16| {
            let port = text.parse().ok().filter(|port| *port >= least);
            port.ok_or_else(|| Invalid::new(name, text, format_args!("{least} to 65535")))
        };
        let given = [
            self.remote.is_some(),
            self.port.is_some(),
            self.serial.is_some(),
        ];
        if given.iter().filter(|given| **given).count() > 1 {
            let allowed = "one of them";
            return Err(Invalid::new(
                "--remote, --port, --serial",
                "several given",
                allowed,
            ));
        }
        let remote = match (&self.remote, &self.port) {
            (Some(remote), _) => {
                peer(remote).map_err(|allowed| Invalid::new("--remote", remote, allowed))?
            }
            (None, Some(text)) => SocketAddr::from(([127, 0, 0, 1], port("--port", text, 1)?)),
            (None, None) => SocketAddr::from(([127, 0, 0, 1], PORT)),
        };
        let faults = self.fault.iter().map(|spec| spec.parse::<Fault>());
        Ok(Service {
            client: match &self.serial {
                Some(path) => Client::Serial(path.clone()),
                None => Client::Udp {
                    remote,
                    local_port: port("--local-port", &self.local_port, 0)?,
                },
            },
            lockstep: self.lockstep,
            faults: faults.collect::<Result<_, _>>()?,
            wait_s: positive("--wait", self.wait, 1e6)?,
        })
    }

    fn setup(&self) -> Result<RobotSetup, Invalid> {
        let mut scenario = Scenario::find(&self.scenario)?;
        if let Some(duration) = self.duration {
            scenario.duration_s = positive("--duration", duration, DURATION_MAX_S)?;
        }
        let [_, max] = CYCLE_RANGE_MS;
        let cycle = self.cycle_ms.unwrap_or(scenario.cycle_ms);
        scenario.cycle_ms = in_range("--cycle-ms", cycle, FRI_CYCLE_MIN_MS, max)?;
        if self.scheme == "cartesian-impedance" {
            let allowed = "joint-impedance, position";
            return Err(Invalid::new(
                "--scheme",
                "cartesian-impedance is not supported",
                allowed,
            ));
        }
        let drives_off_s = match &self.drives_off {
            None => None,
            Some(text) => {
                let window = Window::read(text).ok_or_else(|| {
                    Invalid::new("--drives-off", text, "FROM-TO in s, FROM below TO")
                })?;
                Some([window.from_s, window.to_s])
            }
        };
        Ok(RobotSetup {
            scenario,
            plant: PlantKind::from_name(&self.plant)?,
            contacts: switch("--contacts", &self.contacts)?,
            seed: self.seed,
            plant_options: PlantOptions {
                dead_cycles: self.dead_cycles.into(),
                ..PlantOptions::default()
            },
            options: RobotOptions {
                krl: Krl::from_name(&self.krl)?,
                scheme: scheme_named(&self.scheme)?,
                adds: RobotAdds::from_name(&self.robot_adds)?,
                drives_off_s,
                ..self.thresholds.options()?
            },
        })
    }
}

/// The command line of this process.
fn own_command() -> String {
    let own = std::env::args_os().skip(1);
    let words = own.map(|word| quoted(&word.to_string_lossy()));
    ["hil-sim".to_string()]
        .into_iter()
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

/// The link in one line.
fn link_line(link: &LinkFigures) -> String {
    let or_dash = |value: Option<f64>, digits: usize| {
        value.map_or("-".to_string(), |value| format!("{value:.digits$}"))
    };
    format!(
        "link: {} % in command state, {} answers, {} missed, {} late, {} rejected, {} lost, \
         latency {} ms, jitter {} ms, {} fallbacks, torque step {:.2} Nm\n",
        or_dash(link.command_share.map(|share| share * 100.0), 1),
        link.answers,
        link.missed,
        link.late,
        link.rejected.total(),
        link.lost,
        or_dash(link.latency_ms.mean, 3),
        or_dash(link.jitter_ms, 3),
        link.fallbacks,
        link.largest_torque_step_nm,
    )
}
