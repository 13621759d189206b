//! The robot's side and the bridge in one process: `--measurement fri`.
//!
//! The same datagrams go from hand to hand that would go over UDP in lock-step,
//! so the motion is the same to the last bit.

use std::io;

use bridge::protocol::Protocol;
use bridge::session::{Outcome, Session, SessionConfig};

use crate::interrupt;
use crate::link::{Expect, Fault, LockStep, Peer};
use crate::robot::{ControlBox, Robot};
use cell::scenario::{Scenario, ScenarioSource, TimedTransition};
use record::run::Sample;

/// The bridge as a client in this process, with its end of the robot's protocol.
#[derive(Debug)]
pub struct BridgeClient<P: Protocol> {
    /// The conversation.
    pub session: Session<P>,
    source: ScenarioSource,
}

impl<P: Protocol> BridgeClient<P> {
    /// A client that follows the motion of `scenario`.
    #[must_use]
    pub fn new(protocol: P, config: SessionConfig, scenario: &Scenario) -> Self {
        Self {
            session: Session::new(protocol, config),
            source: ScenarioSource::new(scenario),
        }
    }

    /// With changes of tasks and gains on the way.
    #[must_use]
    pub fn changing(self, changes: Vec<TimedTransition>) -> Self {
        Self {
            source: self.source.changing(changes),
            ..self
        }
    }
}

impl<B: ControlBox, P: Protocol> Peer<B> for BridgeClient<P> {
    fn exchange(
        &mut self,
        measurement: &[u8],
        _: Expect,
        answers: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool> {
        let mut answer = P::EMPTY;
        let outcome = (self.session).receive(measurement, &mut self.source, &mut answer);
        if outcome == Outcome::Answered {
            answers.push(answer.as_ref().to_vec());
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
pub fn run<B: ControlBox, P: Protocol>(
    robot: &mut Robot<B>,
    client: &mut BridgeClient<P>,
    faults: &[Fault],
    mut sink: impl FnMut(&Sample, &Session<P>) -> io::Result<()>,
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
