//! A client without a controller: the client's end of the interface, for robots of others.
//!
//! ```sh
//! cargo run --release -p fci --example client -- ADDRESS VERSION
//! ```
//!
//! It connects, sets collision thresholds and commands torque for 2 s, none at first, then a sine of
//! 0.1 Nm: a robot that adds gravity floats. Exit code 0: every reply is a success and the motion
//! ends as it should. How far the torque that acted is from the one sent is printed; robots may
//! filter it.

use std::error::Error;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::process::ExitCode;
use std::time::Duration;

use fci::request::CollisionBehavior;
use fci::sequence::Arrival;
use fci::state::{LEN_MAX, field};
use fci::status::{ConnectStatus, MoveStatus, SetterStatus};
use fci::stream::REQUEST_LEN_MAX;
use fci::{
    Command, Connect, ControllerMode, MotionGeneratorMode, Move, Reply, Request, RobotMode,
    Sequence, State, StatePacket, Stream, Version, command,
};

/// Answers of the motion.
const CYCLES: u32 = 2000;
/// How long anything is waited for.
const PATIENCE: Duration = Duration::from_secs(2);

type Outcome<T> = Result<T, Box<dyn Error>>;

struct Client {
    version: Version,
    tcp: TcpStream,
    udp: UdpSocket,
    stream: Stream<Vec<u8>>,
    /// Received, and not yet taken.
    bytes: Vec<u8>,
    next_id: u32,
    sequence: Sequence,
    lost: u64,
}

impl Client {
    fn new(address: SocketAddr, version: Version) -> Outcome<Self> {
        let tcp = TcpStream::connect(address)?;
        tcp.set_read_timeout(Some(PATIENCE))?;
        tcp.set_nodelay(true)?;
        let udp = UdpSocket::bind(("0.0.0.0", 0))?;
        udp.set_read_timeout(Some(PATIENCE))?;
        Ok(Self {
            version,
            tcp,
            udp,
            stream: Stream::new(vec![0; 256], 1 << 20)?,
            bytes: Vec::new(),
            next_id: 0,
            sequence: Sequence::new(),
            lost: 0,
        })
    }

    /// Sends a request: its id.
    fn send(&mut self, request: &Request) -> Outcome<u32> {
        request.check()?;
        let id = self.next_id;
        self.next_id += 1;
        let mut room = [0; REQUEST_LEN_MAX];
        self.tcp
            .write_all(request.emit(self.version, id, &mut room)?)?;
        Ok(id)
    }

    /// Waits for a reply to the request with this id.
    fn reply<T>(&mut self, id: u32, read: impl Fn(Reply<'_>) -> Option<T>) -> Outcome<T> {
        loop {
            let mut rest = &self.bytes[..];
            while let Some(message) = self.stream.next(&mut rest)? {
                let reply = Reply::parse(self.version, &message)?;
                if message.id == id {
                    let unwanted = format!("{reply:?}: another reply than expected");
                    let read = read(reply).ok_or(unwanted);
                    let left = rest.len();
                    self.bytes.drain(..self.bytes.len() - left);
                    return Ok(read?);
                }
            }
            let mut room = [0; 4096];
            let count = self.tcp.read(&mut room)?;
            if count == 0 {
                return Err("robot: closed the connection".into());
            }
            self.bytes.clear();
            self.bytes.extend(&room[..count]);
        }
    }

    /// The newest state that waits, or the next one.
    fn state(&mut self) -> Outcome<(State, SocketAddr)> {
        loop {
            let mut room = [0; LEN_MAX + 1];
            let (mut count, mut from) = self.udp.recv_from(&mut room)?;
            self.udp.set_nonblocking(true)?;
            while let Ok(newer) = self.udp.recv_from(&mut room) {
                (count, from) = newer;
            }
            self.udp.set_nonblocking(false)?;
            let packet = StatePacket::new_checked(self.version, &room[..count])?;
            packet.check_finite(&[field::Q, field::DQ, field::TAU_J_D])?;
            match self.sequence.receive(packet.message_id()) {
                Arrival::Old => continue,
                Arrival::First => {}
                Arrival::Next { lost } => self.lost += lost,
            }
            return Ok((State::parse(&packet), from));
        }
    }

    fn motion(&mut self) -> Outcome<()> {
        let wanted = Move::torque(self.version);
        let id = self.send(&Request::Move(wanted))?;
        let status = self.reply(id, |reply| match reply {
            Reply::Move(status) => Some(status),
            _ => None,
        })?;
        if !status.is_running() {
            return Err(format!("Move: {status}; expected: {}", MoveStatus::MotionStarted).into());
        }
        let modes = (wanted.generator.into(), wanted.controller.into());
        let runs = |state: &State| {
            state.robot_mode == RobotMode::Move
                && (state.motion_generator_mode, state.controller_mode) == modes
        };
        while !runs(&self.state()?.0) {}
        self.lost = 0;
        let (mut last, mut wrong) = ([0.0; 7], 0f64);
        for cycle in 0..CYCLES {
            let (state, robot) = self.state()?;
            if !runs(&state) {
                return Err(format!("motion: {}; expected: none", state.reflex_reason).into());
            }
            let pairs = state.tau_j_d.iter().zip(last);
            wrong = pairs.fold(wrong, |wrong, (acted, sent)| {
                wrong.max((acted - sent).abs())
            });
            let finished = cycle + 1 == CYCLES;
            last = std::array::from_fn(|i| {
                let phase = 0.01 * f64::from(cycle.saturating_sub(50));
                0.1 * phase.sin() * f64::from(1 - 2 * (i as i32 % 2))
            });
            let answer = Command::torque(self.version, state.message_id, last, finished);
            answer.check()?;
            let mut room = [0; command::LEN_MAX];
            self.udp
                .send_to(answer.emit(self.version, &mut room), robot)?;
        }
        // The last command, until the state shows the end.
        loop {
            let (state, robot) = self.state()?;
            let idle = (MotionGeneratorMode::Idle, ControllerMode::Other);
            if (state.motion_generator_mode, state.controller_mode) == idle {
                break;
            }
            let answer = Command::torque(self.version, state.message_id, last, true);
            let mut room = [0; command::LEN_MAX];
            self.udp
                .send_to(answer.emit(self.version, &mut room), robot)?;
        }
        let end = self.reply(id, |reply| match reply {
            Reply::Move(status) => Some(status),
            _ => None,
        })?;
        println!(
            "torque: {CYCLES} answers, {} states lost, largest difference of tau_J_d {wrong:.1e} Nm, end: {end}",
            self.lost
        );
        match end {
            MoveStatus::Success => Ok(()),
            other => Err(format!("Move: {other}; expected: {}", MoveStatus::Success).into()),
        }
    }
}

fn run() -> Outcome<()> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [address, version] = &given[..] else {
        return Err(format!("arguments: {given:?}; allowed: ADDRESS VERSION").into());
    };
    let version = Version::from_number(version.parse()?)?;
    let mut client = Client::new(address.parse()?, version)?;
    let connect = Connect {
        version: version.number(),
        udp_port: client.udp.local_addr()?.port(),
    };
    let id = client.send(&Request::Connect(connect))?;
    let (status, robots) = client.reply(id, |reply| match reply {
        Reply::Connect { status, version } => Some((status, version)),
        _ => None,
    })?;
    if status != ConnectStatus::Success {
        return Err(format!(
            "Connect: {status}, {robots}; expected: {}",
            version.number()
        )
        .into());
    }
    let (state, _) = client.state()?;
    println!("version {}, q {:.3?} rad", version.number(), state.q);
    println!("robot mode {}, errors {}", state.robot_mode, state.errors);

    let (torque, force) = ([100.0; 7], [100.0; 6]);
    let id = client.send(&Request::SetCollisionBehavior(CollisionBehavior {
        lower_torque_acceleration: torque,
        upper_torque_acceleration: torque,
        lower_torque_nominal: torque,
        upper_torque_nominal: torque,
        lower_force_acceleration: force,
        upper_force_acceleration: force,
        lower_force_nominal: force,
        upper_force_nominal: force,
    }))?;
    let status = client.reply(id, |reply| match reply {
        Reply::Setter { status, .. } => Some(status),
        _ => None,
    })?;
    println!("collision thresholds: {status}");
    if status != SetterStatus::Success {
        return Err(format!("collision thresholds: {status}; expected: success").into());
    }
    client.motion()
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
