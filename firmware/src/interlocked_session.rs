//! The controller for a robot at the other end of a datagram link, with the interlock
//! in between: the FRI session of the `bridge` crate without a PC.

use arms::{LWR_IV, LWR_IV_FLANGE};
use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Phase, Session, SessionConfig};
use bridge::source::ReferenceSource;
use bridge::transport::DatagramLink;
use controller_core::joint::zeros;
use controller_core::law::null_space::NullDamping;
use controller_core::{ConfigError, Reference};
use embedded_hal::digital::{InputPin, OutputPin};

use crate::interlock::{Cause, Interlock};
use crate::scenario::{self, FixedScenario, ReadyScenario};

/// Longest datagram of the link.
const BUFFER: usize = 1024;

/// c of the null-space damping D = c M \[1/s\].
const DAMPING_RATE: f64 = 10.0;

/// Length of the motion \[s\].
pub const DURATION_S: f64 = 20.0;

/// The configuration of a session that runs a scenario.
///
/// # Errors
/// Never for the constants of a scenario.
pub fn config(scenario: FixedScenario) -> Result<SessionConfig, ConfigError> {
    let mut controller = scenario::config(scenario)?;
    controller.null_space.damping = NullDamping::Inertia(DAMPING_RATE);
    Ok(SessionConfig::new(
        &LWR_IV,
        controller,
        LWR_IV_FLANGE,
        DURATION_S,
    ))
}

/// The motion of a scenario, from wherever the arm is.
#[derive(Clone, Debug)]
pub struct FixedScenarioSource {
    ready: ReadyScenario<f64>,
    origin: Reference<f64>,
}

impl FixedScenarioSource {
    /// Of a scenario.
    ///
    /// # Errors
    /// Never for the constants of a scenario.
    pub fn new(scenario: FixedScenario) -> Result<Self, ConfigError> {
        let ready = ReadyScenario::new(scenario)?;
        Ok(Self {
            origin: Reference::hold(ready.controller.level_count(), zeros()),
            ready,
        })
    }
}

impl ReferenceSource for FixedScenarioSource {
    fn start(&mut self, origin: &Reference<f64>) {
        self.origin.clone_from(origin);
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        Some(self.ready.moved(&self.origin, t_s))
    }
}

/// What a call of [`InterlockedSession::poll`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// No datagram.
    Quiet,
    /// A datagram was answered: the phase, and why the drives are off if they are.
    Answered {
        /// Where the conversation stands.
        phase: Phase,
        /// Why the drives are off.
        stopped: Option<Cause>,
    },
    /// A datagram got no answer.
    Refused,
    /// The robot has been silent for too long: the outputs are safe.
    Silent,
}

/// Session, link and interlock.
pub struct InterlockedSession<L, E, D, H> {
    session: Session<Lwr>,
    source: FixedScenarioSource,
    link: L,
    interlock: Interlock<E, D, H>,
    /// Time without a datagram \[s\], from the first one on.
    quiet_s: f64,
    silence_s: f64,
    heard: bool,
}

impl<L: DatagramLink, E: InputPin, D: OutputPin, H: OutputPin> InterlockedSession<L, E, D, H> {
    /// Outputs safe, waiting for the robot. After `silence_s` \[s\] without a datagram
    /// it counts as gone.
    #[must_use]
    pub fn new(
        config: SessionConfig,
        source: FixedScenarioSource,
        link: L,
        interlock: Interlock<E, D, H>,
        silence_s: f64,
    ) -> Self {
        Self {
            session: Session::new(Lwr::new(), config),
            source,
            link,
            interlock,
            quiet_s: 0.0,
            silence_s,
            heard: false,
        }
    }

    /// The conversation.
    #[must_use]
    pub fn session(&self) -> &Session<Lwr> {
        &self.session
    }

    /// The link.
    pub fn link(&mut self) -> &mut L {
        &mut self.link
    }

    /// Takes a datagram if one has come and answers it; `elapsed_s` \[s\] have passed
    /// since the last call. Interlock first, answer second: with an emergency stop or a
    /// fault the outputs are safe before the datagram leaves.
    ///
    /// # Errors
    /// The link fails; the outputs are safe.
    pub fn poll(&mut self, elapsed_s: f64) -> Result<Event, L::Error> {
        let mut buffer = [0; BUFFER];
        let length = match self.link.receive(&mut buffer) {
            Ok(Some(length)) => length,
            Ok(None) => return Ok(self.quiet(elapsed_s)),
            Err(error) => {
                self.interlock.make_safe();
                return Err(error);
            }
        };
        let mut answer = [0; ANSWER_LEN];
        let datagram = buffer.get(..length).unwrap_or(&[]);
        let outcome = (self.session).receive(datagram, &mut self.source, &mut answer);
        if outcome != Outcome::Answered {
            return Ok(Event::Refused);
        }
        self.quiet_s = 0.0;
        self.heard = true;
        let stopped = self.watch().err();
        let sent = self.link.send(&answer);
        if sent.is_err() {
            self.interlock.make_safe();
        }
        sent.map(|()| Event::Answered {
            phase: self.session.phase(),
            stopped,
        })
    }

    /// Asks the interlock in a cycle: drives run in command state only.
    fn watch(&mut self) -> Result<(), Cause> {
        let phase = self.session.phase();
        let moves = phase.is_in_command() && self.session.stop_reason().is_none();
        if phase == Phase::Starting {
            self.interlock.enable();
        }
        let clean = self.session.fault().is_none();
        let outcome = self.interlock.cycle(clean);
        match outcome {
            Err(Cause::EmergencyStop | Cause::Output) => self.session.halt(),
            _ if !moves && phase != Phase::Stopping => self.interlock.make_safe(),
            _ => {}
        }
        outcome
    }

    fn quiet(&mut self, elapsed_s: f64) -> Event {
        if !self.heard {
            return Event::Quiet;
        }
        self.quiet_s += elapsed_s;
        if self.quiet_s <= self.silence_s {
            return Event::Quiet;
        }
        self.interlock.make_safe();
        self.session.silent();
        Event::Silent
    }
}
