//! The client at the other end of a datagram socket.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use super::transport::{NOTHING, POLL, Transport, silence};
use cell::invalid::Invalid;

/// More than any datagram of the protocol.
const BUFFER: usize = 2048;

/// A socket that is connected to one client: the system passes datagrams of
/// nobody else.
pub struct Udp {
    socket: UdpSocket,
    buffer: [u8; BUFFER],
}

impl Udp {
    /// A socket at `local_port` (0: any) for the client at `remote`.
    ///
    /// # Errors
    /// The port is taken, or the address cannot be reached.
    pub fn open(remote: SocketAddr, local_port: u16) -> Result<Self, Invalid> {
        let local: SocketAddr = match remote {
            SocketAddr::V4(to) if to.ip().is_loopback() => (Ipv4Addr::LOCALHOST, local_port).into(),
            SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, local_port).into(),
            SocketAddr::V6(to) if to.ip().is_loopback() => (Ipv6Addr::LOCALHOST, local_port).into(),
            SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, local_port).into(),
        };
        let socket = UdpSocket::bind(local).map_err(|error| {
            let allowed = format!("a free port of this PC ({error})");
            Invalid::new("--local-port", local_port, allowed)
        })?;
        socket.connect(remote).map_err(|error| {
            let allowed = format!("an address that can be reached ({error})");
            Invalid::new("--remote", remote, allowed)
        })?;
        Ok(Self {
            socket,
            buffer: [0; BUFFER],
        })
    }
}

impl Transport for Udp {
    fn send(&mut self, datagram: &[u8]) -> io::Result<()> {
        match self.socket.send(datagram) {
            Err(error) if !nobody(&error) => Err(error),
            _ => Ok(()),
        }
    }

    fn receive_on_time(&mut self, deadline: Instant) -> io::Result<Option<&[u8]>> {
        self.socket.set_nonblocking(true)?;
        let received = loop {
            match self.socket.recv(&mut self.buffer) {
                Ok(length) => break Ok(Some(length)),
                Err(error) if nobody(&error) || silence(&error) => (),
                Err(error) => break Err(error),
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break Ok(None);
            }
            std::thread::sleep(left.min(POLL));
        };
        self.socket.set_nonblocking(false)?;
        let buffer = &self.buffer;
        received.map(|length| length.map(|length| &buffer[..length]))
    }

    fn receive(&mut self, deadline: Instant) -> io::Result<Option<&[u8]>> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            // A timeout of zero would mean none.
            let timeout = left.max(Duration::from_micros(1));
            self.socket.set_read_timeout(Some(timeout))?;
            match self.socket.recv(&mut self.buffer) {
                Ok(length) => return Ok(Some(&self.buffer[..length])),
                // The port is closed: there is nobody yet, or no more.
                Err(error) if nobody(&error) => std::thread::sleep(left.min(NOTHING)),
                Err(error) if silence(&error) => (),
                Err(error) => return Err(error),
            }
            if Instant::now() >= deadline {
                return Ok(None);
            }
        }
    }
}

fn nobody(error: &io::Error) -> bool {
    error.kind() == ErrorKind::ConnectionRefused
}
