//! `hil-sim serve`: the robot's side on a socket.

mod fci;
mod kind;

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use ::fci::Version;
use clap::Args;

use kind::Kind;

use super::files::{Files, announce, needed};
use super::notes;
use super::run::{footer, heading, quoted, switch, table};
use crate::link::{BURST, DELAY_MS, Fault, SHARE, Window};
use crate::output::Folder;
use crate::plant::PlantOptions;
use crate::report::Choices;
use crate::robot::{
    ControlBox, FciOptions, Krl, LinkFigures, LwrRobot, RatingOptions, Robot, RobotAdds,
    RobotOptions, RobotSetup, scheme_named,
};
use crate::serve::{Client, End, FciService, Operator, Serial, Service, Transport, Udp};
use crate::summary::Summary;
use cell::arguments::values::{number, peer, processor, whole};
use cell::invalid::Invalid;
use cell::names::{Named, PlantKind};
use cell::ranges::{CYCLE_MS, DEAD_CYCLES, DURATION_S, Range, SEED, WAIT_S};
use cell::realtime::Realtime;
use cell::scenario::{Scenario, built_in_names};
use cell::terminal::{print, tell};
use record::run::Sample;

/// Exit code when no client came, or none that could be let into command state.
const NO_CLIENT: u8 = 4;

/// Port of the client's side.
const PORT: u16 = 49_938;

/// Ports that can be sent to, and own ports: 0 is any.
const PORTS: Range<u16> = Range::new(1, u16::MAX);
const OWN_PORTS: Range<u16> = Range::new(0, u16::MAX);

/// Cycles that the protocol has \[ms\].
const FRI_CYCLE_MS: Range<f64> = Range::new(1.0, CYCLE_MS.max);

/// Jitter \[cycles\], answers that may be missing in a row, time with quality ok \[s\].
const JITTER: Range<f64> = Range::new(0.0, 1000.0);
const MISSES: Range<u32> = Range::new(0, 1_000_000);
const GOOD_FOR_S: Range<f64> = Range::new(0.0, 60.0);

/// Versions of the FCI.
const VERSIONS: Range<u16> = Range::new(5, 10);

/// What the robot lets into command state \[mrad\], \[Nm\].
const ENTRY_MRAD: Range<f64> = Range::new(0.0, 1000.0);
const ENTRY_NM: Range<f64> = Range::new(0.0, 200.0);

/// Speed limit over the data sheet's; stiffness of the robot program \[Nm/rad\].
const SPEED_FACTOR: Range<f64> = Range::above(0.0, 10.0);
const KRL_STIFFNESS: Range<f64> = Range::above(0.0, 2000.0);

/// Options of `serve`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct ServeOptions {
    #[arg(value_name = "SCENARIO",
        help = format!("Built-in scenario ({}), or a TOML file: arm, start, contacts, what is \
            judged [default: two-level, of fci two-level-fr3]", built_in_names()))]
    experiment: Option<String>,
    /// The same
    #[arg(long, value_name = "SCENARIO", conflicts_with = "experiment")]
    scenario: Option<String>,
    /// Which robot: lwr (KUKA's FRI), fci (Franka's control interface)
    #[arg(long, default_value = "lwr")]
    robot: String,
    /// The arm: ideal, realistic
    #[arg(long, default_value = "realistic")]
    plant: String,
    /// The scenario's pushes and hands: on, off
    #[arg(long, default_value = "on")]
    contacts: String,
    /// Seed of mismatch, noise and faults, whole numbers from 0
    #[arg(long, default_value_t = 1, value_parser = whole(SEED))]
    seed: u64,
    #[arg(long, value_parser = whole(VERSIONS),
        help = format!("Of fci: version of the interface, {VERSIONS}; Panda: 5 [default: 10]"))]
    version: Option<u16>,
    /// Of fci: where it listens, ADDRESS or ADDRESS:PORT [default: 127.0.0.1:1337]
    #[arg(long, value_parser = fci::address)]
    address: Option<SocketAddr>,
    /// Where the client is, ADDRESS:PORT [default: 127.0.0.1:49938]
    #[arg(long, value_parser = peer)]
    remote: Option<SocketAddr>,
    /// Short for --remote 127.0.0.1:PORT
    #[arg(long, value_parser = whole(PORTS))]
    port: Option<u16>,
    /// A serial line instead: device or pseudo terminal
    #[arg(long, value_name = "PATH")]
    serial: Option<PathBuf>,
    #[arg(long, default_value_t = 0, value_parser = whole(OWN_PORTS),
        help = format!("Own port, {PORTS}; 0: any"))]
    local_port: u16,
    #[arg(long, value_parser = number(FRI_CYCLE_MS),
        help = format!("Cycle in ms, {FRI_CYCLE_MS} [default: the scenario's]"))]
    cycle_ms: Option<f64>,
    #[arg(long, value_parser = number(DURATION_S),
        help = format!("Length in s, {DURATION_S} [default: the scenario's]"))]
    duration: Option<f64>,
    #[arg(long, value_parser = whole(DEAD_CYCLES),
        help = format!("Cycles between the added torque and its effect, {DEAD_CYCLES} \
            [default: the plant's own]"))]
    dead_cycles: Option<u8>,
    /// Virtual time: as fast as both sides can, the same bytes every time
    #[arg(long)]
    lockstep: bool,
    /// Processor for the robot by the wall clock, from 0
    #[arg(long, value_parser = processor, conflicts_with = "lockstep")]
    cpu: Option<usize>,
    /// Who decides on command state: auto, handshake (the client, by user data)
    #[arg(long, default_value = "auto")]
    krl: String,
    /// What the robot makes of answers: joint-impedance, position
    #[arg(long, default_value = "joint-impedance")]
    scheme: String,
    /// What the robot adds to the torque itself: gravity, gravity-coriolis
    #[arg(long, default_value = "gravity")]
    robot_adds: String,
    #[arg(long, value_name = "DIR:KIND[@FROM-TO]",
        help = format!("What goes wrong on the link: DIR to-client, to-robot, both; KIND drop=P \
            duplicate=P reorder=P corrupt=P burst=PxN (P {SHARE}, N {BURST} in a row) delay=MS \
            jitter=MS ({DELAY_MS}) freeze; FROM-TO in s of the scenario. May be given more than once"))]
    fault: Vec<String>,
    /// Scenario time during which the drives are off, in s
    #[arg(long, value_name = "FROM-TO")]
    drives_off: Option<String>,
    #[arg(long, default_value = "60", value_parser = number(WAIT_S),
        help = format!("Time to wait for the first answer, and then for command state, in s, \
            {WAIT_S}"))]
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
    #[arg(long, default_value = "0.99", value_parser = number(SHARE),
        help = format!("Least share of answers in time for quality perfect, {SHARE}"))]
    perfect_rate: f64,
    /// The same for quality ok, not above that of perfect
    #[arg(long, default_value = "0.95", value_parser = number(SHARE))]
    ok_rate: f64,
    /// The same for quality bad, not above that of ok; below it: unacceptable
    #[arg(long, default_value = "0.8", value_parser = number(SHARE))]
    bad_rate: f64,
    #[arg(long, default_value = "0.25", value_parser = number(JITTER),
        help = format!("Largest jitter for quality perfect, in cycles, {JITTER}"))]
    perfect_jitter: f64,
    #[arg(long, default_value = "10", value_parser = whole(MISSES),
        help = format!("Missing answers in a row that are borne, whole numbers {MISSES}"))]
    misses: u32,
    #[arg(long, default_value = "0.2", value_parser = number(GOOD_FOR_S),
        help = format!("Time with quality ok before command state, in s, {GOOD_FOR_S}"))]
    good_for: f64,
    #[arg(long, default_value = "5", value_parser = number(ENTRY_MRAD),
        help = format!("Largest distance of jntPos from the commanded position on entry, in mrad, \
            {ENTRY_MRAD}"))]
    entry_mrad: f64,
    #[arg(long, default_value = "1", value_parser = number(ENTRY_NM),
        help = format!("Largest added torque on entry, in Nm, {ENTRY_NM}"))]
    entry_nm: f64,
    #[arg(long, default_value = "1.1", value_parser = number(SPEED_FACTOR),
        help = format!("Speed limit of jntPos over the data sheet's, {SPEED_FACTOR}"))]
    speed_factor: f64,
    #[arg(long, default_value = "1000", value_parser = number(KRL_STIFFNESS),
        help = format!("Stiffness of the robot program, in Nm/rad, {KRL_STIFFNESS}"))]
    krl_stiffness: f64,
    #[arg(long, default_value = "0.7", value_parser = number(SHARE),
        help = format!("Damping ratio of the robot program, {SHARE}"))]
    krl_damping: f64,
}

impl Thresholds {
    fn options(&self) -> Result<RobotOptions, Invalid> {
        let rating = RatingOptions {
            perfect_rate: self.perfect_rate,
            ok_rate: self.ok_rate,
            bad_rate: self.bad_rate,
            perfect_jitter: self.perfect_jitter,
            misses_max: self.misses,
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
            good_for_s: self.good_for,
            entry_position_rad: self.entry_mrad * 1e-3,
            entry_torque_nm: self.entry_nm,
            speed_factor: self.speed_factor,
            stiffness: self.krl_stiffness,
            damping: self.krl_damping,
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
        let kind = Kind::from_name(&self.robot)?;
        self.check_robot(kind)?;
        match kind {
            Kind::Lwr => self.run_lwr(),
            Kind::Fci => self.run_fci(),
        }
    }

    /// No option of the other robot.
    fn check_robot(&self, kind: Kind) -> Result<(), Invalid> {
        let fci = [
            ("--version", self.version.is_some()),
            ("--address", self.address.is_some()),
        ];
        kind.refuse(Kind::Fci, &fci)?;
        let thresholds = self.thresholds.options()?;
        let lwr = [
            ("--remote", self.remote.is_some()),
            ("--port", self.port.is_some()),
            ("--serial", self.serial.is_some()),
            ("--local-port", self.local_port != 0),
            ("--krl", self.krl != "auto"),
            ("--scheme", self.scheme != "joint-impedance"),
            ("--robot-adds", self.robot_adds != "gravity"),
            ("a threshold", thresholds != RobotOptions::default()),
        ];
        kind.refuse(Kind::Lwr, &lwr)
    }

    fn run_fci(&self) -> Result<u8, Invalid> {
        let service = FciService {
            address: self.address.unwrap_or(([127, 0, 0, 1], fci::PORT).into()),
            lockstep: self.lockstep,
            faults: self.faults()?,
            wait_s: self.wait,
        };
        let RobotSetup {
            scenario,
            plant,
            contacts,
            seed,
            plant_options,
            options,
        } = self.setup(Kind::Fci)?;
        let out = self.folder(&scenario)?;
        let number = self.version.unwrap_or(VERSIONS.max);
        let version = Version::from_number(number).map_err(Invalid::line)?;
        let mut fci = FciOptions::of(&scenario, version);
        fci.drives_off_s = options.drives_off_s;
        let setup = RobotSetup {
            scenario,
            plant,
            contacts,
            seed,
            plant_options,
            options: fci,
        };
        let Some(served) = fci::serve(&service, setup, self.cpu, &out)? else {
            return Ok(NO_CLIENT);
        };
        let fci::Served {
            files,
            robot,
            summary,
            text,
        } = served;
        self.conclude(files, &robot, &summary, &text, &out)
    }

    /// The output folder.
    fn folder(&self, scenario: &Scenario) -> Result<PathBuf, Invalid> {
        let own = || Path::new("out").join(format!("serve-{}", scenario.name));
        let out = self.out.clone().unwrap_or_else(own);
        needed(&out)?;
        Ok(out)
    }

    fn run_lwr(&self) -> Result<u8, Invalid> {
        let service = self.service()?;
        let setup = self.setup(Kind::Lwr)?;
        let scenario = setup.scenario.clone();
        let out = self.folder(&scenario)?;
        // By the least cycle and the longest run that the protocol has it stays bounded.
        announce(&scenario, f64::INFINITY)?;
        let mut client: Box<dyn Transport> = match &service.client {
            Client::Udp { remote, local_port } => Box::new(Udp::open(*remote, *local_port)?),
            Client::Serial(path) => Box::new(Serial::open(path)?),
        };
        let mut files = Files::create(Folder::claim(&out)?, &scenario, setup.contacts)?;
        tell(format_args!(
            "robot at the start posture, measurements go to {}; lines on standard input: push, \
             release, drives off|on, quit",
            service.client
        ));
        notes::say_what_is_unknown(&scenario, setup.plant);
        let mut operator = Operator::at_the_terminal();
        let mut robot = LwrRobot::new(setup);
        let mut sink = |instant: &Sample| files.push(instant);
        let realtime = (!service.lockstep).then(|| Realtime::ask_without_memory(self.cpu));
        if let Some(realtime) = &realtime {
            tell(realtime.line());
        }
        let end = service
            .run(&mut robot, &mut operator, &mut *client, &mut sink)
            .map_err(|error| Invalid::line(error).within(&service.client))?;
        if let Some(realtime) = &realtime {
            realtime.release();
        }
        match end {
            End::Finished => (),
            End::NoClient(why) => {
                tell(format_args!("error: {why}"));
                return Ok(NO_CLIENT);
            }
        }
        let mut summary = robot.summary();
        if let Some(link) = &mut summary.link {
            link.realtime = realtime;
        }
        let line = summary.link.as_ref().map_or(String::new(), link_line);
        self.conclude(files, &robot, &summary, &line, &out)
    }

    /// Writes the files, prints the rows, with `line` on the link; the exit code.
    fn conclude<B: ControlBox>(
        &self,
        files: Files,
        robot: &Robot<B>,
        summary: &Summary,
        line: &str,
        out: &Path,
    ) -> Result<u8, Invalid> {
        let setup = robot.setup();
        let scenario = &setup.scenario;
        let command = own_command();
        let choices = Choices {
            measurement: B::MEASUREMENT,
            options: setup.plant_options,
            ..Choices::default()
        };
        files.finish(scenario, summary, choices, Some(&command))?;
        let mut text = heading(scenario, setup.plant, setup.contacts, setup.seed);
        text += &table(&[summary]);
        text += line;
        text += &footer(summary, Some(out));
        print(&text)?;
        Ok(summary.verdict.exit_code())
    }

    fn service(&self) -> Result<Service, Invalid> {
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
        let here = |port| SocketAddr::from(([127, 0, 0, 1], port));
        let remote = self.remote.unwrap_or(here(self.port.unwrap_or(PORT)));
        Ok(Service {
            client: match &self.serial {
                Some(path) => Client::Serial(path.clone()),
                None => Client::Udp {
                    remote,
                    local_port: self.local_port,
                },
            },
            lockstep: self.lockstep,
            faults: self.faults()?,
            wait_s: self.wait,
        })
    }

    fn faults(&self) -> Result<Vec<Fault>, Invalid> {
        let faults = self.fault.iter().map(|spec| spec.parse::<Fault>());
        faults.collect()
    }

    fn setup(&self, kind: Kind) -> Result<RobotSetup<RobotOptions>, Invalid> {
        let asked = self.experiment.as_deref().or(self.scenario.as_deref());
        let mut scenario = Scenario::find(asked.unwrap_or(kind.scenario()))?;
        scenario.duration_s = self.duration.unwrap_or(scenario.duration_s);
        // That of the scenario may be too short for the protocol.
        let cycle = self.cycle_ms.unwrap_or(scenario.cycle_ms);
        scenario.cycle_ms = FRI_CYCLE_MS.check("--cycle-ms", cycle)?;
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
        let plant = PlantKind::from_name(&self.plant)?;
        let own = PlantOptions::of(plant, &scenario.arm().parameters);
        Ok(RobotSetup {
            scenario,
            plant,
            contacts: switch("--contacts", &self.contacts)?,
            seed: self.seed,
            plant_options: PlantOptions {
                dead_cycles: self.dead_cycles.map_or(own.dead_cycles, usize::from),
                ..own
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

/// The link in one line, and in another how the robot itself kept the wall clock.
fn link_line(link: &LinkFigures) -> String {
    let or_dash = |value: Option<f64>, digits: usize| {
        value.map_or("-".to_string(), |value| format!("{value:.digits$}"))
    };
    let own = link.own_lateness.as_ref().map_or(String::new(), |own| {
        format!(
            "robot's own lateness: {} cycles by more than {} ms, p99.9 {:.3} ms, max {:.3} ms; \
             arrivals by the clock of the {}\n",
            own.cycles,
            own.bound_ms,
            own.p999_ms,
            own.max_ms,
            own.stamp.name(),
        )
    });
    format!(
        "link: {} % in command state, {} answers, {} missed, {} late, {} rejected, {} lost, \
         latency {} ms, jitter {} ms, {} fallbacks, torque step {:.2} Nm\n{own}",
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
