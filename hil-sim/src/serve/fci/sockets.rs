//! The sockets of the FCI: one client at a time.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::time::Duration;

use fci::command;
use fci::stream::REQUEST_LEN_MAX;

use crate::robot::{ControlBox as _, FciBox, FciRobot};
use cell::invalid::Invalid;

/// The longest that a command is waited for before the stream is looked at again.
const LOOK: Duration = Duration::from_micros(500);

/// How long a client may leave replies unread.
const UNREAD: Duration = Duration::from_secs(1);

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

    /// Whether somebody is connected.
    pub fn is_open(&self) -> bool {
        self.client.is_some()
    }

    /// Lets a client in, takes its requests, sends the replies. A second client is turned away.
    pub fn talk(&mut self, robot: &mut FciRobot) -> io::Result<()> {
        if let Some((stream, address)) = arrived(self.listener.accept())?
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
        }
        let Some(client) = &mut self.client else {
            return Ok(());
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
        Ok(())
    }

    /// The next state as a datagram.
    pub fn emit(&mut self, robot: &mut FciRobot) -> io::Result<Vec<u8>> {
        let mut state = FciBox::EMPTY;
        robot.measurement(&mut state);
        let datagram = state.as_ref().to_vec();
        // A reflex has a reply.
        self.talk(robot)?;
        Ok(datagram)
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

    /// The end: what is due still goes out.
    pub fn farewell(&mut self, robot: &mut FciRobot) -> io::Result<()> {
        self.talk(robot)?;
        // The client reads until a state shows the end of the motion.
        for _ in 0..3 {
            let state = self.emit(robot)?;
            self.send(robot, &state)?;
        }
        Ok(())
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
        let broken = loop {
            match robot.control().receive(&mut rest) {
                Ok(Some(handled)) => robot.note(&handled),
                Ok(None) => break None,
                Err(broken) => break Some(broken),
            }
        };
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
        match broken {
            Some(broken) => Err(broken.to_string()),
            None => Ok(true),
        }
    }
}
