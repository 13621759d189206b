//! The controller on the emulated board, for a robot elsewhere.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use crate::Outcome;
use crate::tools::{Need, QEMU, Tools};

/// Port on which the emulated board is reached, and of `hil-sim serve`.
const PORT: &str = "49938";

/// The link of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// UDP on the emulated Ethernet.
    Ethernet,
    /// Frames on the emulated serial port, which is a pseudo terminal here.
    Serial,
}

/// Runs the image until the motion is over, the emergency stop is pulled or the
/// robot is gone. What it says is printed as it comes.
pub fn run(link: Link) -> Outcome {
    let tools = Tools::find(&[Need::Emulator])?;
    let image = tools.image("fri", &[])?;
    // Switches that the image looks for: a stale one would stop it at once.
    let (serial, stop) = (tools.work.join("fri-serial"), tools.work.join("e-stop"));
    for switch in [&serial, &stop] {
        if switch.exists() {
            fs::remove_file(switch)?;
        }
    }
    let mut qemu = Command::new(QEMU);
    qemu.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none"]);
    qemu.args(["-semihosting-config", "enable=on,target=native"]);
    match link {
        Link::Serial => {
            fs::write(&serial, "")?;
            qemu.args(["-serial", "pty"]);
        }
        Link::Ethernet => {
            let forward = format!("hostfwd=udp:127.0.0.1:{PORT}-10.0.2.15:{PORT}");
            qemu.args(["-serial", "null", "-nic"]);
            qemu.arg(format!("user,model=lan9118,{forward}"));
            println!(
                "board at 127.0.0.1:{PORT}; in another terminal: cargo run --release -p hil-sim -- \
                 serve --scenario two-level --lockstep"
            );
        }
    }
    println!("emergency stop: touch {}", stop.display());
    qemu.arg("-kernel").arg(&image).current_dir(&tools.work);
    qemu.stdin(Stdio::null());
    let mut running = qemu.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    if let Some(errors) = running.stderr.take() {
        std::thread::spawn(move || {
            // Said for every datagram that comes before the board is on the network.
            const EXPECTED: &str = "Slirp: Failed to send packet";
            let lines = BufReader::new(errors).lines().map_while(Result::ok);
            lines
                .filter(|line| !line.contains(EXPECTED))
                .for_each(|line| eprintln!("{line}"));
        });
    }
    if let Some(said) = running.stdout.take() {
        for line in BufReader::new(said).lines().map_while(Result::ok) {
            // "char device redirected to /dev/pts/0 (label serial0)"
            let words: Vec<_> = line.split(' ').collect();
            match words[..] {
                ["char", "device", "redirected", "to", path, ..] => println!(
                    "board at {path}; in another terminal: cargo run --release -p hil-sim -- \
                     serve --scenario two-level --lockstep --serial {path}"
                ),
                _ => println!("{line}"),
            }
        }
    }
    let ended = running.wait()?;
    for switch in [&serial, &stop] {
        if switch.exists() {
            fs::remove_file(switch)?;
        }
    }
    Ok(ended.success())
}
