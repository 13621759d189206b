//! Both ends of a conversation, told of it event by event: each hears only bytes of the other one.

use std::fmt::Debug;

use fci::client::{Client, Duty, Facts, Phase, Start};
use fci::robot::{
    Arm, Broken, Drive, Handled, IDENTITY, Limits, Operator, Received, Robot, Settings,
};
use fci::{Command, StatePacket, Version, command, state};

/// The model of the robot.
pub const URDF: &[u8] = b"<robot name=\"fr3\"/>";

/// The usual posture, in the ranges of both arms.
const READY: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

/// Cycles of a recovery.
const RECOVERY: u32 = 3;

/// An end without sockets: all that it does is what it says to what it is told.
pub trait Machine: Clone {
    type Event;
    type Said: Clone + Debug + PartialEq;

    fn tell(&mut self, event: &Self::Event) -> Self::Said;
}

/// What a client is told.
pub enum ToClient {
    Connected,
    /// Of the stream.
    Bytes(Vec<u8>),
    State(Vec<u8>),
    Start,
    Finish,
    Halt,
}

/// What it says to that.
#[derive(Clone, Debug, PartialEq)]
pub struct ClientSaid {
    /// Into the stream.
    pub sent: Vec<u8>,
    pub duty: Duty,
    pub phase: Phase,
    pub wants_new_connection: bool,
}

impl Machine for Client {
    type Event = ToClient;
    type Said = ClientSaid;

    fn tell(&mut self, event: &ToClient) -> ClientSaid {
        let mut duty = Duty::Listen;
        match event {
            ToClient::Connected => self.connected(50_000),
            ToClient::Bytes(bytes) => self.receive(bytes, &mut ()),
            ToClient::State(datagram) => {
                if let Ok(packet) = StatePacket::new_checked(self.version(), &datagram[..]) {
                    duty = self.state(&Facts::of(&packet));
                }
            }
            ToClient::Start => self.start(&Start::uniform(20.0, 20.0)),
            ToClient::Finish => self.finish(),
            ToClient::Halt => self.halt(),
        }
        let sent = self.transmit().to_vec();
        self.transmitted(sent.len());
        ClientSaid {
            sent,
            duty,
            phase: self.phase(),
            wants_new_connection: self.wants_new_connection(),
        }
    }
}

/// What a robot is told.
pub enum ToRobot {
    Disconnected,
    /// Of the stream.
    Bytes(Vec<u8>),
    /// What the arm and the person at it do: a state is due.
    State(Box<Arm>, Operator),
    Command(Vec<u8>),
    Advance,
}

/// What it says to that.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotSaid {
    /// Into the stream.
    pub replies: Vec<u8>,
    /// Requests, one by one; none behind one that breaks the connection.
    pub handled: Vec<Result<Handled, Broken>>,
    pub state: Vec<u8>,
    pub received: Option<Received>,
    pub drive: Option<Drive>,
}

impl RobotSaid {
    /// What is due, all of it: how many bytes.
    fn drain(&mut self, robot: &mut Robot<&'static [u8]>) -> usize {
        let (mut room, before) = ([0; 64], self.replies.len());
        loop {
            let count = robot.replies(&mut room);
            if count == 0 {
                return self.replies.len() - before;
            }
            self.replies.extend(&room[..count]);
        }
    }

    fn take(&mut self, robot: &mut Robot<&'static [u8]>, mut bytes: &[u8]) {
        loop {
            match robot.receive(&mut bytes) {
                Ok(Some(handled)) => self.handled.push(Ok(handled)),
                Err(broken) => return self.handled.push(Err(broken)),
                Ok(None) if bytes.is_empty() => return,
                Ok(None) => assert!(self.drain(robot) > 0, "{} bytes are left", bytes.len()),
            }
        }
    }
}

impl Machine for Robot<&'static [u8]> {
    type Event = ToRobot;
    type Said = RobotSaid;

    fn tell(&mut self, event: &ToRobot) -> RobotSaid {
        let mut said = RobotSaid::default();
        match event {
            ToRobot::Disconnected => self.disconnect(),
            ToRobot::Bytes(bytes) => said.take(self, bytes),
            ToRobot::State(arm, operator) => {
                let (version, mut room) = (self.version(), [0; state::LEN_MAX]);
                let state = self.state(arm, operator);
                let datagram = state.emit(version, &mut room);
                said.state = datagram.expect("modes of the version").to_vec();
            }
            ToRobot::Command(datagram) => said.received = Some(self.command(datagram)),
            ToRobot::Advance => said.drive = Some(self.advance()),
        }
        said.drain(self);
        said
    }
}

/// A place of a conversation: an end as it was, what it was told there, and what it said.
#[allow(dead_code)] // of those that only talk
pub struct Place<M: Machine> {
    pub machine: M,
    pub event: M::Event,
    pub said: M::Said,
}

fn told<M: Machine>(
    machine: &mut M,
    event: M::Event,
    places: Option<&mut Vec<Place<M>>>,
) -> M::Said {
    let before = places.is_some().then(|| machine.clone());
    let said = machine.tell(&event);
    if let (Some(places), Some(machine)) = (places, before) {
        let said = said.clone();
        places.push(Place {
            machine,
            event,
            said,
        });
    }
    said
}

/// All places of a conversation, of either end.
#[derive(Default)]
pub struct Places {
    pub client: Vec<Place<Client>>,
    pub robot: Vec<Place<Robot<&'static [u8]>>>,
}

/// Two ends of a connection.
pub struct Pair {
    pub client: Client,
    pub robot: Robot<&'static [u8]>,
    pub operator: Operator,
    pub arm: Arm,
    /// Torque that the client commands \[Nm\].
    pub torque: f64,
    /// Cycles that are left in which nothing of the client's arrives by UDP.
    pub gone: u32,
    pub answers: u32,
    /// None: they are not kept.
    pub places: Option<Places>,
    /// Bytes on their way.
    sent: Vec<u8>,
    replies: Vec<u8>,
}

impl Pair {
    pub fn new(
        version: Version,
        may_recover: bool,
        model: &'static [u8],
        places: Option<Places>,
    ) -> Self {
        let mut o_t_f = IDENTITY;
        o_t_f[12..15].copy_from_slice(&[0.3, 0.0, 0.6]);
        let limits = match version {
            Version::V5 => Limits::PANDA,
            _ => Limits::FR3,
        };
        let settings = Settings {
            recovery_cycles: RECOVERY,
            ..Settings::new(version, limits)
        };
        let mut pair = Self {
            client: Client::new(may_recover),
            robot: Robot::new(settings, model),
            operator: Operator::ABSENT,
            arm: Arm {
                q: READY,
                dq: [0.0; 7],
                tau_j: [0.0; 7],
                tau_ext: [0.0; 7],
                wrench: [0.0; 6],
                o_t_f,
                twist: [0.0; 6],
                theta: READY,
                dtheta: [0.0; 7],
            },
            torque: 0.0,
            gone: 0,
            answers: 0,
            places,
            sent: Vec::new(),
            replies: Vec::new(),
        };
        pair.tell_client(ToClient::Connected);
        pair
    }

    pub fn tell_client(&mut self, event: ToClient) -> Duty {
        let places = self.places.as_mut().map(|places| &mut places.client);
        let said = told(&mut self.client, event, places);
        self.sent.extend(said.sent);
        said.duty
    }

    fn tell_robot(&mut self, event: ToRobot) -> RobotSaid {
        let places = self.places.as_mut().map(|places| &mut places.robot);
        let said = told(&mut self.robot, event, places);
        self.replies.extend(&said.replies);
        said
    }

    /// A millisecond.
    pub fn cycle(&mut self) {
        if self.client.wants_new_connection() {
            self.tell_robot(ToRobot::Disconnected);
            self.tell_client(ToClient::Connected);
        }
        if !self.sent.is_empty() {
            let sent = std::mem::take(&mut self.sent);
            let said = self.tell_robot(ToRobot::Bytes(sent));
            assert!(said.handled.iter().all(Result::is_ok), "{:?}", said.handled);
        }
        if !self.replies.is_empty() {
            let replies = std::mem::take(&mut self.replies);
            self.tell_client(ToClient::Bytes(replies));
        }
        let version = self.robot.version();
        let event = ToRobot::State(Box::new(self.arm), self.operator);
        let datagram = self.tell_robot(event).state;
        if version == self.client.version() && self.robot.client().is_some() {
            let packet = StatePacket::new_checked(version, &datagram[..]).expect("a state");
            let message_id = packet.message_id();
            let duty = self.tell_client(ToClient::State(datagram));
            if self.gone > 0 {
                self.gone -= 1;
            } else if duty != Duty::Listen {
                let last = duty == Duty::Finish;
                let answer = Command::torque(version, message_id, [self.torque; 7], last);
                let mut room = [0; command::LEN_MAX];
                let bytes = answer.emit(version, &mut room).to_vec();
                self.tell_robot(ToRobot::Command(bytes));
                self.answers += 1;
            }
        }
        self.tell_robot(ToRobot::Advance);
        if self.client.phase() == Phase::Ready {
            self.tell_client(ToClient::Start);
        }
    }

    /// Until the motion has run for so many answers.
    pub fn moving(&mut self, answers: u32) {
        for _ in 0..10_000 {
            if self.answers >= answers {
                return;
            }
            self.cycle();
        }
        panic!("no motion: {:?}", self.client.phase());
    }

    /// Until the client has stopped.
    pub fn end(&mut self) -> fci::client::Stop {
        for _ in 0..3000 {
            self.cycle();
            if let Some(stop) = self.client.stopped() {
                return stop;
            }
        }
        panic!("no end: {:?}", self.client.phase());
    }
}
