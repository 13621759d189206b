//! A robot, and a client of whom every byte is the test's.

use fci::robot::{
    Arm, Broken, Drive, Handled, IDENTITY, Limits, Operator, Received, Robot, Settings,
};
use fci::status::{MoveStatus, RecoveryStatus, SetterStatus, StopMoveStatus};
use fci::stream::REQUEST_LEN_MAX;
use fci::{
    Command, Connect, Controller, ControllerMode, Generator, MotionGeneratorMode, Move, Reply,
    Request, RobotErrors, RobotMode, State, StatePacket, Stream, Version, command, state,
};

pub const MODEL: &[u8] = b"<robot name=\"fr3\"/>";

/// The usual posture, in the ranges of both arms.
pub const READY: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

/// The arm at rest.
pub fn rest() -> Arm {
    let mut o_t_f = IDENTITY;
    o_t_f[12..15].copy_from_slice(&[0.3, 0.0, 0.6]);
    Arm {
        q: READY,
        dq: [0.0; 7],
        tau_j: [0.0; 7],
        tau_ext: [0.0; 7],
        wrench: [0.0; 6],
        o_t_f,
        twist: [0.0; 6],
        theta: READY,
        dtheta: [0.0; 7],
    }
}

pub struct Bench {
    pub robot: Robot<&'static [u8]>,
    pub arm: Arm,
    pub operator: Operator,
    /// The last state, as a client reads it.
    pub state: State,
    next_id: u32,
}

impl Bench {
    /// Nobody is connected.
    pub fn silent(settings: Settings) -> Self {
        Self {
            robot: Robot::new(settings, MODEL),
            arm: rest(),
            operator: Operator::ABSENT,
            state: State::default(),
            next_id: 0,
        }
    }

    /// A client of the same version.
    pub fn with(settings: Settings) -> Self {
        let version = settings.version.number();
        let mut bench = Self::silent(settings);
        let udp_port = 5000;
        bench.ask(&Request::Connect(Connect { version, udp_port }));
        assert_eq!(bench.robot.client().map(|it| it.udp_port), Some(5000));
        bench.drain();
        bench.cycle();
        bench
    }

    pub fn new(version: Version) -> Self {
        Self::with(settings(version))
    }

    pub fn version(&self) -> Version {
        self.robot.version()
    }

    /// The bytes of a request, with the next id.
    pub fn bytes(&mut self, request: &Request) -> Vec<u8> {
        let mut room = [0; REQUEST_LEN_MAX];
        let id = self.next_id;
        self.next_id += 1;
        let bytes = request.emit(self.version(), id, &mut room);
        bytes.expect("a request of the version").to_vec()
    }

    /// Bytes of the stream, of one request at most.
    pub fn feed(&mut self, mut bytes: &[u8]) -> Result<Option<Handled>, Broken> {
        let handled = self.robot.receive(&mut bytes);
        assert!(handled.is_err() || bytes.is_empty());
        handled
    }

    /// A request: its id, and how it was handled.
    pub fn ask(&mut self, request: &Request) -> Handled {
        let bytes = self.bytes(request);
        let handled = self.feed(&bytes).expect("a connection");
        handled.expect("a whole request")
    }

    /// What is due: everything, by id, with the text of the reply.
    pub fn drain(&mut self) -> Vec<(u32, String)> {
        let (mut all, mut room) = (Vec::new(), [0; 16]);
        loop {
            let count = self.robot.replies(&mut room);
            if count == 0 {
                break;
            }
            all.extend(&room[..count]);
        }
        let mut stream = Stream::new(vec![0; 1 << 16], 1 << 16).expect("room");
        let (mut rest, mut replies) = (&all[..], Vec::new());
        while let Some(message) = stream.next(&mut rest).expect("sizes") {
            let reply = Reply::parse(self.version(), &message).expect("a reply");
            replies.push((message.id, format!("{reply:?}")));
        }
        replies
    }

    /// The next state.
    pub fn cycle(&mut self) {
        let mut room = [0; state::LEN_MAX];
        let version = self.version();
        let state = self.robot.state(&self.arm, &self.operator);
        let datagram = state
            .emit(version, &mut room)
            .expect("modes of the version");
        let packet = StatePacket::new_checked(version, datagram).expect("a state");
        self.state = State::parse(&packet);
    }

    /// A command of torque to the last state.
    pub fn torque(&self, torque: [f64; 7]) -> Command {
        Command::torque(self.version(), self.state.message_id, torque, false)
    }

    pub fn command(&mut self, command: &Command) -> Received {
        let mut room = [0; command::LEN_MAX];
        let version = self.version();
        self.robot.command(command.emit(version, &mut room))
    }

    /// A cycle that is answered: what acts, and the state behind it.
    pub fn answered(&mut self, torque: [f64; 7]) -> Drive {
        assert_eq!(self.command(&self.torque(torque)), Received::Accepted);
        self.unanswered()
    }

    pub fn unanswered(&mut self) -> Drive {
        let drive = self.robot.advance();
        self.cycle();
        drive
    }

    /// A motion of torque, shown by the state; the id of Move.
    pub fn moving(&mut self) -> u32 {
        let handled = self.ask(&Request::Move(Move::torque(self.version())));
        assert_eq!(handled.refused, None);
        let id = handled.id;
        assert_eq!(self.drain(), [(id, moved(MoveStatus::MotionStarted))]);
        self.unanswered();
        self.check_moving();
        id
    }

    /// Running, and answered.
    pub fn running(version: Version) -> (Self, u32) {
        let mut bench = Self::new(version);
        let id = bench.moving();
        assert_eq!(bench.answered([0.0; 7]), Drive::Torque([0.0; 7]));
        (bench, id)
    }

    pub fn check_moving(&self) {
        let generator = match Move::torque(self.version()).generator {
            Generator::None => MotionGeneratorMode::None,
            _ => MotionGeneratorMode::JointVelocity,
        };
        let modes = (
            self.state.robot_mode,
            self.state.motion_generator_mode,
            self.state.controller_mode,
        );
        assert_eq!(
            modes,
            (RobotMode::Move, generator, ControllerMode::External)
        );
        assert_eq!(self.state.errors, RobotErrors::NONE);
    }

    /// No motion, in this mode.
    pub fn check_still(&self, mode: RobotMode) {
        let modes = (
            self.state.robot_mode,
            self.state.motion_generator_mode,
            self.state.controller_mode,
        );
        let still = (MotionGeneratorMode::Idle, ControllerMode::Other);
        assert_eq!(modes, (mode, still.0, still.1));
        assert_eq!(self.state.control_command_success_rate, 0.0);
    }

    /// Asks for a recovery and lets it end.
    pub fn recover(&mut self) -> Vec<(u32, String)> {
        let id = self.ask(&Request::AutomaticErrorRecovery).id;
        for _ in 0..200 {
            let replies = self.drain();
            if replies.iter().any(|(of, _)| *of == id) {
                return replies;
            }
            self.unanswered();
        }
        panic!("no reply to the recovery");
    }
}

pub fn settings(version: Version) -> Settings {
    let limits = match version {
        Version::V5 => Limits::PANDA,
        _ => Limits::FR3,
    };
    Settings::new(version, limits)
}

pub fn moved(status: MoveStatus) -> String {
    format!("{:?}", Reply::Move(status))
}

pub fn stopped(status: StopMoveStatus) -> String {
    format!("{:?}", Reply::StopMove(status))
}

pub fn recovered(status: RecoveryStatus) -> String {
    format!("{:?}", Reply::Recovery(status))
}

pub fn set(setter: fci::Setter, status: SetterStatus) -> String {
    format!("{:?}", Reply::Setter { setter, status })
}

pub fn wanted(controller: Controller, generator: Generator) -> Request {
    Request::Move(Move::new(controller, generator))
}
