//! The client at the other end of a serial line.

use std::io::{self, ErrorKind};
use std::path::Path;
use std::time::{Duration, Instant};

use bridge::framing::{self, DATAGRAM_MAX, Deframer, Fed};
use serial2::SerialPort;

use super::transport::{Arrival, POLL, Transport, silence};
use cell::invalid::Invalid;

/// Bits per second; a pseudo terminal does not care.
pub const BAUD: u32 = 4_000_000;

/// A serial line with one client, datagrams in frames.
pub struct Serial {
    port: SerialPort,
    deframer: Deframer,
    /// Bytes that have come and are not looked at yet.
    waiting: [u8; 4096],
    from: usize,
    to: usize,
    datagram: [u8; DATAGRAM_MAX],
    damaged: u64,
}

impl Serial {
    /// The line at `path`, a device or a pseudo terminal.
    ///
    /// # Errors
    /// It cannot be opened, or is no line.
    pub fn open(path: &Path) -> Result<Self, Invalid> {
        let port = SerialPort::open(path, BAUD).map_err(|error| {
            let allowed = format!("a serial device or pseudo terminal ({error})");
            Invalid::new("--serial", path.display(), allowed)
        })?;
        Ok(Self::on(port))
    }

    /// A line that is open.
    #[must_use]
    pub fn on(port: SerialPort) -> Self {
        Self {
            port,
            deframer: Deframer::new(),
            waiting: [0; 4096],
            from: 0,
            to: 0,
            datagram: [0; DATAGRAM_MAX],
            damaged: 0,
        }
    }

    /// Frames that were damaged.
    #[must_use]
    pub fn damaged(&self) -> u64 {
        self.damaged
    }

    /// The length of the next datagram among the bytes that have come.
    fn next(&mut self) -> Option<usize> {
        while let Some(&byte) = self.waiting.get(self.from).filter(|_| self.from < self.to) {
            self.from += 1;
            match self.deframer.feed(byte) {
                Fed::Datagram(length) => {
                    let place = self.datagram.get_mut(..length)?;
                    place.copy_from_slice(self.deframer.datagram(length));
                    return Some(length);
                }
                Fed::Damaged => self.damaged += 1,
                Fed::More => {}
            }
        }
        None
    }

    /// Reads until a datagram is there or `deadline` has passed, each time for
    /// `timeout` at most.
    fn read(&mut self, deadline: Instant, timeout: Duration) -> io::Result<Option<&[u8]>> {
        self.port.set_read_timeout(timeout)?;
        loop {
            if let Some(length) = self.next() {
                return Ok(self.datagram.get(..length));
            }
            match self.port.read(&mut self.waiting) {
                Ok(count) => (self.from, self.to) = (0, count),
                Err(error) if silence(&error) => (),
                Err(error) => return Err(error),
            }
            if self.from == self.to && Instant::now() >= deadline {
                return Ok(None);
            }
        }
    }
}

impl Transport for Serial {
    fn send(&mut self, datagram: &[u8]) -> io::Result<()> {
        let framed = framing::encode(datagram);
        let (frame, length) = framed.ok_or_else(|| io::Error::from(ErrorKind::InvalidInput))?;
        match self.port.write_all(frame.get(..length).unwrap_or(&[])) {
            // A line that takes nothing: nobody reads at the other end.
            Err(error) if silence(&error) => Ok(()),
            done => done,
        }
    }

    fn receive(&mut self, deadline: Instant) -> io::Result<Option<&[u8]>> {
        self.read(deadline, Duration::from_millis(1))
    }

    fn receive_on_time(&mut self, deadline: Instant) -> io::Result<Option<Arrival<'_>>> {
        let read = self.read(deadline, POLL)?;
        // A line has no times: its bytes arrive when they are read.
        Ok(read.map(|datagram| Arrival {
            datagram,
            waited: Duration::ZERO,
        }))
    }
}
