//! The controller on the emulated board against `hil-sim serve`: the same motion as
//! without a board, and safe outputs when something stops.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use crate::board::{self, Board, Medium};
use crate::tools::{Outcome, QEMU, Trouble, find, program, run as output_of, work};

/// Motion over the serial line \[s\]: the emulated port takes about 40 ms for the
/// bytes of a cycle.
const SERIAL_S: &str = "1";

/// Over Ethernet the whole motion, an emergency stop and a robot that is taken away;
/// over the serial line the beginning of the motion, a minute's work for the emulator.
/// Each check prints what it saw.
pub fn run(medium: Medium) -> Outcome {
    find(&[QEMU])?;
    let bench = Bench::new()?;
    if medium == Medium::Serial {
        return bench.serial();
    }
    let whole = bench.whole()?;
    let stopped = bench.interrupted("emergency stop", "EmergencyStop", |board, _| {
        fs::write(board.stop_file(), "")
    })?;
    let gone = bench.interrupted("robot taken away", "silent", |_, robot| robot.0.kill())?;
    Ok(whole && stopped && gone)
}

struct Bench {
    hil_sim: PathBuf,
    /// Where the robot leaves its trace.
    served: PathBuf,
    /// Trace of the same motion without a board.
    expected: String,
}

/// A robot that serves; ends with this value at the latest.
struct Robot(Child);

impl Drop for Robot {
    fn drop(&mut self) {
        // Has ended already, or is of no more use.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Bench {
    fn new() -> Result<Self, Trouble> {
        let hil_sim = program("hil-sim", "hil-sim")?;
        let folder = work()?.join("fri-expected");
        let mut command = Command::new(&hil_sim);
        command.args(["run", "two-level", "--measurement", "fri", "--out"]);
        output_of(command.arg(&folder))?;
        Ok(Self {
            hil_sim,
            served: work()?.join("fri-served"),
            expected: fs::read_to_string(folder.join("trace.csv"))?,
        })
    }

    /// Starts the board, and the robot as soon as the board says where it is.
    fn start(&self, medium: Medium, more: &[&str]) -> Result<(Board, Robot), Trouble> {
        // An old trace would count.
        if self.served.exists() {
            fs::remove_dir_all(&self.served)?;
        }
        let mut board = Board::start(medium)?;
        let said = std::iter::from_fn(|| board.line()).find_map(|it| board::serve_options(&it));
        let none = || Trouble::new("the board ended before it had a link".into());
        let robot = Command::new(&self.hil_sim)
            .args(["serve", "--scenario", "two-level", "--lockstep"])
            .args(said.ok_or_else(none)?)
            .args(more)
            .arg("--out")
            .arg(&self.served)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()?;
        Ok((board, Robot(robot)))
    }

    /// The robot's trace against the expected one, over its whole length.
    fn trace(&self) -> Result<(usize, bool), Trouble> {
        let trace = fs::read_to_string(self.served.join("trace.csv"))?;
        let cycles = trace.lines().count().saturating_sub(1);
        Ok((cycles, cycles > 0 && self.expected.starts_with(&trace)))
    }

    /// The whole motion over Ethernet.
    fn whole(&self) -> Outcome {
        let (mut board, mut robot) = self.start(Medium::Ethernet, &[])?;
        let last = std::iter::from_fn(|| board.line())
            .last()
            .unwrap_or_default();
        let good = board.end()? & robot.0.wait()?.success();
        let (cycles, equal) = self.trace()?;
        let good = good && equal && cycles + 1 == self.expected.lines().count();
        let verdict = if good { "equal" } else { "NOT as" };
        println!(
            "Ethernet: {last}; trace of {cycles} cycles {verdict} to that without a board, in every byte"
        );
        Ok(good)
    }

    /// Does something in the middle of the motion: the board has to say `sign`, with safe
    /// outputs.
    fn interrupted(
        &self,
        what: &str,
        sign: &str,
        act: impl Fn(&Board, &mut Robot) -> std::io::Result<()>,
    ) -> Outcome {
        let (mut board, mut robot) = self.start(Medium::Ethernet, &[])?;
        let mut seen = None;
        while let Some(line) = board.line() {
            if line.contains(" moving:") {
                act(&board, &mut robot)?;
            }
            if line.contains(sign) && seen.is_none() {
                seen = Some(line);
            }
        }
        let success = board.end()?;
        let line = seen.unwrap_or_else(|| "was not seen".into());
        println!("{what}: {line}; exit code {}", i32::from(!success));
        Ok(line.contains("drives 0 heartbeat 0") && !success)
    }

    /// The beginning of the motion over the serial line.
    fn serial(&self) -> Outcome {
        let (_board, mut robot) = self.start(Medium::Serial, &["--duration", SERIAL_S])?;
        robot.0.wait()?;
        let (cycles, equal) = self.trace()?;
        let verdict = if equal { "equal" } else { "NOT equal" };
        println!("serial line: first {cycles} cycles of the trace {verdict} in every byte");
        Ok(equal)
    }
}
