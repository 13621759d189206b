//! `hil-sim`: see the library of the same name.

use std::process::ExitCode;

fn main() -> ExitCode {
    hil_sim::cli::main()
}
