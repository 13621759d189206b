//! A robot without an arm that does what a test says, and a host around the machine.

use fci::client::{Client, Duty, Facts, ModelSink, Phase, Start, Stop};
use fci::status::{
    ConnectStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus, StopMoveStatus,
};
use fci::stream::REQUEST_LEN_MAX;
use fci::{
    ControllerMode, Generator, Kind, MotionGeneratorMode, Reply, Request, RobotErrors, RobotMode,
    Setter, Stream, Version,
};

/// What the host sets.
pub const START: Start = Start::uniform(100.0, 80.0);
/// The model of the robot.
pub const URDF: &str = "<robot name=\"fr3\"/>";

/// How a motion is aborted.
#[derive(Clone, Copy, Debug)]
pub struct Abort {
    /// Behind so many answers.
    pub answers: u32,
    pub mode: RobotMode,
    pub reasons: RobotErrors,
    /// Second reply to Move; none: it does not come.
    pub status: Option<MoveStatus>,
}

/// The robot: what it does is public, to be changed by a test.
pub struct Robot {
    pub version: Version,
    pub mode: RobotMode,
    pub reasons: RobotErrors,
    /// Requests of this kind get no reply.
    pub deaf_to: Option<Kind>,
    /// Instead of success.
    pub connect: Option<(ConnectStatus, u16)>,
    pub setter: SetterStatus,
    pub model: ModelStatus,
    pub started: MoveStatus,
    pub recovery: RecoveryStatus,
    pub abort: Option<Abort>,
    /// Whether a Move is followed by states that show it.
    pub moves: bool,
    /// Whether it ends a motion when it is asked to.
    pub ends: bool,
    /// States behind which the second reply to Move comes; negative: before.
    pub reply_late: i32,
    /// Bytes that fill up every reply.
    pub padding: usize,
    /// Bytes of a TCP piece.
    pub piece: usize,
    /// Requests that have come.
    pub heard: Vec<Request>,
    /// Answers to states.
    pub answers: u32,
    /// Of those, with the flag.
    pub last: u32,
    message_id: u64,
    stream: Stream<[u8; REQUEST_LEN_MAX]>,
    motion: Option<u32>,
    runs: bool,
    /// Second reply, and the states until it goes.
    due: Option<(u32, MoveStatus, i32)>,
    tcp: Vec<u8>,
}

impl Robot {
    pub fn new(version: Version) -> Self {
        Self {
            version,
            mode: RobotMode::Idle,
            reasons: RobotErrors::NONE,
            deaf_to: None,
            connect: None,
            setter: SetterStatus::Success,
            model: ModelStatus::Success,
            started: MoveStatus::MotionStarted,
            recovery: RecoveryStatus::Success,
            abort: None,
            moves: true,
            ends: true,
            reply_late: 0,
            padding: 0,
            piece: 5,
            heard: Vec::new(),
            answers: 0,
            last: 0,
            message_id: 1_000_000,
            stream: Stream::with_room(REQUEST_LEN_MAX),
            motion: None,
            runs: false,
            due: None,
            tcp: Vec::new(),
        }
    }

    pub fn heard(&self, kind: Kind) -> usize {
        let same = |request: &&Request| request.kind() == kind;
        self.heard.iter().filter(same).count()
    }

    fn say(&mut self, id: u32, reply: &Reply<'_>) {
        if self.deaf_to == Some(reply.kind()) {
            return;
        }
        let mut room = [0; 1 << 12];
        let message = reply.emit(self.version, id, &mut room).expect("a reply");
        let at = self.tcp.len();
        self.tcp.extend(message);
        let size = (message.len() + self.padding) as u32;
        self.tcp[at + 8..at + 12].copy_from_slice(&size.to_le_bytes());
        self.tcp.extend(vec![0xAA; self.padding]);
    }

    fn take(&mut self, mut bytes: &[u8]) {
        let mut requests = Vec::new();
        while let Some(message) = self.stream.next(&mut bytes).expect("a request") {
            let request = Request::parse(self.version, &message).expect("a request");
            requests.push((message.id, request));
        }
        for (id, request) in requests {
            self.heard.push(request);
            self.request(id, &request);
        }
    }

    fn request(&mut self, id: u32, request: &Request) {
        if let Some(setter) = Setter::of(request.kind()) {
            let status = self.setter;
            return self.say(id, &Reply::Setter { setter, status });
        }
        match request {
            Request::Connect(connect) => {
                let own = self.version.number();
                let right = connect.version == own;
                let (status, version) = self.connect.unwrap_or(if right {
                    (ConnectStatus::Success, own)
                } else {
                    (ConnectStatus::IncompatibleVersion, own)
                });
                self.say(id, &Reply::Connect { status, version });
            }
            Request::GetRobotModel => {
                let (status, urdf) = (self.model, URDF.as_bytes());
                self.say(id, &Reply::RobotModel { status, urdf });
            }
            Request::Move(_) => {
                if self.started == MoveStatus::MotionStarted {
                    self.motion = Some(id);
                    self.runs = self.moves;
                }
                self.say(id, &Reply::Move(self.started));
            }
            Request::StopMove => {
                self.end(self.mode, MoveStatus::Preempted);
                self.say(id, &Reply::StopMove(StopMoveStatus::Success));
            }
            Request::AutomaticErrorRecovery => {
                if self.recovery == RecoveryStatus::Success {
                    self.mode = RobotMode::Idle;
                }
                self.say(id, &Reply::Recovery(self.recovery));
            }
            other => panic!("{other:?}: not expected"),
        }
    }

    fn end(&mut self, mode: RobotMode, status: MoveStatus) {
        if let Some(id) = self.motion.take() {
            self.runs = false;
            self.mode = mode;
            self.due = Some((id, status, self.reply_late));
        }
    }

    /// The next state.
    fn state(&mut self) -> Facts {
        self.message_id += 1;
        let early = self.due.is_some_and(|(.., left)| left < 0);
        let mut facts = Facts {
            message_id: self.message_id,
            robot_mode: self.mode,
            errors: self.reasons,
            reflex_reason: self.reasons,
            ..Facts::default()
        };
        if self.runs || early {
            let torque = match self.version {
                Version::V10 => Generator::None,
                _ => Generator::JointVelocity,
            };
            facts.robot_mode = RobotMode::Move;
            facts.motion_generator_mode = torque.into();
            facts.controller_mode = ControllerMode::External;
        } else {
            facts.motion_generator_mode = MotionGeneratorMode::Idle;
        }
        facts
    }

    fn answer(&mut self, last: bool) {
        self.answers += 1;
        self.last += u32::from(last);
        match self.abort {
            Some(abort) if self.answers == abort.answers => {
                self.reasons = abort.reasons;
                self.end(abort.mode, abort.status.unwrap_or(MoveStatus::Aborted));
                if abort.status.is_none() {
                    self.due = None;
                }
            }
            _ if last && self.ends => self.end(RobotMode::Idle, MoveStatus::Success),
            _ => {}
        }
    }

    /// Bytes for the client.
    fn replies(&mut self) -> Vec<u8> {
        if let Some((id, status, left)) = self.due {
            // Early ones go at once, and the state follows some cycles behind.
            if left == 0 || left == self.reply_late && left < 0 {
                self.say(id, &Reply::Move(status));
            }
            self.due = (left != 0).then_some((id, status, left - left.signum()));
        }
        std::mem::take(&mut self.tcp)
    }
}

/// The host: what it has received.
#[derive(Default)]
pub struct Host {
    pub urdf: Vec<u8>,
    /// Bytes of TCP that went out.
    pub sent: Vec<u8>,
    pub duties: Vec<Duty>,
}

impl ModelSink for Host {
    fn piece(&mut self, urdf: &[u8]) {
        self.urdf.extend(urdf);
    }
}

impl Host {
    /// Bytes from the machine to the robot, a few at a time.
    pub fn send(&mut self, client: &mut Client, robot: &mut Robot) {
        while !client.transmit().is_empty() {
            let count = client.transmit().len().min(7);
            let bytes = client.transmit()[..count].to_vec();
            client.transmitted(count);
            robot.take(&bytes);
            self.sent.extend(bytes);
        }
    }

    /// A millisecond: everything that is due, and a state.
    pub fn cycle(&mut self, client: &mut Client, robot: &mut Robot) -> Duty {
        if client.wants_new_connection() {
            robot.stream.reset();
            client.connected(50_000);
        }
        self.send(client, robot);
        for piece in robot.replies().chunks(robot.piece) {
            client.receive(piece, self);
        }
        let facts = robot.state();
        let duty = client.state(&facts);
        if duty != Duty::Listen {
            robot.answer(duty == Duty::Finish);
        }
        self.duties.push(duty);
        duty
    }
}

/// What the host wishes, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// As soon as it runs for so many answers.
    Finish(u32),
    Halt(u32),
    /// The TCP connection closes.
    Close(u32),
    /// Nothing comes any more.
    Silence(u32),
    Nothing,
}

/// A whole conversation, at most 5 s of it.
pub fn talk(robot: &mut Robot, may_recover: bool, wish: Wish) -> (Stop, Client, Host) {
    let (mut client, mut host) = (Client::new(may_recover), Host::default());
    client.connected(50_000);
    for _ in 0..5000 {
        host.cycle(&mut client, robot);
        if client.phase() == Phase::Ready {
            client.start(&START);
        }
        let behind = |answers| robot.answers >= answers;
        match wish {
            Wish::Finish(answers) if behind(answers) => client.finish(),
            Wish::Halt(answers) if behind(answers) => client.halt(),
            Wish::Close(answers) if behind(answers) => client.closed(),
            Wish::Silence(answers) if behind(answers) => client.silent(),
            _ => {}
        }
        if let Some(stop) = client.stopped() {
            return (stop, client, host);
        }
    }
    panic!("no end: {:?}", client.phase());
}
