//! Datagrams on a byte stream: each with a CRC-32, in COBS, ended by a zero byte.
//!
//! A frame is COBS(datagram, CRC-32/ISO-HDLC of it in little endian), then 0. COBS
//! leaves no zero inside, so a receiver that has lost its place finds the next
//! frame after the next zero; the CRC stands in for the checksum of UDP.

use cobs::{CobsDecoder, DecodeError};
use crc::{CRC_32_ISO_HDLC, Crc};

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Bytes of the CRC.
const CRC_LEN: usize = 4;

/// Longest datagram that is framed; a measurement has 916 bytes.
pub const DATAGRAM_MAX: usize = 1024;

/// Room for any frame: a byte for every 254 begun, and the zero.
pub const FRAME_MAX: usize = DATAGRAM_MAX + CRC_LEN + 5 + 1;

/// The frame of a datagram, and its length; none if it is longer than
/// [`DATAGRAM_MAX`].
#[must_use]
pub fn encode(datagram: &[u8]) -> Option<([u8; FRAME_MAX], usize)> {
    let mut payload = [0; DATAGRAM_MAX + CRC_LEN];
    payload
        .get_mut(..datagram.len())
        .filter(|_| datagram.len() <= DATAGRAM_MAX)?
        .copy_from_slice(datagram);
    let end = datagram.len() + CRC_LEN;
    let checksum = CRC.checksum(datagram).to_le_bytes();
    payload
        .get_mut(datagram.len()..end)?
        .copy_from_slice(&checksum);
    let mut frame = [0; FRAME_MAX];
    let length = cobs::try_encode(payload.get(..end)?, &mut frame).ok()?;
    // The byte behind it is the zero that ends it.
    Some((frame, length + 1))
}

/// What a byte brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fed {
    /// Nothing yet.
    More,
    /// A datagram of this length.
    Datagram(usize),
    /// The end of something that is no frame: damaged, or begun in the middle.
    Damaged,
}

/// Finds frames in a stream, byte by byte.
#[derive(Debug)]
pub struct Deframer {
    bytes: [u8; DATAGRAM_MAX + CRC_LEN + 8],
    encoded: [u8; FRAME_MAX],
    length: usize,
    overflow: bool,
}

impl Deframer {
    /// At the start of a stream.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            bytes: [0; DATAGRAM_MAX + CRC_LEN + 8],
            encoded: [0; FRAME_MAX],
            length: 0,
            overflow: false,
        }
    }

    /// Takes a byte.
    pub fn feed(&mut self, byte: u8) -> Fed {
        if byte != 0 {
            match self.encoded.get_mut(self.length) {
                Some(place) => {
                    *place = byte;
                    self.length += 1;
                }
                None => self.overflow = true,
            }
            return Fed::More;
        }
        let (length, overflow) = (self.length, self.overflow);
        self.length = 0;
        self.overflow = false;
        match (length, overflow) {
            // Two zeros in a row: an empty frame, which some send to begin with.
            (0, false) => Fed::More,
            (_, true) => Fed::Damaged,
            _ => self.decode(length).map_or(Fed::Damaged, Fed::Datagram),
        }
    }

    fn decode(&mut self, length: usize) -> Option<usize> {
        let encoded = self.encoded.get(..length)?;
        let mut decoder = CobsDecoder::new(&mut self.bytes);
        let pushed: Result<_, DecodeError> = decoder.push(encoded);
        pushed.ok()?;
        let decoded = match decoder.feed(0) {
            Ok(Some(length)) => length,
            _ => return None,
        };
        let end = decoded.checked_sub(CRC_LEN)?;
        let checksum = self.bytes.get(end..decoded)?;
        let expected = CRC.checksum(self.bytes.get(..end)?).to_le_bytes();
        (checksum == expected).then_some(end)
    }

    /// The datagram that the last byte completed.
    #[must_use]
    pub fn datagram(&self, length: usize) -> &[u8] {
        self.bytes.get(..length).unwrap_or(&[])
    }
}

impl Default for Deframer {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn datagram(length: usize, seed: u8) -> Vec<u8> {
        let byte = |i: usize| (i as u8).wrapping_mul(seed).wrapping_add(seed) & !(i as u8 & 3);
        (0..length).map(byte).collect()
    }

    /// Everything that a stream holds.
    fn read(deframer: &mut Deframer, stream: &[u8]) -> (Vec<Vec<u8>>, usize) {
        let (mut found, mut damaged) = (Vec::new(), 0);
        for byte in stream {
            match deframer.feed(*byte) {
                Fed::Datagram(length) => found.push(deframer.datagram(length).to_vec()),
                Fed::Damaged => damaged += 1,
                Fed::More => {}
            }
        }
        (found, damaged)
    }

    #[test]
    fn every_length_comes_back() {
        let mut deframer = Deframer::new();
        for length in (0..=DATAGRAM_MAX)
            .step_by(7)
            .chain([253, 254, 255, 916, 1024])
        {
            for seed in [0, 1, 77, 255] {
                let sent = datagram(length, seed);
                let (frame, end) = encode(&sent).expect("it fits");
                let frame = &frame[..end];
                assert_eq!(frame.iter().position(|&byte| byte == 0), Some(end - 1));
                assert_eq!(read(&mut deframer, frame), (std::vec![sent], 0));
            }
        }
        assert!(encode(&[0; DATAGRAM_MAX + 1]).is_none());
    }

    #[test]
    fn one_changed_byte_never_passes() {
        let sent = datagram(376, 9);
        let (frame, end) = encode(&sent).expect("it fits");
        for at in 0..end {
            for change in [1, 0x80, frame[at]] {
                let mut stream = frame[..end].to_vec();
                stream[at] ^= change;
                stream.push(0);
                let (found, _) = read(&mut Deframer::new(), &stream);
                assert!(found.iter().all(|found| *found == sent) && found.len() <= 1);
                assert!(change == 0 || found.is_empty(), "byte {at}");
            }
        }
    }

    #[test]
    fn a_receiver_finds_its_place_again() {
        let (first, second) = (datagram(376, 3), datagram(916, 5));
        let mut stream = Vec::new();
        stream.extend(std::iter::repeat_n(0x55, 5000));
        stream.push(0);
        for sent in [&first, &second] {
            let (frame, end) = encode(sent).expect("it fits");
            stream.extend(&frame[..end]);
        }
        // Begun in the middle of a frame.
        let (frame, end) = encode(&first).expect("it fits");
        let mut late = frame[100..end].to_vec();
        late.extend(&stream);
        let (found, damaged) = read(&mut Deframer::new(), &late);
        assert_eq!((found, damaged), (std::vec![first, second], 2));
    }
}
