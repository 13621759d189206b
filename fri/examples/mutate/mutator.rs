//! Datagrams damaged at random, and what the codec must make of them.
//!
//! Everything follows from the seed. Each datagram begins as a valid one and is
//! damaged one to three times; then both readers get it. What they must answer is
//! decided here, from offsets written down again, without the codec.

#[path = "../../tests/data/mod.rs"]
mod data;

use std::ops::Range;

use fri::{Command, CommandPacket, Error, Measurement, MeasurementPacket};
use hostile::{Cases, Random, Table};

/// Room for what is longer than both.
const ROOM: usize = 1024;

/// The layout of a kind of datagram, as far as a check goes.
struct Kind {
    name: &'static str,
    valid: Vec<u8>,
    id: u16,
    reals: &'static [Range<usize>],
    /// Offset and largest value with a meaning; 65535 is invalid, a meaning as well.
    codes: &'static [(usize, u16)],
    read: fn(&[u8], &mut [u8; ROOM]) -> Result<usize, Error>,
}

fn kinds() -> [Kind; 2] {
    [
        Kind {
            name: "measurement",
            valid: data::measurement().to_vec(),
            id: 0x2006,
            reals: &[8..72, 140..144, 148..176, 188..916],
            codes: &[(144, 2), (146, 3), (182, 3)],
            read: |bytes, out| {
                let value = Measurement::parse(&MeasurementPacket::new_checked(bytes)?);
                value.emit(out.first_chunk_mut().expect("room"));
                Ok(Measurement::LEN)
            },
        },
        Kind {
            name: "command",
            valid: data::command().to_vec(),
            id: 0x1005,
            reals: &[8..72, 144..376],
            codes: &[],
            read: |bytes, out| {
                let value = Command::parse(&CommandPacket::new_checked(bytes)?);
                value.emit(out.first_chunk_mut().expect("room"));
                Ok(Command::LEN)
            },
        },
    ]
}

/// What a reader says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Accepted,
    Length,
    Id,
    Size,
    Code,
    NotFinite,
}

/// In their order.
const OUTCOMES: [&str; 6] = ["accepted", "length", "id", "size", "code", "not finite"];

const DAMAGES: [&str; 6] = ["bits", "bytes", "length", "other kind", "real", "integer"];

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

impl Kind {
    /// What the reader must say.
    fn expected(&self, bytes: &[u8]) -> Outcome {
        let meaningless = |&(at, max): &(usize, u16)| {
            let code = u16_at(bytes, at);
            code > max && code != 0xFFFF
        };
        // All ones in the exponent, the upper seven bits of byte 3 and one of byte 2.
        let finite = |word: &[u8; 4]| word[3] & 0x7F != 0x7F || word[2] & 0x80 == 0;
        let all_finite = |range: &Range<usize>| {
            let (words, _) = bytes[range.clone()].as_chunks();
            words.iter().all(finite)
        };
        if bytes.len() != self.valid.len() {
            Outcome::Length
        } else if u16_at(bytes, 6) != self.id {
            Outcome::Id
        } else if usize::from(u16_at(bytes, 4)) != bytes.len() {
            Outcome::Size
        } else if self.codes.iter().any(meaningless) {
            Outcome::Code
        } else if !self.reals.iter().all(all_finite) {
            Outcome::NotFinite
        } else {
            Outcome::Accepted
        }
    }

    /// What it says, and that what it accepts comes back.
    fn outcome(&self, bytes: &[u8]) -> Result<Outcome, String> {
        let mut again = [0xAA; ROOM];
        let read = (self.read)(bytes, &mut again);
        Ok(match read {
            Ok(length) => {
                let same = again[..length].iter().zip(bytes).enumerate();
                let fill = 138..140;
                for (at, (&sent, &came)) in same {
                    let wanted = if fill.contains(&at) { 0 } else { came };
                    if sent != wanted {
                        return Err(format!("byte {at}: {sent:#04x}; expected: {wanted:#04x}"));
                    }
                }
                Outcome::Accepted
            }
            Err(Error::Length { .. }) => Outcome::Length,
            Err(Error::Id { .. }) => Outcome::Id,
            Err(Error::Size { .. }) => Outcome::Size,
            Err(Error::Code { .. }) => Outcome::Code,
            Err(Error::NotFinite { .. }) => Outcome::NotFinite,
            Err(other) => return Err(format!("unknown error: {other}")),
        })
    }
}

/// A datagram that is being damaged.
struct Datagram {
    bytes: [u8; ROOM],
    length: usize,
}

impl Datagram {
    fn put(&mut self, at: usize, value: &[u8]) {
        let place = self.bytes[..self.length].get_mut(at..at + value.len());
        if let Some(place) = place {
            place.copy_from_slice(value);
        }
    }

    /// Which damage it was.
    fn damage(&mut self, own: &Kind, other: &Kind, random: &mut Random) -> usize {
        let damage = random.pick(&[0, 0, 1, 2, 3, 4, 5, 5]);
        match damage {
            0 => random.flip(&mut self.bytes[..self.length]),
            1 => random.set(&mut self.bytes[..self.length]),
            // Cut off, or longer by what was in the buffer.
            2 => {
                let any = random.length(self.length, ROOM);
                self.length = random.pick(&[any, any, own.valid.len(), other.valid.len()]);
            }
            // The other kind from some offset on, or up to it.
            3 => {
                let any = random.below(other.valid.len());
                let cut = random.pick(&[4, 6, 8, 140, any]);
                if random.below(2) == 0 {
                    self.bytes[cut..other.valid.len()].copy_from_slice(&other.valid[cut..]);
                    self.length = random.pick(&[self.length, other.valid.len()]);
                } else {
                    self.bytes[..cut].copy_from_slice(&other.valid[..cut]);
                }
            }
            4 => {
                let range = random.below(4).min(own.reals.len() - 1);
                let Range { start, end } = own.reals[range];
                let at = start + 4 * random.below((end - start) / 4);
                let extremes = [
                    f32::NAN.to_bits(),
                    0x7F80_0001, // signalling
                    f32::INFINITY.to_bits(),
                    f32::NEG_INFINITY.to_bits(),
                    f32::MAX.to_bits(),
                    f32::MIN.to_bits(),
                    f32::MIN_POSITIVE.to_bits(),
                    1, // the smallest
                    (-0.0f32).to_bits(),
                    random.bits(),
                ];
                self.put(at, &random.pick(&extremes).to_le_bytes());
            }
            // Of 16 bits: counters, size, id, fill, codes and their neighbours.
            _ => {
                let fields = [0, 2, 4, 6, 136, 138, 140, 144, 146, 178, 180, 182, 184];
                let at = random.pick(&fields);
                let any = random.bits() as u16;
                let extremes = [0, 1, 2, 3, 4, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF, any];
                let lengths = [375, 376, 377, 915, 916, 917, 0x1005, 0x2006];
                let value = match random.below(3) {
                    0 => random.pick(&lengths),
                    _ => random.pick(&extremes),
                };
                self.put(at, &value.to_le_bytes());
            }
        }
        damage
    }
}

/// Both readers, and what they have said.
pub struct Datagrams {
    kinds: [Kind; 2],
    datagram: Datagram,
    damages: Table,
    outcomes: Table,
}

impl Datagrams {
    pub fn new() -> Self {
        let kinds = kinds();
        let damages = Table::new("damage", &DAMAGES);
        let outcomes = Table::new("read as", &OUTCOMES);
        Self {
            damages: damages.with(kinds[0].name, &[]).with(kinds[1].name, &[]),
            // A command has no codes.
            outcomes: (outcomes.with(kinds[0].name, &[]))
                .with(kinds[1].name, &[Outcome::Code as usize]),
            kinds,
            datagram: Datagram {
                bytes: [0; ROOM],
                length: 0,
            },
        }
    }
}

impl Cases for Datagrams {
    /// A datagram to both readers.
    fn case(&mut self, random: &mut Random) -> Result<(), String> {
        let i = random.below(2);
        let (own, other) = (&self.kinds[i], &self.kinds[1 - i]);
        let datagram = &mut self.datagram;
        datagram.bytes = [0; ROOM];
        datagram.length = own.valid.len();
        datagram.bytes[..own.valid.len()].copy_from_slice(&own.valid);
        for _ in 0..=random.below(3) {
            let damage = datagram.damage(own, other, random);
            self.damages.count(damage, i);
        }
        let bytes = &datagram.bytes[..datagram.length];
        for (column, kind) in self.kinds.iter().enumerate() {
            let expected = kind.expected(bytes);
            let outcome = kind.outcome(bytes);
            let outcome = outcome.map_err(|why| format!("{}: {why}", kind.name))?;
            if outcome != expected {
                let name = kind.name;
                return Err(format!("{name}: {outcome:?}; expected: {expected:?}"));
            }
            self.outcomes.count(outcome as usize, column);
        }
        Ok(())
    }

    fn bytes(&self) -> &[u8] {
        &self.datagram.bytes[..self.datagram.length]
    }

    fn tables(self) -> Vec<Table> {
        vec![self.damages, self.outcomes]
    }
}
