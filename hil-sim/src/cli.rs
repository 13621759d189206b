//! The command line: what it accepts, and one line for everything it does not.

mod files;
mod run;
mod serve;
pub mod usage;

use std::io::{self, IsTerminal, Read, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::explain::explain;
use crate::invalid::Invalid;
use crate::scenario::Scenario;

pub use run::RunOptions;
pub use serve::ServeOptions;

/// Exit code of anything that cannot be used.
const USAGE: u8 = 2;

/// Hardware-in-the-loop simulation of strict-priority torque control on a
/// 7-joint arm.
///
/// Without arguments: the two-level experiment with three controllers, results
/// in out/two-level.
#[derive(Debug, Parser)]
#[command(
    name = "hil-sim",
    version,
    after_help = "Exit codes: 0 pass, 1 an acceptance limit failed, \
2 usage or configuration error, 3 stopped by safety or by hand, 4 no client."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario and judge it: report, summary, trace and figures in the output folder
    Run(Box<RunOptions>),
    /// Be the robot: FRI over UDP, for a client that runs elsewhere
    Serve(Box<ServeOptions>),
    /// All experiments of the paper: every claim with a number and a verdict
    Paper {
        /// Output folder
        #[arg(long, default_value = "out/paper")]
        out: PathBuf,
    },
    /// Print a built-in scenario as commented TOML
    Scenario {
        /// Its name
        name: String,
    },
    /// Lay one control cycle open: JSON state in, every quantity of the law out
    Explain {
        /// JSON file, or - for standard input
        #[arg(default_value = "-")]
        file: PathBuf,
    },
}

/// What the program can be asked for.
const COMMANDS: &[&str] = &["run", "serve", "paper", "scenario", "explain"];

/// Runs the program with the arguments of the process.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage::report("hil-sim", COMMANDS, &error),
    };
    let outcome = match cli.command {
        None => run::comparison(),
        Some(Command::Run(options)) => options.run(),
        Some(Command::Serve(options)) => options.run(),
        Some(Command::Paper { out }) => crate::paper::run(&out),
        Some(Command::Scenario { name }) => Scenario::built_in_text(&name).and_then(print),
        Some(Command::Explain { file }) => explain_file(&file).and_then(|text| print(&text)),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(USAGE)
        }
    }
}

fn explain_file(file: &std::path::Path) -> Result<String, Invalid> {
    let readable = |error| {
        Invalid::new(
            "state",
            file.display(),
            format_args!("a readable JSON file, or - ({error})"),
        )
    };
    let mut text = String::new();
    if file.as_os_str() == "-" {
        if io::stdin().is_terminal() {
            eprintln!("reading the state from standard input; see docs/explain.md for its fields");
        }
        io::stdin().read_to_string(&mut text).map_err(readable)?;
    } else {
        text = std::fs::read_to_string(file).map_err(readable)?;
    }
    let place = if file.as_os_str() == "-" {
        "standard input".into()
    } else {
        file.display().to_string()
    };
    let output = explain(&text).map_err(|error| error.within(place))?;
    let mut json = serde_json::to_string_pretty(&output).map_err(Invalid::line)?;
    json.push('\n');
    Ok(json)
}

/// Prints to standard output; a reader that closes it early is no error.
fn print(text: &str) -> Result<u8, Invalid> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Invalid::line(error).within("standard output"))
        }
        _ => Ok(0),
    }
}
