//! A robot without a plant: the robot's end of the interface, for clients of others.
//!
//! ```sh
//! cargo run --release -p fci --example robot -- ADDRESS VERSION CLIENTS
//! ```
//!
//! It serves so many clients one after the other and ends. All numbers of its state differ,
//! and while no motion runs its errors, reflex reasons and modes show one after the other. Standard output
//! has them, the requests as they were understood, and the motions. In a motion it waits
//! for the answer to each state behind the first one that is answered, 0.5 s at most; 20 in a row that do not come, or a torque that jumps by
//! more than 1 Nm, end it by a reflex.

mod robot;
mod urdf;

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

use fci::stream::REQUEST_LEN_MAX;
use fci::{Connect, Request, Stream, Version, command, state};
use robot::Robot;

const CYCLE: Duration = Duration::from_millis(1);
/// How long an answer is waited for: clients give up after 1 s without a state.
const PATIENCE: Duration = Duration::from_millis(500);
/// How often sockets are looked at.
const POLL: Duration = Duration::from_micros(50);

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn arguments() -> Outcome<(SocketAddr, Version, usize)> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [address, version, clients] = &given[..] else {
        return Err(format!("arguments: {given:?}; allowed: ADDRESS VERSION CLIENTS").into());
    };
    let version = Version::from_number(version.parse()?)?;
    Ok((address.parse()?, version, clients.parse()?))
}

fn main() -> ExitCode {
    match arguments().and_then(|(address, version, clients)| serve(address, version, clients)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn serve(address: SocketAddr, version: Version, clients: usize) -> Outcome<()> {
    let listener = TcpListener::bind(address)?;
    let mut robot = Robot::new(version);
    println!("listening {address} version {}", version.number());
    robot.print_fields();
    for _ in 0..clients {
        let (tcp, client) = listener.accept()?;
        println!("client");
        let outcome = Connection::new(tcp, client, address)?.run(&mut robot);
        robot.leave();
        match outcome {
            Ok(()) => println!("closed"),
            Err(error) => println!("closed: {error}"),
        }
    }
    Ok(())
}

/// The sockets of one client.
struct Connection {
    tcp: TcpStream,
    udp: UdpSocket,
    client: SocketAddr,
    /// Whether a client of the same version has said Connect: states go out.
    connected: bool,
}

/// What a socket that is asked and does not wait has.
fn arrived(received: io::Result<usize>) -> io::Result<Option<usize>> {
    match received {
        Ok(count) => Ok(Some(count)),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
        Err(error) => Err(error),
    }
}

impl Connection {
    fn new(tcp: TcpStream, client: SocketAddr, own: SocketAddr) -> io::Result<Self> {
        let udp = UdpSocket::bind((own.ip(), 0))?;
        tcp.set_nonblocking(true)?;
        tcp.set_nodelay(true)?;
        udp.set_nonblocking(true)?;
        Ok(Self {
            tcp,
            udp,
            client,
            connected: false,
        })
    }

    /// Until the client closes.
    fn run(&mut self, robot: &mut Robot) -> Outcome<()> {
        let mut stream = Stream::new([0; REQUEST_LEN_MAX], REQUEST_LEN_MAX)?;
        let mut last = Instant::now();
        loop {
            let mut bytes = [0; 512];
            match arrived(self.tcp.read(&mut bytes))? {
                Some(0) => return Ok(()),
                Some(count) => {
                    let mut rest = &bytes[..count];
                    while let Some(message) = stream.next(&mut rest)? {
                        let request = Request::parse(robot.version(), &message)?;
                        println!("request {request:?}");
                        robot.request(message.id, &request);
                        if let Request::Connect(Connect { version, udp_port }) = request {
                            self.client.set_port(udp_port);
                            self.connected = version == robot.version().number();
                        }
                    }
                }
                None => {}
            }
            let mut bytes = [0; command::LEN_MAX + 1];
            while let Some(count) = arrived(self.udp.recv(&mut bytes))? {
                robot.command(&bytes[..count]);
            }
            for reply in robot.replies() {
                self.tcp.write_all(&reply)?;
            }
            let elapsed = last.elapsed();
            if self.connected && elapsed >= CYCLE && (!robot.waits() || elapsed >= PATIENCE) {
                last = Instant::now();
                let mut bytes = [0; state::LEN_MAX];
                let datagram = robot.state(&mut bytes)?;
                self.udp.send_to(datagram, self.client)?;
                for reply in robot.replies() {
                    self.tcp.write_all(&reply)?;
                }
            }
            sleep(POLL);
        }
    }
}
