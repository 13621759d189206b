//! The socket loop: one datagram in, one out.

use std::collections::BTreeMap;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use bridge::lwr::{ANSWER_LEN, Lwr, RobotState};
use bridge::protocol::Protocol;
use bridge::session::{CycleReport, Outcome, Phase, Session};
use bridge::source::ReferenceSource;
use cell::terminal::tell;
use controller_core::joint::Vector3;
use controller_core::ranges::MAX_LEVELS;
use controller_core::task::orientation;
use controller_core::{Axes, Target, TaskSet};

use crate::peer::{Peer, Refusal};
use crate::recorder::Recorder;
use crate::summary::{AuditSummary, LevelSummary, LinkSummary, Summary};
use cell::realtime::Realtime;
use cell::timing::Times;

/// Longest datagram that is looked at; a measurement has 916 bytes.
const BUFFER: usize = 2048;

/// How often the loop looks up while nothing arrives.
const LOOK_UP: Duration = Duration::from_millis(20);

/// Answers after which a robot that falls silent is taken for gone; before, it is taken
/// for a stray sender, and the loop waits on.
const ACQUAINTED: u64 = 100;

/// Silence after which another robot may come, until then.
const STRAY: Duration = Duration::from_millis(500);

/// Our end of the conversation: all that the loop needs besides a session.
#[derive(Debug)]
pub struct Endpoint<'a> {
    /// Bound to where the robot sends.
    pub socket: UdpSocket,
    /// The only address that is answered; if none is given, the first that sends
    /// measurements in a row.
    pub peer: Option<SocketAddr>,
    /// How long to wait for a first measurement.
    pub wait: Duration,
    /// Silence after which the robot is taken for gone.
    pub silence: Duration,
    /// Set from outside: come to rest and end.
    pub stop: &'a AtomicBool,
    /// The tasks of the session, for the figures of its levels.
    pub tasks: TaskSet,
}

/// What a loop has counted.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    answered: u64,
    refused: u64,
    /// The last datagram that did not reach the session, and why.
    last_refused: Option<(SocketAddr, Refusal)>,
    phases: [u64; PHASES.len()],
    link: LinkSummary,
    tracking: [Tracking; MAX_LEVELS],
    compute: Times,
    latency: Times,
}

const PHASES: [Phase; 7] = [
    Phase::Waiting,
    Phase::Ready,
    Phase::Starting,
    Phase::Moving,
    Phase::Holding,
    Phase::Stopping,
    Phase::Finished,
];

/// Running figures of a level.
#[derive(Clone, Copy, Debug, Default)]
struct Tracking {
    squares: f64,
    count: u64,
    max: f64,
}

/// Answers the robot until the session is over. `each` sees every answered cycle.
///
/// # Errors
/// The socket fails.
pub fn converse(
    end: &mut Endpoint<'_>,
    session: &mut Session<Lwr>,
    source: &mut impl ReferenceSource,
    mut recorder: Option<&mut Recorder<RobotState>>,
    mut each: impl FnMut(&Session<Lwr>, &CycleReport<RobotState>),
) -> io::Result<Counts> {
    let mut counts = Counts::default();
    let (mut bytes, mut answer) = ([0; BUFFER], [0; ANSWER_LEN]);
    let mut heard = Instant::now();
    let mut peer = Peer::new(end.peer);
    end.socket.set_read_timeout(Some(LOOK_UP))?;
    loop {
        if end.stop.load(Ordering::Relaxed) {
            session.stop();
        }
        match end.socket.recv_from(&mut bytes) {
            Ok((length, from)) => {
                let begin = Instant::now();
                let datagram = bytes.get(..length).unwrap_or(&bytes);
                let admitted = peer.admit(from, datagram);
                let outcome = admitted.map(|()| session.receive(datagram, source, &mut answer));
                let computed = begin.elapsed();
                match outcome {
                    Err(why) => counts.refuse(from, why),
                    Ok(outcome @ (Outcome::Answered | Outcome::Heard)) => {
                        if outcome == Outcome::Answered {
                            end.socket.send_to(&answer, from)?;
                        }
                        let latency = begin.elapsed();
                        heard = begin;
                        counts.compute.add(computed);
                        counts.latency.add(latency);
                        if let Some(cycle) = session.last() {
                            counts.add(session, cycle, &end.tasks);
                            if let Some(recorder) = &mut recorder {
                                recorder.push(cycle);
                            }
                            each(session, cycle);
                        }
                    }
                    Ok(Outcome::Stale) => counts.link.stale += 1,
                    Ok(Outcome::Doubted) => counts.refuse(from, Refusal::Doubted),
                    Ok(Outcome::Rejected(error)) => counts.refuse(from, Refusal::Unusable(error)),
                    Ok(Outcome::Unusable(error)) => {
                        return Err(io::Error::other(format!("the robot's cycle: {error}")));
                    }
                }
            }
            Err(error) if is_timeout(&error) => {}
            // The robot's port is closed: it may open again.
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
            Err(error) => return Err(error),
        }
        if session.phase() == Phase::Finished {
            return Ok(counts);
        }
        // Looked at after every datagram: strangers that go on sending are no robot.
        let stray = session.phase() == Phase::Ready && counts.answered < ACQUAINTED;
        let patience = match session.phase() {
            Phase::Waiting => end.wait,
            Phase::Ready if stray => end.wait,
            _ => end.silence,
        };
        let silence = heard.elapsed();
        if stray && silence > STRAY && peer.release() {
            tell("note: the robot fell silent; waiting for it or another one");
            session.silent();
        }
        let stopped = session.stop_reason().is_some();
        if silence > patience || (stopped && silence > LOOK_UP * 10) {
            session.silent();
            return Ok(counts);
        }
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

impl Counts {
    fn refuse(&mut self, from: SocketAddr, why: Refusal) {
        self.refused += 1;
        self.last_refused = Some((from, why));
        match why {
            Refusal::Stranger(_) => self.link.strangers += 1,
            Refusal::Unproven => self.link.unproven += 1,
            Refusal::Unusable(_) | Refusal::Doubted => self.reject(&why.to_string()),
        }
    }

    /// The datagrams that did not reach the session, as the end of a sentence.
    #[must_use]
    pub fn refusals(&self) -> String {
        let Some((from, why)) = &self.last_refused else {
            return String::new();
        };
        let count = self.refused;
        format!("; {count} datagrams were refused, the last from {from}: {why}")
    }

    fn reject(&mut self, reason: &str) {
        // Rare, so it may allocate; bounded, whatever arrives.
        const REASONS: usize = 32;
        let known = self.link.rejected.len() < REASONS || self.link.rejected.contains_key(reason);
        let reason = if known { reason } else { "other" };
        *self.link.rejected.entry(reason.to_string()).or_default() += 1;
    }

    /// A cycle, answered or not, with its figures.
    pub(crate) fn add<P: Protocol>(
        &mut self,
        session: &Session<P>,
        cycle: &CycleReport<P::Robot>,
        tasks: &TaskSet,
    ) {
        self.answered += 1;
        self.link.lost += u64::from(cycle.lost);
        for (phase, count) in PHASES.iter().zip(&mut self.phases) {
            *count += u64::from(*phase == cycle.phase);
        }
        let moving = matches!(cycle.phase, Phase::Moving | Phase::Holding);
        let Some(controller) = session.controller().filter(|_| moving) else {
            return;
        };
        let actual = controller.rest_reference(&cycle.joints.q);
        let levels = tasks.tasks().iter().zip(&mut self.tracking);
        let followed = controller.followed_reference(session.state());
        let targets = followed.targets().iter().zip(actual.targets());
        for ((task, tracking), (wanted, actual)) in levels.zip(targets) {
            if let Some(error) = deviation(wanted, actual) {
                tracking.add(norm(task.axes, &error));
            }
        }
    }

    /// What another loop has counted of its link.
    pub(crate) fn set_link(
        &mut self,
        answered: u64,
        rejected: BTreeMap<String, u64>,
        strangers: u64,
    ) {
        self.answered = answered;
        self.link.rejected = rejected;
        self.link.strangers = strangers;
    }

    /// How long its answers took.
    pub(crate) fn set_times(&mut self, compute: Times, latency: Times) {
        (self.compute, self.latency) = (compute, latency);
    }

    /// Everything about a session that has ended so.
    #[must_use]
    pub fn summary<P: Protocol>(
        &self,
        session: &Session<P>,
        (exit_code, reason): (u8, String),
        scenario: &str,
        names: &[String],
        realtime: &Realtime,
    ) -> Summary {
        let phases: BTreeMap<_, _> = PHASES
            .iter()
            .zip(self.phases)
            .filter(|(_, count)| *count > 0)
            .map(|(phase, count)| (phase.name(), count))
            .collect();
        let levels = names.iter().zip(&self.tracking);
        Summary {
            scenario: scenario.into(),
            reason,
            exit_code,
            cycle_ms: session.cycle_s() * 1e3,
            answered: self.answered,
            phases,
            levels: levels.map(|(name, sums)| sums.figures(name)).collect(),
            link: self.link.clone(),
            audit: AuditSummary::from(session.audit()),
            compute: self.compute.figures(),
            latency: self.latency.figures(),
            realtime: realtime.clone(),
            references: None,
            recorder_dropped: 0,
            fci: None,
        }
    }
}

/// From where a level is to where it should be: \[m\], or the rotation vector \[rad\] of
/// an orientation; none where the two do not compare.
fn deviation(wanted: &Target<f64>, actual: &Target<f64>) -> Option<Vector3<f64>> {
    match (wanted, actual) {
        (Target::Position { x: wanted, .. }, Target::Position { x, .. }) => Some(wanted - x),
        (Target::Orientation { q: wanted, .. }, Target::Orientation { q, .. }) => {
            Some(orientation::rotation_vector(&orientation::chord(wanted, q)))
        }
        _ => None,
    }
}

fn norm(axes: Axes, error: &Vector3<f64>) -> f64 {
    let controlled = error.iter().zip(axes.flags()).filter(|(_, on)| *on);
    controlled
        .map(|(value, _)| value * value)
        .sum::<f64>()
        .sqrt()
}

impl Tracking {
    fn add(&mut self, error: f64) {
        self.squares += error * error;
        self.count += 1;
        self.max = self.max.max(error);
    }

    fn figures(&self, name: &str) -> LevelSummary {
        let moved = self.count > 0;
        LevelSummary {
            name: name.into(),
            rms: moved.then(|| (self.squares / self.count as f64).sqrt() * 1e3),
            max: moved.then_some(self.max * 1e3),
        }
    }
}
