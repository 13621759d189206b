//! The image `fri` in QEMU: the controller on the emulated board, for a robot
//! elsewhere.

use std::fs;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Stdio};

use crate::tools::{Trouble, image, qemu, work};

/// Port on which the emulated board is reached, and of `hil-sim serve`.
const PORT: &str = "49938";

/// What carries the datagrams of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Medium {
    /// UDP on the emulated Ethernet.
    Ethernet,
    /// Frames on the emulated serial port, which is a pseudo terminal here.
    Serial,
}

/// A board that runs. Ends with this value at the latest.
pub struct Board {
    process: Child,
    said: BufReader<ChildStdout>,
    /// Files that the image looks for: emergency stop, serial port.
    switches: [PathBuf; 2],
}

impl Board {
    /// Builds the image and starts it.
    pub fn start(medium: Medium) -> Result<Self, Trouble> {
        let mut qemu = qemu(&image("fri", "")?)?;
        let work = work()?;
        let switches = ["e-stop", "fri-serial"].map(|name| work.join(name));
        // A stale one would count.
        remove(&switches);
        if medium == Medium::Serial {
            fs::write(&switches[1], "")?;
            qemu.args(["-serial", "pty"]);
        } else {
            let forward = format!("hostfwd=udp:127.0.0.1:{PORT}-10.0.2.15:{PORT}");
            qemu.args(["-serial", "null", "-nic"]);
            qemu.arg(format!("user,model=lan9118,{forward}"));
        }
        let mut process = qemu.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        if let Some(errors) = process.stderr.take() {
            std::thread::spawn(move || {
                // Said for every datagram that comes before the board is on the network.
                const EXPECTED: &str = "Slirp: Failed to send packet";
                let lines = BufReader::new(errors).lines().map_while(Result::ok);
                lines
                    .filter(|line| !line.contains(EXPECTED))
                    .for_each(|line| eprintln!("{line}"));
            });
        }
        let said = (process.stdout.take()).ok_or_else(|| io::Error::other("no standard output"))?;
        Ok(Self {
            process,
            said: BufReader::new(said),
            switches,
        })
    }

    /// The emergency stop is pulled while this file exists.
    pub fn stop_file(&self) -> &Path {
        &self.switches[0]
    }

    /// The next line that the board says; none once it has ended.
    pub fn line(&mut self) -> Option<String> {
        let mut line = String::new();
        match self.said.read_line(&mut line) {
            Ok(count) if count > 0 => Some(line.trim_end().to_string()),
            _ => None,
        }
    }

    /// Waits for its end: whether the exit code is 0.
    pub fn end(mut self) -> io::Result<bool> {
        Ok(self.process.wait()?.success())
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        // Has ended already, or is of no more use.
        let _ = self.process.kill();
        let _ = self.process.wait();
        remove(&self.switches);
    }
}

/// What to give `hil-sim serve`, from a line that names the board's address or device.
pub fn serve_options(line: &str) -> Option<Vec<String>> {
    let words: Vec<_> = line.split(' ').collect();
    match words[..] {
        // "char device redirected to /dev/pts/0 (label serial0)"
        ["char", "device", "redirected", "to", path, ..] => {
            Some(vec!["--serial".into(), path.into()])
        }
        ["fri:", "UDP", "port", ..] => Some(vec!["--port".into(), PORT.into()]),
        _ => None,
    }
}

fn remove(files: &[PathBuf]) {
    for file in files {
        // Need not be there.
        let _ = fs::remove_file(file);
    }
}
