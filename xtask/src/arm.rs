//! The application image with its log.

use std::io::Write;
use std::process::{Command, Stdio};

use crate::tools::{DEFMT, Outcome, QEMU, emulate, find, good, image};

/// Runs it and decodes what it logs.
pub fn run() -> Outcome {
    find(&[QEMU, DEFMT])?;
    let image = image("arm", "")?;
    let output = emulate(&image, &[])?;
    let mut decoder = Command::new(DEFMT);
    decoder.arg("-e").arg(&image).stdin(Stdio::piped());
    let mut decoder = decoder.spawn()?;
    if let Some(mut stdin) = decoder.stdin.take() {
        stdin.write_all(&output.stdout)?;
    }
    let decoded = decoder.wait()?;
    good("the application", &output)?;
    Ok(decoded.success())
}
