//! Torques of the host and of the Cortex-M7, bit for bit.

use std::fs;

use crate::tools::{Outcome, QEMU, Trouble, emulate, find, host, image, work};

/// The log that the image opens.
const LOG: &str = "selftest.log";

/// Bytes of a header, and of a cycle in double precision, as in `firmware::log`.
const HEADER: usize = 8;
const CYCLE: usize = 22 * 8;
const TORQUES: usize = 15 * 8;

/// Where the proof of the check damages the log: cycle, joint from 1.
const DAMAGE: (usize, usize) = (77, 5);

/// The host writes the log, the target replays it. Then one bit of a short log is
/// turned, and the target must find exactly this one.
pub fn run(cycles: &str) -> Outcome {
    find(&[QEMU])?;
    let image = image("selftest", "")?;
    print!("host:   {}", host("selftest", &[LOG, cycles])?);
    let output = emulate(&image, &[])?;
    let said = String::from_utf8_lossy(&output.stdout);
    for line in said.lines() {
        println!("target: {line}");
    }
    if !output.status.success() {
        eprint!("{}", String::from_utf8_lossy(&output.stderr));
        println!("host and Cortex-M7 differ");
        return Ok(false);
    }

    let (cycle, joint) = DAMAGE;
    host("selftest", &[LOG, "100"])?;
    let path = work()?.join(LOG);
    let mut log = fs::read(&path)?;
    let place = HEADER + cycle * CYCLE + TORQUES + (joint - 1) * 8;
    let short = || Trouble::new("the log is too short to be damaged".into());
    let byte = log.get_mut(place).ok_or_else(short)?;
    *byte ^= 1;
    fs::write(&path, log)?;
    let output = emulate(&image, &[])?;
    let said = String::from_utf8_lossy(&output.stdout);
    let found = output.status.code() == Some(1)
        && said.contains("7 torques, 1 differing bits")
        && said.contains(&format!("first: cycle {cycle} joint {joint},"));
    if !found {
        println!("a turned bit in the log is not found:\n{said}");
        return Ok(false);
    }
    println!("check:  a turned bit in cycle {cycle}, joint {joint} is found, exit code 1");
    Ok(true)
}
