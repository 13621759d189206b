//! The sockets of the FCI: one client at a time.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::thread::sleep;
use std::time::{Duration, Instant};

use fci::command;
use fci::stream::REQUEST_LEN_MAX;

use crate::link::{Expect, Peer};
use crate::robot::{ControlBox as _, FciBox, FciRobot};
use crate::serve::transport::{PATIENCE, POLL};
use cell::invalid::Invalid;

/// The longest that a command is waited for before the stream is looked at again.
const LOOK: Duration = Duration::from_micros(500);

/// How long a client may leave replies unread.
const UNREAD: Duration = Duration::from_secs(1);

/// Cycle of the interface.
pub const CYCLE: Duration = Duration::from_millis(1);

/// How long a damaged state is waited for to be answered.
const PERHAPS: Duration = Duration::from_millis(5);

/// How long the first command of a motion is waited for in lock-step, state by state. Clients read
/// one or two before they answer; one that is kept from running for a while must not find that the
/// state it answers is no more the last.
const BEGINNING: Duration = Duration::from_millis(100);

/// A listener, the socket of the datagrams, and who is connected.
pub struct Sockets {
    listener: TcpListener,
    datagrams: UdpSocket,
    client: Option<Connection>,
    last: Option<SocketAddr>,
}

struct Connection {
    stream: TcpStream,
    address: SocketAddr,
    /// Bytes of the stream that wait for replies to go out.
    bytes: Vec<u8>,
}

/// What a socket that is asked and does not wait has.
fn arrived<T>(received: io::Result<T>) -> io::Result<Option<T>> {
    match received {
        Ok(value) => Ok(Some(value)),
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::WouldBlock
                    | ErrorKind::TimedOut
                    | ErrorKind::Interrupted
                    | ErrorKind::ConnectionRefused
            ) =>
        {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

impl Sockets {
    /// Listens at an address.
    pub fn open(address: SocketAddr) -> Result<Self, Invalid> {
        let wrong = |error: io::Error| {
            let allowed = format!("an address of this PC with a free port ({error})");
            Invalid::new("--address", address, allowed)
        };
        let listener = TcpListener::bind(address).map_err(wrong)?;
        let datagrams = UdpSocket::bind((address.ip(), 0)).map_err(wrong)?;
        listener.set_nonblocking(true).map_err(wrong)?;
        datagrams.set_read_timeout(Some(LOOK)).map_err(wrong)?;
        Ok(Self {
            listener,
            datagrams,
            client: None,
            last: None,
        })
    }

    /// Where it listens.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Who connected last.
    pub fn last(&self) -> Option<SocketAddr> {
        self.last
    }

    /// Lets a client in, takes its requests, sends the replies. A second client is turned away.
    pub fn talk(&mut self, robot: &mut FciRobot) -> io::Result<()> {
        let newcomer = arrived(self.listener.accept())?;
        // One that comes again has closed its connection before: that is seen first.
        self.attend(robot);
        if let Some((stream, address)) = newcomer
            && self.client.is_none()
        {
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            stream.set_write_timeout(Some(UNREAD))?;
            self.last = Some(address);
            self.client = Some(Connection {
                stream,
                address,
                bytes: Vec::new(),
            });
            self.attend(robot);
        }
        Ok(())
    }

    /// The stream of the client that is here.
    fn attend(&mut self, robot: &mut FciRobot) {
        let Some(client) = &mut self.client else {
            return;
        };
        match client.talk(robot) {
            Ok(true) => {}
            Ok(false) => {
                self.client = None;
                robot.disconnect(None);
            }
            Err(why) => {
                self.client = None;
                robot.disconnect(Some(why));
            }
        }
    }

    /// Sends a state to the port that the client has named; that nobody is there is no error.
    pub fn send(&mut self, robot: &mut FciRobot, datagram: &[u8]) -> io::Result<()> {
        let (Some(client), Some(connect)) = (&self.client, robot.control().client()) else {
            return Ok(());
        };
        let to = (client.address.ip(), connect.udp_port);
        arrived(self.datagrams.send_to(datagram, to)).map(|_| ())
    }

    /// A datagram of the client that is here.
    pub fn receive(&mut self) -> io::Result<Option<Vec<u8>>> {
        self.datagrams.set_nonblocking(true)?;
        let received = self.next();
        self.datagrams.set_nonblocking(false)?;
        received
    }

    fn next(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut room = [0; command::LEN_MAX + 1];
        while let Some((count, from)) = arrived(self.datagrams.recv_from(&mut room))? {
            let known = self.client.as_ref();
            if known.is_some_and(|client| client.address.ip() == from.ip()) {
                return Ok(room.get(..count).map(<[u8]>::to_vec));
            }
        }
        Ok(None)
    }

    /// Waits a moment for a datagram, without taking it.
    pub fn wait(&self) -> io::Result<()> {
        arrived(self.datagrams.peek(&mut [0; 8])).map(|_| ())
    }
}

impl Peer<FciBox> for Sockets {
    fn exchange(
        &mut self,
        robot: &mut FciRobot,
        state: &[u8],
        expect: Expect,
        commands: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool> {
        self.send(robot, state)?;
        let begins = robot.control_box().commands();
        let patience = match expect {
            Expect::Answer => PATIENCE,
            Expect::Perhaps => PERHAPS,
            Expect::First if begins => BEGINNING,
            Expect::First => CYCLE,
            Expect::Nothing | Expect::Farewell => return Ok(true),
        };
        let deadline = Instant::now() + patience;
        while Instant::now() < deadline {
            self.talk(robot)?;
            if expect != Expect::First && !robot.is_driven() {
                // The motion has ended: there is no more to come.
                return Ok(true);
            }
            match self.receive()? {
                Some(command) => {
                    let answered = FciBox::answers(state, &command);
                    commands.push(command);
                    if answered {
                        return Ok(true);
                    }
                }
                None if expect == Expect::First => sleep(POLL),
                None => self.wait()?,
            }
        }
        Ok(false)
    }

    fn talk(&mut self, robot: &mut FciRobot) -> io::Result<()> {
        Sockets::talk(self, robot)
    }

    fn has_left(&self) -> bool {
        self.client.is_none()
    }
}

impl Connection {
    /// Whether the client is still there; why it is not to be.
    fn talk(&mut self, robot: &mut FciRobot) -> Result<bool, String> {
        let told = |error: io::Error| error.to_string();
        let mut room = [0; REQUEST_LEN_MAX];
        // What waits for replies comes first.
        if self.bytes.is_empty()
            && let Some(count) = arrived(self.stream.read(&mut room)).map_err(told)?
        {
            if count == 0 {
                return Ok(false);
            }
            self.bytes.extend(&room[..count]);
        }
        let mut rest = &self.bytes[..];
        let heard = robot.hear_requests(&mut rest);
        let left = rest.len();
        self.bytes.drain(..self.bytes.len() - left);
        let mut room = [0; 4096];
        loop {
            let count = robot.control().replies(&mut room);
            if count == 0 {
                break;
            }
            // Whoever reads no replies for a second is gone.
            let sent = self
                .stream
                .set_nonblocking(false)
                .and_then(|()| self.stream.write_all(&room[..count]))
                .and_then(|()| self.stream.set_nonblocking(true));
            sent.map_err(told)?;
        }
        match heard {
            Err(broken) => Err(broken.to_string()),
            Ok(()) => Ok(true),
        }
    }
}
