//! The robot's side and the bridge in one process: `--measurement fri`.
//!
//! The same datagrams go from hand to hand that would go over UDP in lock-step,
//! so the motion is the same to the last bit.

use std::io;

use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Session, SessionConfig};

use crate::interrupt;
use crate::link::{Expect, Fault, LockStep, Peer};
use crate::robot::{LwrBox, LwrRobot};
use cell::scenario::{Scenario, ScenarioSource};
use record::run::Sample;

/// The bridge as a client in this process.
#[derive(Debug)]
pub struct BridgeClient {
    /// The conversation.
    pub session: Session<Lwr>,
    source: ScenarioSource,
}

impl BridgeClient {
    /// A client that follows the motion of `scenario`.
    #[must_use]
    pub fn new(config: SessionConfig, scenario: &Scenario) -> Self {
        Self {
            session: Session::new(Lwr::new(), config),
            source: ScenarioSource::new(scenario),
        }
    }
}

impl Peer<LwrBox> for BridgeClient {
    fn exchange(
        &mut self,
        measurement: &[u8],
        _: Expect,
        answers: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool> {
        let mut answer = [0; ANSWER_LEN];
        let outcome = (self.session).receive(measurement, &mut self.source, &mut answer);
        if outcome == Outcome::Answered {
            answers.push(answer.to_vec());
        }
        // What it doubts it leaves without answer: it is not gone.
        Ok(true)
    }
}

/// Lets both talk over a link with `faults` until the scenario is over. Every cycle
/// from time 0 on is shown to `sink`.
///
/// # Errors
/// Those of `sink`.
pub fn run(
    robot: &mut LwrRobot,
    client: &mut BridgeClient,
    faults: &[Fault],
    mut sink: impl FnMut(&Sample, &Session<Lwr>) -> io::Result<()>,
) -> io::Result<()> {
    let cycle_s = robot.setup().scenario.cycle_s();
    let mut link = LockStep::new(faults, cycle_s, robot.setup().seed);
    while !robot.is_finished() {
        if let Some(stop) = interrupt::stop() {
            robot.abort(stop);
        }
        link.cycle(robot, client)?;
        let step = client.session.last().and_then(|cycle| cycle.step);
        robot.hear(step.map(|step| step.status));
        if let Some(instant) = robot.advance() {
            sink(&instant, &client.session)?;
        }
    }
    link.finish(robot, client)
}
