//! The robot's end without an arm, for clients of others: sockets around [`fci::robot`].
//!
//! ```sh
//! cargo run --release -p fci --example robot -- ADDRESS VERSION CLIENTS [LOSS [PATIENCE]]
//! ```
//!
//! It serves so many clients one after the other and ends. While no motion runs all numbers of its
//! state differ, and errors, reflex reasons and modes show one after the other. Standard output has
//! them, the requests as they were understood, and the motions. It takes every motion and follows
//! none. In a motion it waits for the answer to each state behind the first one that is answered,
//! PATIENCE ms at most, 500 if not given. LOSS is the share of states and of commands that it loses,
//! 0 to 1, 0 if not given.

mod shown;
mod urdf;

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

use fci::robot::{Operator, Received, Robot};
use fci::stream::REQUEST_LEN_MAX;
use fci::{Command, RobotMode, Version, command, state};
use shown::Shown;

const CYCLE: Duration = Duration::from_millis(1);
/// How often sockets are looked at.
const POLL: Duration = Duration::from_micros(50);

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

struct Arguments {
    address: SocketAddr,
    version: Version,
    clients: usize,
    loss: f64,
    /// How long an answer is waited for: clients give up after 1 s without a state.
    patience: Duration,
}

fn arguments() -> Outcome<Arguments> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let wrong = format!(
        "arguments: {given:?}; allowed: ADDRESS VERSION CLIENTS [LOSS 0 to 1 [PATIENCE in ms]]"
    );
    let (required, optional) = given.split_at_checked(3).ok_or(wrong.clone())?;
    let [address, version, clients] = required else {
        return Err(wrong.into());
    };
    let (loss, patience) = match optional {
        [] => ("0", "500"),
        [loss] => (loss.as_str(), "500"),
        [loss, patience] => (loss.as_str(), patience.as_str()),
        _ => return Err(wrong.into()),
    };
    let loss = loss.parse().map_err(|_| wrong.clone())?;
    if !(0.0..=1.0).contains(&loss) {
        return Err(wrong.into());
    }
    Ok(Arguments {
        address: address.parse()?,
        version: Version::from_number(version.parse()?)?,
        clients: clients.parse()?,
        loss,
        patience: Duration::from_millis(patience.parse()?),
    })
}

fn main() -> ExitCode {
    match arguments().and_then(|arguments| serve(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn serve(arguments: &Arguments) -> Outcome<()> {
    let listener = TcpListener::bind(arguments.address)?;
    let version = arguments.version;
    let shown = Shown::new(version);
    let mut robot = Robot::new(shown.settings(version), urdf::text());
    println!(
        "listening {} version {}",
        arguments.address,
        version.number()
    );
    shown.print();
    for _ in 0..arguments.clients {
        let (tcp, client) = listener.accept()?;
        println!("client");
        let outcome = Connection::new(arguments, tcp, client.ip())?.run(&mut robot, &shown);
        robot.disconnect();
        tell_end(&mut robot);
        match outcome {
            Ok(()) => println!("closed"),
            Err(error) => println!("closed: {error}"),
        }
    }
    Ok(())
}

fn tell_end(robot: &mut Robot<String>) {
    if let Some(ended) = robot.ended() {
        let (commands, lost, status) = (ended.commands, ended.lost, ended.status);
        println!("motion {commands} commands, {lost} lost: {status}");
    }
}

/// The sockets of one client.
struct Connection<'a> {
    arguments: &'a Arguments,
    tcp: TcpStream,
    udp: UdpSocket,
    client: IpAddr,
    /// The stream's bytes that wait for replies to go out.
    bytes: Vec<u8>,
    random: u64,
    /// What the client cannot answer, or has answered in vain, is not waited for.
    lost: bool,
}

/// What a socket that is asked and does not wait has.
fn arrived<T>(received: io::Result<T>) -> io::Result<Option<T>> {
    match received {
        Ok(count) => Ok(Some(count)),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
        Err(error) => Err(error),
    }
}

impl<'a> Connection<'a> {
    fn new(arguments: &'a Arguments, tcp: TcpStream, client: IpAddr) -> io::Result<Self> {
        let udp = UdpSocket::bind((arguments.address.ip(), 0))?;
        tcp.set_nonblocking(true)?;
        tcp.set_nodelay(true)?;
        udp.set_nonblocking(true)?;
        Ok(Self {
            arguments,
            tcp,
            udp,
            client,
            bytes: Vec::new(),
            random: 1,
            lost: false,
        })
    }

    /// Whether this datagram is lost: always the same ones.
    fn loses(&mut self) -> bool {
        // Marsaglia's generator with shifts of 13, 7 and 17.
        for shift in [13, -7, 17_i32] {
            let shifted = match shift {
                left @ 0.. => self.random << left,
                right => self.random >> -right,
            };
            self.random ^= shifted;
        }
        ((self.random >> 11) as f64) < self.arguments.loss * (1_u64 << 53) as f64
    }

    /// Until the client closes.
    fn run(&mut self, robot: &mut Robot<String>, shown: &Shown) -> Outcome<()> {
        let mut last = Instant::now();
        loop {
            if self.talk(robot)? {
                return Ok(());
            }
            self.take_commands(robot)?;
            tell_end(robot);
            let elapsed = last.elapsed();
            let patient = elapsed < self.arguments.patience && !self.lost;
            if elapsed >= CYCLE && !(robot.waits() && patient) {
                last = Instant::now();
                self.cycle(robot, shown)?;
            }
            sleep(POLL);
        }
    }

    /// Requests and replies; whether the client has closed.
    fn talk(&mut self, robot: &mut Robot<String>) -> Outcome<bool> {
        let mut room = [0; REQUEST_LEN_MAX];
        // What waits for replies is served first.
        if self.bytes.is_empty()
            && let Some(count) = arrived(self.tcp.read(&mut room))?
        {
            if count == 0 {
                return Ok(true);
            }
            self.bytes.extend(&room[..count]);
        }
        let mut rest = &self.bytes[..];
        let outcome = loop {
            match robot.receive(&mut rest) {
                Ok(Some(handled)) => {
                    if let Some(request) = handled.request {
                        println!("request {request:?}");
                    }
                    if let Some(refused) = handled.refused {
                        println!("refused {}: {refused}", handled.kind);
                    }
                }
                Ok(None) => break Ok(()),
                Err(broken) => break Err(broken),
            }
        };
        let left = rest.len();
        self.bytes.drain(..self.bytes.len() - left);
        self.reply(robot)?;
        outcome?;
        Ok(false)
    }

    fn reply(&mut self, robot: &mut Robot<String>) -> Outcome<()> {
        let mut room = [0; 4096];
        loop {
            match robot.replies(&mut room) {
                0 => return Ok(()),
                count => self.tcp.write_all(&room[..count])?,
            }
        }
    }

    fn take_commands(&mut self, robot: &mut Robot<String>) -> Outcome<()> {
        let mut room = [0; command::LEN_MAX + 1];
        while let Some((count, from)) = arrived(self.udp.recv_from(&mut room))? {
            if from.ip() != self.client {
                continue;
            }
            if self.loses() {
                self.lost = true;
                continue;
            }
            let datagram = &room[..count];
            match robot.command(datagram) {
                Received::Last => {
                    if let Ok(command) = Command::parse(robot.version(), datagram) {
                        println!("last {command:?}");
                    }
                }
                Received::Unreadable(error) => println!("command: {error}"),
                _ => {}
            }
        }
        Ok(())
    }

    /// The next state, if somebody is there for it.
    fn cycle(&mut self, robot: &mut Robot<String>, shown: &Shown) -> Outcome<()> {
        let Some(connect) = robot.client() else {
            return Ok(());
        };
        robot.advance();
        let mut state = *robot.state(&shown.arm(), &Operator::ABSENT);
        if state.robot_mode == RobotMode::Idle {
            shown.show(&mut state);
        }
        let mut room = [0; state::LEN_MAX];
        let datagram = state.emit(robot.version(), &mut room)?;
        self.lost = self.loses();
        if !self.lost {
            self.udp
                .send_to(datagram, (self.client, connect.udp_port))?;
        }
        tell_end(robot);
        self.reply(robot)
    }
}
