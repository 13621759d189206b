//! The machine.

use crate::kind::Kind;
use crate::modes::RobotMode;
use crate::request::{Connect, Move, Request};
use crate::sequence::Sequence;
use crate::status::{ConnectStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus};
use crate::stream::{HEADER_LEN, Stream};
use crate::version::Version;

use super::event::{Awaited, Cause, Stop};
use super::facts::{Duty, Facts, ModelSink, Phase, Start};
use super::outgoing::Outgoing;
use super::said::{Said, is_reply, said};

/// States that pass before what is waited for counts as not coming: 1 s.
pub const PATIENCE: u32 = 1000;

/// Bytes of the longest model that is taken.
pub const MODEL_LEN_MAX: usize = 1 << 20;

/// Bytes that are kept of a reply: those of a longer one are not looked at.
const REPLY_ROOM: usize = HEADER_LEN + 16;

/// The client's end of a connection over TCP.
#[derive(Clone, Debug)]
pub struct Client {
    /// Whether AutomaticErrorRecovery may be asked for; never twice.
    may_recover: bool,
    version: Version,
    link: Link,
    stream: Stream<[u8; REPLY_ROOM]>,
    out: Outgoing,
    sequence: Sequence,
    phase: Phase,
    /// The request whose reply is waited for, and its id.
    asked: Option<(u32, Kind)>,
    /// Id of the Move that has started.
    motion: Option<u32>,
    start: Option<Start>,
    /// States since something went on.
    waited: u32,
    /// The newest state; none before the first.
    facts: Option<Facts>,
    wish: Wish,
    end: End,
    model: Option<ModelStatus>,
    recovery: Option<RecoveryStatus>,
    strays: u32,
}

/// How many connections there have been.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Link {
    /// None or the first one.
    First,
    /// The robot has another version: a second one is wanted.
    Again,
    /// The second one.
    Second,
}

/// What the host wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wish {
    GoOn,
    Finish,
    Halt,
}

/// What is known of the end of a motion.
#[derive(Clone, Copy, Debug, Default)]
struct End {
    /// Second reply to Move.
    reply: Option<MoveStatus>,
    /// What a state says.
    seen: Option<Cause>,
    /// Why it has ended, while the robot recovers.
    verdict: Option<Cause>,
}

impl Client {
    /// Not connected. `may_recover`: once, AutomaticErrorRecovery is asked for, when the robot
    /// is found in a reflex or has aborted the motion by one.
    #[must_use]
    pub const fn new(may_recover: bool) -> Self {
        Self {
            may_recover,
            version: Version::V10,
            link: Link::First,
            stream: Stream::with_room(HEADER_LEN + 1 + MODEL_LEN_MAX),
            out: Outgoing::new(),
            sequence: Sequence::new(),
            phase: Phase::Connecting,
            asked: None,
            motion: None,
            start: None,
            waited: 0,
            facts: None,
            wish: Wish::GoOn,
            end: End {
                reply: None,
                seen: None,
                verdict: None,
            },
            model: None,
            recovery: None,
            strays: 0,
        }
    }

    /// Where the conversation stands.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The end, once it is there.
    #[must_use]
    pub fn stopped(&self) -> Option<Stop> {
        match self.phase {
            Phase::Stopped(stop) => Some(stop),
            _ => None,
        }
    }

    /// The version of the connection: before [`Phase::Reading`] the one that is tried, at first
    /// 10, then that of the robot.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// What came of asking for the robot's model; none before version 8.
    #[must_use]
    pub fn model(&self) -> Option<ModelStatus> {
        self.model
    }

    /// What came of AutomaticErrorRecovery; none if it was not asked for.
    #[must_use]
    pub fn recovery(&self) -> Option<RecoveryStatus> {
        self.recovery
    }

    /// Replies that nobody had asked for: they have no effect.
    #[must_use]
    pub fn strays(&self) -> u32 {
        self.strays
    }

    /// Whether both sockets are to be closed and the connection made once more, because the
    /// robot has another version.
    #[must_use]
    pub fn wants_new_connection(&self) -> bool {
        self.link == Link::Again
    }

    /// Bytes for the robot; empty if there are none.
    #[must_use]
    pub fn transmit(&self) -> &[u8] {
        self.out.bytes()
    }

    /// So many of them are on their way.
    pub fn transmitted(&mut self, count: usize) {
        self.out.sent(count);
    }

    /// The TCP connection is open, and states are taken at this port: Connect is due.
    pub fn connected(&mut self, udp_port: u16) {
        if self.phase != Phase::Connecting {
            return;
        }
        if self.link == Link::Again {
            self.link = Link::Second;
        }
        self.stream.reset();
        self.out.reset();
        self.sequence = Sequence::new();
        let version = self.version.number();
        self.ask(&Request::Connect(Connect { version, udp_port }));
    }

    /// The TCP connection is closed, or has failed.
    pub fn closed(&mut self) {
        if !self.wants_new_connection() {
            self.lose(Cause::Closed);
        }
    }

    /// Nothing has come, bytes or states, for as long as the host waits.
    pub fn silent(&mut self) {
        self.lose(Cause::Silent);
    }

    /// Sets thresholds and load and starts the motion, from [`Phase::Ready`] on.
    pub fn start(&mut self, start: &Start) {
        if self.phase == Phase::Ready {
            self.start = Some(*start);
            self.enter(Phase::Starting);
        }
    }

    /// Ends the motion in good order: the arm should be at rest. Without a motion, ends at once.
    pub fn finish(&mut self) {
        self.wish_for(Wish::Finish, Cause::Finished);
    }

    /// Stops the motion at once: StopMove, and the robot brakes. Without a motion, ends at once.
    pub fn halt(&mut self) {
        if self.wish_for(Wish::Halt, Cause::Halted) && self.motion.is_some() {
            self.stop_move();
        }
    }

    /// Takes bytes of the TCP connection, in any pieces; those of the robot's model go to
    /// `model`.
    pub fn receive(&mut self, bytes: &[u8], model: &mut impl ModelSink) {
        let mut bytes = bytes;
        while self.stopped().is_none() && !self.wants_new_connection() {
            let (version, asked, motion) = (self.version, self.asked, self.motion);
            let next = self.stream.next_in_pieces(&mut bytes, |piece| {
                if is_reply(version, asked, Kind::GetRobotModel, (piece.id, piece.code)) {
                    // Behind the status.
                    let urdf = piece.bytes.get(usize::from(piece.at == 0)..);
                    model.piece(urdf.unwrap_or_default());
                }
            });
            let said = match next {
                Ok(None) => return,
                Ok(Some(message)) => said(version, asked, motion, &message),
                Err(error) => Err(error),
            };
            match said {
                Ok(Some(said)) => self.hear(&said),
                Ok(None) => self.strays = self.strays.saturating_add(1),
                Err(error) => self.stop(Cause::Protocol(error)),
            }
        }
    }

    /// Takes a state that has passed its check and tells what to do about it.
    pub fn state(&mut self, facts: &Facts) -> Duty {
        let connecting = self.phase == Phase::Connecting;
        if connecting
            || self.stopped().is_some()
            || !self.sequence.receive(facts.message_id).is_fresh()
        {
            return Duty::Listen;
        }
        self.facts = Some(*facts);
        self.waited = self.waited.saturating_add(1);
        match self.phase {
            Phase::Reading => self.read(),
            Phase::Starting => self.begin(facts),
            Phase::Running => return self.run(facts),
            Phase::Ending => return self.wind_up(facts),
            Phase::Connecting | Phase::Ready | Phase::Stopped(_) => {}
        }
        Duty::Listen
    }

    /// A reply that was waited for.
    fn hear(&mut self, said: &Said) {
        self.waited = 0;
        if let Said::Ended(status) = *said {
            self.end.reply = Some(status);
            return self.enter(Phase::Ending);
        }
        self.asked = None;
        match *said {
            Said::Connect(status, robots) => self.hear_version(status, robots),
            Said::Model(status) => {
                self.model = Some(status);
                self.read();
            }
            Said::Setter(kind, SetterStatus::Success) => match (kind, self.start) {
                (Kind::SetCollisionBehavior, Some(start)) => {
                    self.ask(&Request::SetLoad(start.load));
                }
                _ => self.ask(&Request::Move(Move::torque(self.version))),
            },
            Said::Setter(kind, status) => self.refuse(kind, status.name()),
            // The vendor's client takes both.
            Said::Started(id, MoveStatus::MotionStarted | MoveStatus::Success) => {
                self.motion = Some(id);
                if self.wish == Wish::Halt {
                    self.stop_move();
                }
            }
            Said::Started(_, status) => self.refuse(Kind::Move, status.name()),
            Said::Ended(_) => {}
            Said::Recovery(status) => {
                self.recovery = Some(status);
                match self.end.verdict {
                    Some(verdict) => self.stop(verdict),
                    // The state shows when the robot is idle again.
                    None if status == RecoveryStatus::Success => {}
                    None => self.refuse(Kind::AutomaticErrorRecovery, status.name()),
                }
            }
        }
    }

    fn hear_version(&mut self, status: ConnectStatus, robots: u16) {
        let named = Version::from_number(robots).ok();
        let other = named.filter(|&version| version != self.version);
        // A robot that is content with any version names its own one. What is none may be
        // anything: there are robots with the number elsewhere.
        if status == ConnectStatus::Success && other.is_none() {
            self.enter(Phase::Reading);
            if Kind::GetRobotModel.code(self.version).is_ok() {
                self.ask(&Request::GetRobotModel);
            }
            return;
        }
        match other {
            Some(version) if self.link == Link::First => {
                self.version = version;
                self.link = Link::Again;
            }
            _ => {
                let ours = self.version.number();
                self.stop(Cause::Version { ours, robots });
            }
        }
    }

    fn read(&mut self) {
        if self.asked.is_none() && self.facts.is_some() {
            self.enter(Phase::Ready);
        } else {
            self.lack_reply();
        }
    }

    /// Before the state shows the motion.
    fn begin(&mut self, facts: &Facts) {
        if self.motion.is_some() {
            if let Some(trouble) = facts.abort() {
                self.end.seen = Some(trouble);
                self.enter(Phase::Ending);
            } else if facts.runs(Move::torque(self.version).generator) {
                // Not answered, as by the vendor's client: the next one is.
                let ending = self.wish != Wish::GoOn;
                self.enter(if ending {
                    Phase::Ending
                } else {
                    Phase::Running
                });
            } else if self.waited > PATIENCE {
                self.stop(Cause::Late(Awaited::Motion));
            }
            return;
        }
        if self.asked.is_some() {
            return self.lack_reply();
        }
        // Nothing is asked for yet: the robot must be idle.
        match (facts.robot_mode, self.start) {
            (RobotMode::Idle, Some(start)) => {
                self.ask(&Request::SetCollisionBehavior(start.thresholds));
            }
            (RobotMode::Reflex, _) if self.may_recover => self.recover(),
            // Old states may show it for a while behind a recovery.
            (RobotMode::Reflex, _) if self.recovery.is_none() || self.waited > PATIENCE => {
                self.stop(Cause::Reflex(facts.reasons()));
            }
            (RobotMode::UserStopped, _) if self.waited > PATIENCE => self.stop(Cause::UserStop),
            (found, _) if self.waited > PATIENCE => self.stop(Cause::WrongMode {
                found,
                needed: RobotMode::Idle,
            }),
            _ => {}
        }
    }

    fn run(&mut self, facts: &Facts) -> Duty {
        if facts.runs(Move::torque(self.version).generator) {
            return Duty::Answer;
        }
        self.enter(Phase::Ending);
        self.wind_up(facts)
    }

    /// The motion ends, or has ended.
    fn wind_up(&mut self, facts: &Facts) -> Duty {
        if let Some(verdict) = self.end.verdict {
            if self.waited > PATIENCE {
                self.stop(verdict);
            }
            return Duty::Listen;
        }
        let runs = facts.runs(Move::torque(self.version).generator);
        if self.end.seen.is_none() {
            self.end.seen = facts.abort().or(if runs { None } else { facts.wrong() });
        }
        if let (Some(status), false) = (self.end.reply, runs) {
            self.conclude(status, facts);
        } else if self.waited > PATIENCE {
            let awaited = if runs {
                Awaited::End
            } else {
                Awaited::Reply(Kind::Move)
            };
            self.stop(self.end.seen.unwrap_or(Cause::Late(awaited)));
        } else if runs && self.wish == Wish::Finish {
            return Duty::Finish;
        }
        Duty::Listen
    }

    /// Reply and state are there: why the motion has ended.
    fn conclude(&mut self, status: MoveStatus, facts: &Facts) {
        let cause = match (self.end.seen, self.wish) {
            (_, Wish::Finish) if status == MoveStatus::Success => Cause::Finished,
            (Some(seen), _) => seen,
            (None, Wish::Halt) if matches!(status, MoveStatus::Success | MoveStatus::Preempted) => {
                Cause::Halted
            }
            _ if status == MoveStatus::ReflexAborted => Cause::Reflex(facts.reasons()),
            _ => Cause::Aborted(status),
        };
        if matches!(cause, Cause::Reflex(_)) && self.may_recover {
            self.end.verdict = Some(cause);
            self.recover();
        } else {
            self.stop(cause);
        }
    }

    fn recover(&mut self) {
        self.may_recover = false;
        self.ask(&Request::AutomaticErrorRecovery);
    }

    /// Whether that is new, and there is a motion or will be one.
    fn wish_for(&mut self, wish: Wish, cause: Cause) -> bool {
        let moves = self.motion.is_some() || matches!(self.asked, Some((_, Kind::Move)));
        if !moves {
            self.stop(cause);
        }
        if self.stopped().is_some() || self.wish == Wish::Halt || self.wish == wish {
            return false;
        }
        self.wish = wish;
        if self.phase == Phase::Running {
            self.enter(Phase::Ending);
        }
        true
    }

    /// Its reply says nothing that Move's does not.
    fn stop_move(&mut self) {
        if let Err(error) = self.out.push(self.version, &Request::StopMove) {
            self.stop(Cause::Protocol(error));
        }
    }

    fn ask(&mut self, request: &Request) {
        match self.out.push(self.version, request) {
            Ok(id) => {
                self.asked = Some((id, request.kind()));
                self.waited = 0;
            }
            Err(error) => self.stop(Cause::Protocol(error)),
        }
    }

    fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        self.waited = 0;
    }

    fn refuse(&mut self, kind: Kind, status: &'static str) {
        let mode = self
            .facts
            .map_or(RobotMode::Other, |facts| facts.robot_mode);
        self.stop(Cause::Refused { kind, status, mode });
    }

    fn lack_reply(&mut self) {
        if let (Some((_, kind)), true) = (self.asked, self.waited > PATIENCE) {
            self.stop(Cause::Late(Awaited::Reply(kind)));
        }
    }

    /// The link is gone. What is known of the end counts more.
    fn lose(&mut self, cause: Cause) {
        let done = self.wish == Wish::Finish && self.end.reply == Some(MoveStatus::Success);
        let known = self.end.verdict.or(self.end.seen);
        let finished = done.then_some(Cause::Finished);
        self.stop(known.or(finished).unwrap_or(cause));
    }

    fn stop(&mut self, cause: Cause) {
        if self.stopped().is_none() {
            let in_motion = self.motion.is_some();
            self.out.reset();
            self.asked = None;
            self.phase = Phase::Stopped(Stop { cause, in_motion });
        }
    }
}
