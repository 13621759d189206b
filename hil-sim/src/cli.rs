//! The command line: what it accepts, and one line for everything it does not.

mod files;
mod gains;
mod model;
mod notes;
mod run;
mod serve;
mod study;

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::explain::explain_in;
use cell::arguments::usage::{self, USAGE};
use cell::file;
use cell::invalid::Invalid;
use cell::scenario::{Scenario, built_in_names};
use cell::terminal::{print, tell};

pub use gains::GainsOptions;
pub use model::ModelOptions;
pub use run::RunOptions;
pub use serve::ServeOptions;
pub use study::StudyOptions;

/// Hardware-in-the-loop simulation of strict-priority torque control on a
/// 7-joint arm.
///
/// Without arguments: the two-level experiment with three controllers, results
/// in out/two-level.
#[derive(Debug, Parser)]
#[command(
    name = "hil-sim",
    version,
    after_help = "Exit codes: 0 no limit failed, 1 one did or a joint left its range, \
2 usage or configuration error, 3 stopped by safety, a signal or by hand, 4 no client."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario and judge it: report, summary, trace and figures in the output folder
    Run(Box<RunOptions>),
    /// Be the robot, for a client that runs elsewhere: KUKA's FRI over UDP, or Franka's FCI
    #[command(
        after_help = "Lines on standard input while it serves: push POINT FX FY FZ SECONDS \
(N, base-plate axes), release, drives off, drives on, quit."
    )]
    Serve(Box<ServeOptions>),
    /// All experiments of the paper: every claim with a number and a verdict
    Paper {
        /// Output folder
        #[arg(long, default_value = "out/paper")]
        out: PathBuf,
    },
    /// Many runs near and beyond limits: what the law keeps in all of them
    Study(StudyOptions),
    /// Arms of one's own: from a URDF to an arm file, and what an arm is like
    Model(ModelOptions),
    /// Propose gains for an arm and a cycle, as TOML for a scenario file
    Gains(GainsOptions),
    /// Print a built-in scenario as commented TOML
    Scenario {
        #[arg(help = built_in_names())]
        name: String,
    },
    /// Lay one control cycle open: JSON state in, every quantity of the law out
    Explain {
        /// JSON file, or - for standard input; its fields: docs/explain.md
        #[arg(default_value = "-")]
        file: PathBuf,
    },
}

/// What the program can be asked for.
const COMMANDS: &[&str] = &[
    "run", "serve", "paper", "study", "model", "gains", "scenario", "explain",
];

/// Runs the program with the arguments of the process.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            let (program, commands) = match std::env::args_os()
                .nth(1)
                .as_deref()
                .and_then(std::ffi::OsStr::to_str)
            {
                Some("model") => ("hil-sim model", model::COMMANDS),
                _ => ("hil-sim", COMMANDS),
            };
            return usage::report(program, commands, &error);
        }
    };
    let outcome = match cli.command {
        None => run::comparison(),
        Some(Command::Run(options)) => options.run(),
        Some(Command::Serve(options)) => options.run(),
        Some(Command::Paper { out }) => files::needed(&out).and_then(crate::paper::run),
        Some(Command::Study(options)) => options.run(),
        Some(Command::Model(options)) => options.run(),
        Some(Command::Gains(options)) => options.run(),
        Some(Command::Scenario { name }) => {
            Scenario::built_in_text(&name).and_then(print).map(|()| 0)
        }
        Some(Command::Explain { file }) => explain_file(&file).and_then(print).map(|()| 0),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            tell(format_args!("error: {error}"));
            ExitCode::from(USAGE)
        }
    }
}

fn explain_file(path: &Path) -> Result<String, Invalid> {
    let readable = |error| {
        Invalid::new(
            "state",
            path.display(),
            format_args!("a readable JSON file, or - ({error})"),
        )
    };
    let by_hand = path.as_os_str() == "-";
    if by_hand && io::stdin().is_terminal() {
        tell("reading the state from standard input; see docs/explain.md for its fields");
    }
    let (text, place) = match by_hand {
        true => (file::text_of(io::stdin()), "standard input".into()),
        false => (file::text(path), path.display().to_string()),
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let output = explain_in(&text.map_err(readable)?, folder);
    let output = output.map_err(|error| error.within(place))?;
    let mut json = serde_json::to_string_pretty(&output).map_err(Invalid::line)?;
    json.push('\n');
    Ok(json)
}
