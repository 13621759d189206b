//! The client at the other end of a datagram socket.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use super::stamped::Stamped;
use super::transport::{Arrival, NOTHING, POLL, Transport, silence};
use crate::robot::Stamp;
use cell::invalid::Invalid;

/// More than any datagram of the protocol.
const BUFFER: usize = 2048;

/// A socket that is connected to one client: the system passes datagrams of
/// nobody else.
pub struct Udp {
    socket: UdpSocket,
    stamped: Stamped,
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
            stamped: Stamped::on(&socket),
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

    fn receive_on_time(&mut self, deadline: Instant) -> io::Result<Option<Arrival<'_>>> {
        loop {
            match self.stamped.receive(&self.socket, &mut self.buffer) {
                Ok((length, waited)) => {
                    let datagram = self.buffer.get(..length).unwrap_or(&self.buffer);
                    return Ok(Some(Arrival { datagram, waited }));
                }
                Err(error) if nobody(&error) || silence(&error) => (),
                Err(error) => return Err(error),
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            std::thread::sleep(left.min(POLL));
        }
    }

    fn stamp(&self) -> Stamp {
        self.stamped.stamp()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What a datagram waited is counted from its arrival on, however late it is read.
    #[cfg(target_os = "linux")]
    #[test]
    fn the_kernel_says_when_a_datagram_came() {
        let client = UdpSocket::bind("127.0.0.1:0").expect("a port");
        let at = client.local_addr().expect("an address");
        let mut robot = Udp::open(at, 0).expect("loopback");
        assert_eq!(robot.stamp(), Stamp::Kernel);
        let to = robot.socket.local_addr().expect("an address");
        // The kernel begins to stamp a moment after it was asked to; until then a datagram
        // has the time at which it is read.
        let stamps = (0..1000).any(|_| {
            client.send_to(&[7; 376], to).expect("sent");
            std::thread::sleep(Duration::from_millis(2));
            let arrival = robot.receive_on_time(Instant::now()).expect("a socket");
            arrival.is_some_and(|arrival| arrival.waited >= Duration::from_millis(1))
        });
        assert!(stamps, "2 s without one");
        for asleep in [Duration::from_millis(30), Duration::from_millis(2)] {
            let before = Instant::now();
            client.send_to(&[7; 376], to).expect("sent");
            let after = Instant::now();
            std::thread::sleep(asleep);
            let arrival = robot.receive_on_time(Instant::now()).expect("a socket");
            let Arrival { datagram, waited } = arrival.expect("it has come");
            assert_eq!(datagram, [7; 376]);
            // It came between the two looks at the clock, and was read by now.
            assert!(waited <= before.elapsed() && waited >= asleep, "{waited:?}");
            assert!(waited + (after - before) >= asleep);
        }
        assert!(
            robot
                .receive_on_time(Instant::now())
                .expect("a socket")
                .is_none()
        );
    }
}
