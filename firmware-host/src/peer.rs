//! Whom the loop answers: one address. Where none is named it is the first that sends
//! measurements in a row, so that a stray datagram does not take the session.

use std::fmt;
use std::net::SocketAddr;

use fri::MeasurementPacket;

/// Measurements with consecutive counters that make an address the robot's.
pub const IN_A_ROW: u8 = 3;

/// Addresses that are watched at a time.
const WATCHED: usize = 8;

/// Why a datagram does not go to the session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// It is not from the robot.
    Stranger(SocketAddr),
    /// It is not a measurement that can be used.
    Unusable(fri::Error),
    /// No robot is known, and it is not yet the third in a row.
    Unproven,
    /// No arm can be where it says.
    Doubted,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stranger(robot) => write!(f, "the robot is {robot}"),
            Self::Unusable(error) => write!(f, "{error}"),
            Self::Unproven => write!(
                f,
                "measurements with {IN_A_ROW} counters in a row are needed"
            ),
            Self::Doubted => write!(f, "a position too far from the last"),
        }
    }
}

/// The robot's address, and those that may be it.
#[derive(Clone, Debug)]
pub struct Peer {
    named: bool,
    robot: Option<SocketAddr>,
    /// Address, newest counter, how many in a row; the one heard last at the end.
    watched: Vec<(SocketAddr, u16, u8)>,
}

impl Peer {
    /// The address that is `named`; or else the first that proves to be a robot's.
    #[must_use]
    pub fn new(named: Option<SocketAddr>) -> Self {
        Self {
            named: named.is_some(),
            robot: named,
            // The loop does not allocate.
            watched: Vec::with_capacity(WATCHED + 1),
        }
    }

    /// Whether `datagram` from `from` goes to the session.
    ///
    /// # Errors
    /// Why not.
    pub fn admit(&mut self, from: SocketAddr, datagram: &[u8]) -> Result<(), Refusal> {
        match self.robot {
            Some(robot) if robot == from => return Ok(()),
            Some(robot) => return Err(Refusal::Stranger(robot)),
            None => {}
        }
        let packet = MeasurementPacket::new_checked(datagram).map_err(Refusal::Unusable)?;
        let counter = packet.header().counter;
        let known = self
            .watched
            .iter()
            .position(|(address, ..)| *address == from);
        let before = known.map(|index| self.watched.remove(index));
        let row = match before {
            Some((_, last, row)) if counter == last.wrapping_add(1) => row + 1,
            _ => 1,
        };
        if row >= IN_A_ROW {
            self.robot = Some(from);
            self.watched.clear();
            return Ok(());
        }
        self.watched.push((from, counter, row));
        if self.watched.len() > WATCHED {
            self.watched.remove(0);
        }
        Err(Refusal::Unproven)
    }

    /// The robot fell silent: another one may come, unless it was named. Whether that is
    /// new.
    pub fn release(&mut self) -> bool {
        !self.named && self.robot.take().is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fri::Measurement;

    fn address(port: u16) -> SocketAddr {
        ([127, 0, 0, 1], port).into()
    }

    fn measurement(counter: u16) -> [u8; Measurement::LEN] {
        let mut measurement = Measurement::default();
        measurement.header.counter = counter;
        let mut bytes = [0; Measurement::LEN];
        measurement.emit(&mut bytes);
        bytes
    }

    #[test]
    fn three_in_a_row_from_one_address_make_a_robot_and_silence_frees_it() {
        let mut peer = Peer::new(None);
        let mut from = |port, counter| peer.admit(address(port), &measurement(counter));
        for (port, counter) in [(1, 65_534), (2, 7), (1, 65_535), (2, 7), (2, 9)] {
            assert_eq!(from(port, counter), Err(Refusal::Unproven));
        }
        assert_eq!(from(1, 0), Ok(()));
        assert_eq!(from(2, 10), Err(Refusal::Stranger(address(1))));
        assert_eq!(from(1, 5), Ok(()), "gaps are the session's affair");
        assert!(peer.release() && !peer.release());
        for counter in [1, 2] {
            let refused = peer.admit(address(2), &measurement(counter));
            assert_eq!(refused, Err(Refusal::Unproven));
        }
        assert_eq!(peer.admit(address(2), &measurement(3)), Ok(()));
    }

    #[test]
    fn other_datagrams_and_many_addresses_prove_nothing() {
        let mut peer = Peer::new(None);
        let refused = peer.admit(address(1), b"hello");
        assert!(matches!(refused, Err(Refusal::Unusable(_))));
        for counter in 1..=2 {
            for port in 1..1000 {
                let refused = peer.admit(address(port), &measurement(counter));
                assert_eq!(refused, Err(Refusal::Unproven));
            }
        }
        assert!(peer.watched.len() <= WATCHED);
    }

    #[test]
    fn a_named_robot_needs_no_proof_and_stays() {
        let mut peer = Peer::new(Some(address(1)));
        assert!(!peer.release());
        assert_eq!(peer.admit(address(1), b"hello"), Ok(()));
        let other = peer.admit(address(2), &measurement(1));
        assert_eq!(other, Err(Refusal::Stranger(address(1))));
    }
}
