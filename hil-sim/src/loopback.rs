//! The robot's side and the bridge in one process: `--measurement fri`.
//!
//! The same datagrams go from hand to hand that would go over UDP in lock-step,
//! so the motion is the same to the last bit.

use std::io;

use bridge::session::{ANSWER_LEN, Outcome, Session, SessionConfig};

use crate::experiment::Instant;
use crate::robot::{MEASUREMENT_BYTES, Robot};
use crate::scenario::ScenarioSource;

/// Lets both talk until the scenario is over. Every cycle from time 0 on is shown
/// to `sink`; `progress` is told the share done, 0 to 1.
///
/// # Errors
/// Those of `sink`.
pub fn run(
    robot: &mut Robot,
    config: SessionConfig,
    mut sink: impl FnMut(&Instant<'_>) -> io::Result<()>,
    mut progress: impl FnMut(f64),
) -> io::Result<()> {
    let mut source = ScenarioSource::new(&robot.setup().scenario);
    let duration_s = config.duration_s;
    let mut session = Session::new(config);
    let (mut measurement, mut answer) = ([0; MEASUREMENT_BYTES], [0; ANSWER_LEN]);
    while !robot.is_finished() {
        robot.measurement(&mut measurement);
        match session.receive(&measurement, &mut source, &mut answer) {
            Outcome::Answered => {
                robot.command(&answer, 0.0);
            }
            // Two sides of one program cannot misunderstand each other.
            other => unreachable!("{other:?}"),
        }
        if let Some(instant) = robot.advance() {
            sink(&instant)?;
            progress(instant.t_s / duration_s);
        }
    }
    Ok(())
}
