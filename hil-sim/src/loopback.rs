//! The robot's side and the bridge in one process: `--measurement link`.
//!
//! The same bytes go from hand to hand that would go over sockets in lock-step, so the motion is the
//! same to the last bit.

mod fci;

use std::io;

use bridge::protocol::Protocol;
use bridge::session::{Outcome, Session, SessionConfig};

use crate::interrupt;
use crate::link::{Expect, Fault, LockStep, Peer, finish, is_over};
use crate::robot::{ControlBox, Robot};
use cell::scenario::{Scenario, ScenarioSource, TimedTransition};
use record::run::Sample;

pub use self::fci::FciClient;

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

    /// Takes a measurement; its answer, if it gets one. What the bridge doubts it leaves without:
    /// it is not gone.
    fn answer(&mut self, measurement: &[u8]) -> Option<Vec<u8>> {
        let mut answer = P::EMPTY;
        let outcome = (self.session).receive(measurement, &mut self.source, &mut answer);
        (outcome == Outcome::Answered).then(|| answer.as_ref().to_vec())
    }
}

impl<B: ControlBox, P: Protocol> Peer<B> for BridgeClient<P> {
    fn exchange(
        &mut self,
        _: &mut Robot<B>,
        measurement: &[u8],
        _: Expect,
        answers: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool> {
        answers.extend(self.answer(measurement));
        Ok(true)
    }

    fn tell(&self, robot: &mut Robot<B>) {
        let step = self.session.last().and_then(|cycle| cycle.step);
        robot.hear(step.map(|step| step.status));
    }
}

/// A client in this process.
pub trait Local<B: ControlBox>: Peer<B> {
    /// Its end of the robot's protocol.
    type Protocol: Protocol;

    /// Its conversation.
    fn session(&self) -> &Session<Self::Protocol>;

    /// Why it has left, if it has.
    fn why_left(&self) -> Option<String>;
}

impl<B: ControlBox, P: Protocol> Local<B> for BridgeClient<P> {
    type Protocol = P;

    fn session(&self) -> &Session<P> {
        &self.session
    }

    fn why_left(&self) -> Option<String> {
        None
    }
}

/// Lets both talk over a link with `faults` until the scenario is over. Every cycle
/// from time 0 on is shown to `sink`.
///
/// # Errors
/// Those of `sink`, and why a client has left before anything has begun.
pub fn run<B: ControlBox, C: Local<B>>(
    robot: &mut Robot<B>,
    client: &mut C,
    faults: &[Fault],
    mut sink: impl FnMut(&Sample, &Session<C::Protocol>) -> io::Result<()>,
) -> io::Result<()> {
    let cycle_s = robot.setup().scenario.cycle_s();
    let mut link = LockStep::new(faults, cycle_s, robot.setup().seed);
    while !is_over(robot, client) {
        if let Some(stop) = interrupt::stop() {
            robot.abort(stop);
        }
        if let (Some(why), false) = (client.why_left(), robot.has_begun()) {
            return Err(io::Error::other(why));
        }
        if let Some(instant) = link.step(robot, client)? {
            sink(&instant, client.session())?;
        }
    }
    finish(robot, client)
}
