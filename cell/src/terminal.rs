//! What the programs print. Nobody has to read it: a reader that has gone away, as
//! behind `| head`, must not end a run, and least of all one that moves a robot.

use std::fmt::Display;
use std::io::{self, Write};

use crate::invalid::Invalid;

/// Prints to standard output; a reader that closes it early is no error.
///
/// # Errors
/// Standard output cannot be written, such as a file on a full disk.
pub fn print(text: impl Display) -> Result<(), Invalid> {
    let mut out = io::stdout().lock();
    match write!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Invalid::line(error).within("standard output"))
        }
        _ => Ok(()),
    }
}

/// A line on standard error.
pub fn tell(line: impl Display) {
    show(format_args!("{line}\n"));
}

/// Text on standard error as it is, such as progress that is overwritten.
pub fn show(text: impl Display) {
    // There is no better place to report that this failed.
    let _ = write!(io::stderr(), "{text}");
}
