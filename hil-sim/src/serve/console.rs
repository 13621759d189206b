//! What a person types while the robot is served, and Ctrl-C.

use std::io::BufRead;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread;

use crate::robot::Robot;
use crate::sample::Stop;
use cell::invalid::Invalid;
use cell::ranges::{DURATION_S, Range};
use cell::scenario::PointSpec;
use cell::terminal::tell;

/// One line for a line that means nothing.
const HELP: &str = "allowed: push POINT FX FY FZ SECONDS (N, base-plate axes), release, \
                    drives off|on, quit";

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
    /// Reads a line; none if it is empty.
    ///
    /// # Errors
    /// What cannot be used, and what is allowed.
    pub fn read(line: &str) -> Result<Option<Self>, Invalid> {
        let words: Vec<_> = line.split_whitespace().collect();
        Ok(Some(match words[..] {
            [] => return Ok(None),
            ["push", point, x, y, z, seconds] => {
                let point = PointSpec::Name(point.to_string());
                point.validate()?;
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
        let (sender, lines) = channel();
        thread::spawn(move || {
            for line in std::io::stdin().lock().lines().map_while(Result::ok) {
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
    pub fn attend(&mut self, robot: &mut Robot) {
        if self.interrupted.load(Ordering::Relaxed) {
            robot.abort(Stop::Interrupted);
        }
        let Some(lines) = &self.lines else { return };
        while let Ok(line) = lines.try_recv() {
            match Wish::read(&line) {
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

    #[test]
    fn lines_are_read() {
        assert!(matches!(
            Wish::read("push elbow 0 35.5 -1 2"),
            Ok(Some(Wish::Push(_, [0.0, 35.5, -1.0], 2.0)))
        ));
        assert!(matches!(Wish::read(" release "), Ok(Some(Wish::Release))));
        assert!(matches!(
            Wish::read("drives off"),
            Ok(Some(Wish::Drives(false)))
        ));
        assert!(matches!(Wish::read(""), Ok(None)));
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
            let error = Wish::read(line).expect_err(line).to_string();
            assert_eq!(error.lines().count(), 1);
            assert!(error.contains("allowed"), "{error}");
        }
    }
}
