//! The command line, and one line for everything that cannot be used.

mod fci;
mod lwr;
mod options;
mod source;
mod telling;

use std::process::ExitCode;

use cell::arguments::usage;
use cell::arguments::values::{number, processor};
use cell::invalid::Invalid;
use cell::names::{Named as _, RobotInterface};
use cell::ranges::CYCLE_MS;
use cell::scenario::Scenario;
use cell::terminal::{print, tell};
use clap::{Parser, Subcommand};

use self::options::RunOptions;
use crate::doctor;

/// The torque controller on a PC: answers a KUKA LWR by the Fast Research Interface, or a Franka
/// robot by the Franka Control Interface.
#[derive(Debug, Parser)]
#[command(
    name = "firmware-host",
    version,
    after_help = "Exit codes: 0 done, 1 doctor: the cycle is not held, 2 usage or configuration error, \
                  3 stopped by safety, 4 no robot, or one that takes no motion."
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
        /// The robot whose datagrams are imitated: lwr, fci
        #[arg(long, default_value = "lwr")]
        robot: String,
        #[arg(long, value_parser = number(CYCLE_MS),
            help = format!("Cycle in ms, {CYCLE_MS} [default: 2 of lwr, 1 of fci]"))]
        cycle_ms: Option<f64>,
        /// Processor for the control thread, from 0
        #[arg(long, value_parser = processor)]
        cpu: Option<usize>,
    },
}

/// Runs the program with the arguments of the process.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage::report("firmware-host", &["run", "doctor"], &error),
    };
    let outcome = match cli.command {
        Command::Run(options) => run(&options),
        Command::Doctor {
            robot,
            cycle_ms,
            cpu,
        } => examine(&robot, cycle_ms, cpu),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            tell(format_args!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

/// Runs the motion: the exit code.
fn run(options: &RunOptions) -> Result<u8, Invalid> {
    let robot = options.robot()?;
    options.refuse_options_of_others(robot)?;
    let scenario = Scenario::find(options.scenario())?;
    match robot {
        RobotInterface::Lwr => options.run_lwr(&scenario),
        RobotInterface::Fci => options.run_fci(&scenario),
    }
}

fn examine(robot: &str, cycle_ms: Option<f64>, cpu: Option<usize>) -> Result<u8, Invalid> {
    let robot = RobotInterface::from_name(robot)?;
    let link = doctor::Link::of(robot);
    let cycle_s = cycle_ms.map_or(link.cycle_s, |cycle_ms| cycle_ms / 1e3);
    let findings = doctor::examine(&link, cycle_s, cpu)
        .map_err(|error| Invalid::line(error).within("loopback"))?;
    print(findings.report())?;
    Ok(u8::from(!findings.holds()))
}
