//! Writes a frozen cycle into a file, or looks whether one is as it would be written.

use std::path::PathBuf;
use std::process::ExitCode;

use cell::arm::robot::Robot;
use cell::scenario::Scenario;
use clap::{Parser, ValueEnum};
use controller_core::arm::ArmParameters;
use controller_core::joint::DOF;
use controller_core::law::null_space::{NullDamping, Posture};
use controller_core::{Axes, ControllerConfig, NullSpace, Task, TaskGains, TaskSet};
use freeze::{Precision, Request, freeze};

/// The control cycle of one arm and its levels as a straight line, written from the readable text
/// with the same bits. Gains, limits, references and the body of the last link stay inputs.
#[derive(Debug, Parser)]
#[command(name = "freeze", version)]
struct Options {
    /// Scenario or scenario file whose arm, levels, gains and cycle are taken
    #[arg(long, conflicts_with_all = ["arm", "levels"], required_unless_present_all = ["arm", "levels"])]
    scenario: Option<String>,
    /// Arm or arm file
    #[arg(long, requires = "levels")]
    arm: Option<String>,
    /// Points and their axes, highest priority first: "flange:xyz, wrist:xy"
    #[arg(long, requires = "arm")]
    levels: Option<String>,
    /// The law within limits, or the exact one
    #[arg(long, value_enum, default_value = "on")]
    limits: Switch,
    /// Of all numbers
    #[arg(long, value_enum, default_value = "f64")]
    precision: Width,
    /// Write nothing; fail where the file is not as it would be written
    #[arg(long)]
    check: bool,
    /// The file
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Switch {
    On,
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Width {
    F32,
    F64,
}

/// Gains that a controller starts with where no scenario brings its own: K_p \[1/s2\] and K_d
/// \[1/s\]; K_q as a share of the torque limit \[1/rad\], c of D = c M \[1/s\]; K_I \[1/s\]; the
/// cycle \[s\].
const STIFFNESS: f64 = 400.0;
const DAMPING: f64 = 40.0;
const NULL_SHARE: f64 = 0.1;
const NULL_DAMPING: f64 = 10.0;
const OBSERVER: f64 = 50.0;
const CYCLE_S: f64 = 0.002;

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(options: &Options) -> Result<bool, String> {
    let (arm, config, job) = match (&options.scenario, &options.arm, &options.levels) {
        (Some(name), _, _) => of_scenario(name)?,
        (None, Some(arm), Some(levels)) => of_levels(arm, levels)?,
        _ => return Err("neither a scenario nor an arm with its levels".into()),
    };
    let frozen = freeze(&Request {
        arm: &arm,
        config: &config,
        limits: options.limits == Switch::On,
        precision: match options.precision {
            Width::F32 => Precision::F32,
            Width::F64 => Precision::F64,
        },
        job: &job,
    })
    .map_err(|error| format!("{job}: {error}"))?;
    let (text, file) = (frozen.rust(), options.out.display());
    if options.check {
        let committed =
            std::fs::read_to_string(&options.out).map_err(|error| format!("'{file}': {error}"))?;
        let same = committed.replace('\r', "") == text;
        if !same {
            eprintln!("'{file}' is not as it would be written: freeze again without --check");
        }
        return Ok(same);
    }
    std::fs::write(&options.out, &text).map_err(|error| format!("'{file}': {error}"))?;
    println!(
        "{file}: {job}, {} operations, {} bytes of text",
        frozen.operations(),
        text.len()
    );
    Ok(true)
}

type Job = (ArmParameters, ControllerConfig, String);

fn of_scenario(name: &str) -> Result<Job, String> {
    let scenario = Scenario::find(name).map_err(|error| error.to_string())?;
    let config = scenario
        .controller_config(0)
        .map_err(|error| error.to_string())?;
    Ok((scenario.arm().parameters, config, scenario.name.to_string()))
}

fn of_levels(arm: &str, levels: &str) -> Result<Job, String> {
    let robot = Robot::found(arm).map_err(|error| error.to_string())?;
    let table = *robot.table().map_err(|error| error.to_string())?;
    let tasks: Vec<Task> = levels
        .split(',')
        .map(|level| task(&table, level.trim()))
        .collect::<Result<_, _>>()?;
    let tasks = TaskSet::new(&tasks).map_err(|error| error.to_string())?;
    let stiffness: [f64; DOF] = core::array::from_fn(|i| NULL_SHARE * table.links[i].torque_limit);
    let mut null_space = NullSpace::diagonal(stiffness, [1.0; DOF]);
    null_space.damping = NullDamping::Inertia(NULL_DAMPING);
    null_space.posture = Posture::Constant;
    let config = ControllerConfig {
        tasks,
        null_space,
        observer_gain: [OBSERVER; DOF],
        cycle_s: CYCLE_S,
        dead_cycles: 0,
    };
    Ok((table, config, levels.to_string()))
}

/// A level as it is written, `point:axes`.
fn task(arm: &ArmParameters, level: &str) -> Result<Task, String> {
    let points = || {
        let names: Vec<&str> = arm.points.iter().map(|point| point.name).collect();
        names.join(", ")
    };
    let Some((name, axes)) = level.split_once(':') else {
        return Err(format!(
            "level '{level}'; allowed: POINT:AXES with a point of {}",
            points()
        ));
    };
    let Some(point) = arm.point(name) else {
        return Err(format!(
            "point '{name}' of level '{level}'; allowed: {}",
            points()
        ));
    };
    let Some(axes) = Axes::from_name(axes) else {
        return Err(format!(
            "axes '{axes}' of level '{level}'; allowed: any of x, y, z, in this order"
        ));
    };
    Ok(Task::position(
        point,
        axes,
        TaskGains::uniform(STIFFNESS, DAMPING),
    ))
}
