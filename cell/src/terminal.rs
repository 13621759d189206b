//! What the programs print. Nobody has to read it: a reader that has gone away, as
//! behind `| head`, must not end a run, and least of all one that moves a robot.

use std::fmt::Display;
use std::io::{self, BufRead, ErrorKind, Write};

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

/// The next line, none at the end. Of a line that is too long only the beginning is kept,
/// one letter more than `longest`; what is no text is replaced.
///
/// # Errors
/// The input cannot be read.
pub fn next_line(input: &mut impl BufRead, longest: usize) -> io::Result<Option<String>> {
    let mut line = Vec::new();
    let mut begun = false;
    loop {
        let bytes = match input.fill_buf() {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            bytes => bytes?,
        };
        let (read, end) = match bytes.iter().position(|&byte| byte == b'\n') {
            Some(length) => (length, 1),
            None => (bytes.len(), 0),
        };
        line.extend(bytes.iter().take(read.min(longest + 1 - line.len())));
        begun |= read + end > 0;
        let over = read + end == 0;
        input.consume(read + end);
        if over || end > 0 {
            return Ok(begun.then(|| String::from_utf8_lossy(&line).into_owned()));
        }
    }
}
