//! The controller on the emulated board against `hil-sim serve`: the same motion as
//! without a board, and safe outputs when something stops.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use crate::board::{self, Board, Medium};
use crate::tools::{Need, Outcome, Tools, Trouble, failed};

/// Motion over the serial line \[s\]: the emulated port takes about 40 ms for the
/// bytes of a cycle.
const SERIAL_S: &str = "1";

/// Over Ethernet the whole motion, an emergency stop and a robot that is taken away;
/// over the serial line the beginning of the motion, a minute's work for the emulator.
/// Each check prints what it saw.
pub fn run(medium: Medium) -> Outcome {
    let tools = Tools::find(&[Need::Emulator])?;
    let bench = Bench::new(&tools)?;
    match medium {
        Medium::Ethernet => {
            let whole = bench.whole()?;
            let stopped = bench.emergency_stop()?;
            let gone = bench.silence()?;
            Ok(whole && stopped && gone)
        }
        Medium::Serial => bench.serial(),
    }
}

struct Bench<'a> {
    tools: &'a Tools,
    hil_sim: PathBuf,
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

impl<'a> Bench<'a> {
    fn new(tools: &'a Tools) -> Result<Self, Trouble> {
        let hil_sim = tools.program("hil-sim")?;
        let folder = tools.work.join("fri-expected");
        let output = Command::new(&hil_sim)
            .args(["run", "two-level", "--measurement", "fri", "--out"])
            .arg(&folder)
            .output()?;
        if !output.status.success() {
            return Err(failed("hil-sim run two-level --measurement fri", &output));
        }
        Ok(Self {
            tools,
            hil_sim,
            expected: fs::read_to_string(folder.join("trace.csv"))?,
        })
    }

    fn folder(&self) -> PathBuf {
        self.tools.work.join("fri-served")
    }

    /// Starts the board, and the robot as soon as the board says where it is.
    fn start(&self, medium: Medium, more: &[&str]) -> Result<(Board, Robot), Trouble> {
        // An old trace would count.
        if self.folder().exists() {
            fs::remove_dir_all(self.folder())?;
        }
        let mut board = Board::start(self.tools, medium)?;
        let options = loop {
            let line = board
                .line()
                .ok_or_else(|| Trouble::Content("the board ended before it had a link".into()))?;
            if let Some(options) = board::serve_options(&line) {
                break options;
            }
        };
        let robot = Command::new(&self.hil_sim)
            .args(["serve", "--scenario", "two-level", "--lockstep"])
            .args(options)
            .args(more)
            .arg("--out")
            .arg(self.folder())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()?;
        Ok((board, Robot(robot)))
    }

    /// The robot's trace against the expected one, over its whole length.
    fn trace(&self) -> Result<(usize, bool), Trouble> {
        let trace = fs::read_to_string(self.folder().join("trace.csv"))?;
        let cycles = trace.lines().count().saturating_sub(1);
        Ok((cycles, cycles > 0 && self.expected.starts_with(&trace)))
    }

    /// The whole motion over Ethernet.
    fn whole(&self) -> Outcome {
        let (mut board, mut robot) = self.start(Medium::Ethernet, &[])?;
        let mut last = String::new();
        while let Some(line) = board.line() {
            last = line;
        }
        let good = board.end()? & robot.0.wait()?.success();
        let (cycles, equal) = self.trace()?;
        let complete = cycles == self.expected.lines().count().saturating_sub(1);
        let verdict = if good && equal && complete {
            "equal"
        } else {
            "NOT as"
        };
        println!(
            "Ethernet: {last}; trace of {cycles} cycles {verdict} to that without a board, in every byte"
        );
        Ok(good && equal && complete)
    }

    /// Pulls the emergency stop in the middle of the motion.
    fn emergency_stop(&self) -> Outcome {
        let (mut board, _robot) = self.start(Medium::Ethernet, &[])?;
        let mut seen = None;
        while let Some(line) = board.line() {
            if line.contains(" moving:") {
                fs::write(board::stop_file(self.tools), "")?;
            }
            if line.contains("EmergencyStop") && seen.is_none() {
                seen = Some(line);
            }
        }
        let success = board.end()?;
        let line = seen.unwrap_or_else(|| "no emergency stop was seen".into());
        let safe = line.contains("drives 0 heartbeat 0");
        println!("emergency stop: {line}; exit code {}", i32::from(!success));
        Ok(safe && !success)
    }

    /// Takes the robot away in the middle of the motion.
    fn silence(&self) -> Outcome {
        let (mut board, robot) = self.start(Medium::Ethernet, &[])?;
        let (mut robot, mut seen) = (Some(robot), None);
        while let Some(line) = board.line() {
            if line.contains(" moving:") {
                robot = None;
            }
            if line.starts_with("silent") {
                seen = Some(line);
            }
        }
        drop(robot);
        let success = board.end()?;
        let line = seen.unwrap_or_else(|| "no silence was seen".into());
        let safe = line.contains("drives 0 heartbeat 0");
        println!(
            "robot taken away: {line}; exit code {}",
            i32::from(!success)
        );
        Ok(safe && !success)
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
