//! The command line of the bridge.

use std::process::ExitCode;

fn main() -> ExitCode {
    firmware_host::cli::main()
}
