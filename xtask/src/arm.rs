//! The application image with its log.

use std::io::Write;
use std::process::{Command, Stdio};

use crate::tools::{Need, Outcome, Tools, failed};

/// Runs it and decodes what it logs.
pub fn run() -> Outcome {
    let tools = Tools::find(&[Need::Emulator, Need::LogDecoder])?;
    let image = tools.image("arm", &[])?;
    let output = tools.emulate(&image, &[])?;
    let mut decoder = Command::new("defmt-print");
    decoder.arg("-e").arg(&image).stdin(Stdio::piped());
    let mut decoder = decoder.stdout(Stdio::piped()).spawn()?;
    if let Some(mut stdin) = decoder.stdin.take() {
        stdin.write_all(&output.stdout)?;
    }
    let log = decoder.wait_with_output()?;
    print!("{}", String::from_utf8_lossy(&log.stdout));
    if !output.status.success() {
        return Err(failed("the application", &output));
    }
    Ok(log.status.success())
}
