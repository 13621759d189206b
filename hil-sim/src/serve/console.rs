//! What a person types while the robot is served, and Ctrl-C.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

use crate::robot::{ControlBox, Robot};
use crate::sample::Stop;
use cell::invalid::Invalid;
use cell::ranges::{DURATION_S, Range};
use cell::scenario::{EquippedArm, PointSpec};
use cell::terminal::{next_line, tell};

/// One line for a line that means nothing.
const HELP: &str = "allowed: push POINT FX FY FZ SECONDS (N, base-plate axes), release, \
                    drives off|on, quit";

/// Longest line \[bytes\].
const LONGEST: usize = 200;

/// Lines that wait for the robot; whoever writes more waits.
const QUEUE: usize = 16;

/// A coordinate of a force that can be typed \[N\].
const FORCE_N: Range<f64> = Range::new(-1000.0, 1000.0);

/// What a line asks for.
#[derive(Clone, Debug)]
pub enum Wish {
    /// A force \[N\] on a point for a time \[s\].
    Push(PointSpec, [f64; 3], f64),
    /// No more forces.
    Release,
    /// Power for the drives.
    Drives(bool),
    /// The end.
    Quit,
}

impl Wish {
    /// Reads a line; none if it is empty. Points are those of `arm`.
    ///
    /// # Errors
    /// What cannot be used, and what is allowed.
    pub fn read(line: &str, arm: &EquippedArm) -> Result<Option<Self>, Invalid> {
        if line.len() > LONGEST {
            let allowed = format_args!("at most {LONGEST} bytes");
            return Err(Invalid::new("line", "longer", allowed));
        }
        let words: Vec<_> = line.split_whitespace().collect();
        Ok(Some(match words[..] {
            [] => return Ok(None),
            ["push", point, x, y, z, seconds] => {
                let point = PointSpec::Name(point.to_string());
                point.validate(arm)?;
                let number = |text: &str| {
                    let value = text.parse().ok().filter(|value| FORCE_N.contains(*value));
                    value.ok_or_else(|| Invalid::new("force", text, format_args!("{FORCE_N} N")))
                };
                let force = [number(x)?, number(y)?, number(z)?];
                let seconds = seconds
                    .parse()
                    .map_err(|_| Invalid::new("seconds", seconds, "a number"))?;
                Self::Push(point, force, DURATION_S.check("seconds", seconds)?)
            }
            ["release"] => Self::Release,
            ["drives", "on"] => Self::Drives(true),
            ["drives", "off"] => Self::Drives(false),
            ["quit"] => Self::Quit,
            _ => return Err(Invalid::line(format_args!("'{line}': {HELP}"))),
        }))
    }
}

/// Lines and interrupts, as they come.
pub struct Operator {
    lines: Option<Receiver<String>>,
    interrupted: Arc<AtomicBool>,
}

impl Operator {
    /// Nobody.
    #[must_use]
    pub fn absent() -> Self {
        Self {
            lines: None,
            interrupted: Arc::default(),
        }
    }

    /// Whoever types on standard input and presses Ctrl-C.
    #[must_use]
    pub fn at_the_terminal() -> Self {
        let interrupted = Arc::<AtomicBool>::default();
        let flag = Arc::clone(&interrupted);
        // Without a handler Ctrl-C ends the program, which is what it did before.
        let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
        let (sender, lines) = sync_channel(QUEUE);
        thread::spawn(move || {
            let mut input = io::stdin().lock();
            while let Ok(Some(line)) = next_line(&mut input, LONGEST) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Self {
            lines: Some(lines),
            interrupted,
        }
    }

    /// Does what was asked for since the last call.
    pub fn attend<B: ControlBox>(&mut self, robot: &mut Robot<B>) {
        if self.interrupted.load(Ordering::Relaxed) {
            robot.abort(Stop::Interrupted);
        }
        let Some(lines) = &self.lines else { return };
        // No more of them: the writer may be faster than this is.
        let arm = robot.setup().scenario.arm();
        for line in lines.try_iter().take(QUEUE) {
            match Wish::read(&line, &arm) {
                Ok(None) => (),
                Ok(Some(Wish::Push(point, force, seconds))) => robot.push(point, force, seconds),
                Ok(Some(Wish::Release)) => robot.release(),
                Ok(Some(Wish::Drives(on))) => robot.switch_drives(on),
                Ok(Some(Wish::Quit)) => robot.abort(Stop::Quit),
                Err(error) => tell(error),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Option<Wish>, Invalid> {
        Wish::read(line, &EquippedArm::of(&arms::LWR_IV))
    }

    #[test]
    fn lines_are_read() {
        assert!(matches!(
            read("push elbow 0 35.5 -1 2"),
            Ok(Some(Wish::Push(_, [0.0, 35.5, -1.0], 2.0)))
        ));
        assert!(matches!(read(" release "), Ok(Some(Wish::Release))));
        assert!(matches!(read("drives off"), Ok(Some(Wish::Drives(false)))));
        assert!(matches!(read(""), Ok(None)));
    }

    #[test]
    fn lines_that_are_no_text_or_too_long_are_told_and_the_next_is_read() {
        let input = [b"\xFF\xFE\n", &[0; 100_000][..], b"\n\nquit\nrelease"].concat();
        // Pieces of 7 bytes: lines begin and end anywhere in them.
        let mut input = io::BufReader::with_capacity(7, &input[..]);
        let mut lines = Vec::new();
        while let Some(line) = next_line(&mut input, LONGEST).expect("memory") {
            assert!(line.len() <= LONGEST + 1);
            lines.push(read(&line));
        }
        let [text, long, empty, quit, last] = &lines[..] else {
            panic!("{lines:?}");
        };
        for (wrong, part) in [(text, "'\u{FFFD}\u{FFFD}'"), (long, "at most 200 bytes")] {
            let error = wrong.as_ref().expect_err(part).to_string();
            assert!(error.contains(part), "{error}");
        }
        assert!(matches!(empty, Ok(None)));
        assert!(matches!(quit, Ok(Some(Wish::Quit))));
        assert!(matches!(last, Ok(Some(Wish::Release))));
    }

    #[test]
    fn wrong_lines_get_one_line() {
        for line in [
            "push",
            "push knee 0 0 0 1",
            "push elbow a 0 0 1",
            "push elbow 0 0 NaN 1",
            "push elbow 0 0 1e9 1",
            "push elbow 0 0 1 0",
            "push elbow 0 0 1 x",
            "drives",
            "hold",
            "quit now",
        ] {
            let error = read(line).expect_err(line).to_string();
            assert_eq!(error.lines().count(), 1);
            assert!(error.contains("allowed"), "{error}");
        }
    }
}
