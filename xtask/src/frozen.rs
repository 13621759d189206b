//! The program that writes frozen cycles.

use crate::tools::{Outcome, cargo};

/// Runs it with these arguments.
pub fn run(words: &[&str]) -> Outcome {
    let mut program = cargo("run");
    program.args(["--release", "-p", "freeze", "--features", "cli", "--"]);
    Ok(program.args(words).status()?.success())
}
