//! Datagrams damaged at random, and what the codec must make of them.
//!
//! Everything follows from the seed. Each datagram begins as a valid one and is
//! damaged one to three times; then both readers get it. What they must answer is
//! decided here, from offsets written down again, without the codec.

#[path = "../../tests/data/mod.rs"]
mod data;

use std::fmt;
use std::ops::Range;
use std::panic::catch_unwind;

use fri::{Command, CommandPacket, Error, Measurement, MeasurementPacket};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// Room for what is longer than both.
const ROOM: usize = 1024;

struct Random(ChaCha8Rng);

impl Random {
    /// 0 to n - 1.
    fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.0.next_u32()) * n as u64) >> 32) as usize
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}

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

const OUTCOMES: [(Outcome, &str); 6] = [
    (Outcome::Accepted, "accepted"),
    (Outcome::Length, "length"),
    (Outcome::Id, "id"),
    (Outcome::Size, "size"),
    (Outcome::Code, "code"),
    (Outcome::NotFinite, "not finite"),
];

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
        let read = catch_unwind(move || {
            let read = (self.read)(bytes, &mut again);
            (read, again)
        });
        let (read, again) = read.map_err(|_| "panic".to_string())?;
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

    fn damage(&mut self, own: &Kind, other: &Kind, random: &mut Random) {
        match random.below(8) {
            // Bits.
            0 | 1 if self.length > 0 => {
                for _ in 0..=random.below(8) {
                    let bit = random.below(8 * self.length);
                    self.bytes[bit / 8] ^= 1 << (bit % 8);
                }
            }
            // Bytes.
            2 if self.length > 0 => {
                for _ in 0..=random.below(4) {
                    let at = random.below(self.length);
                    let any = random.0.next_u32() as u8;
                    self.bytes[at] = random.pick(&[0x00, 0x01, 0x7F, 0x80, 0xFF, any]);
                }
            }
            // Cut off, or longer by what was in the buffer.
            3 => {
                let near = (self.length + random.below(9)).saturating_sub(4);
                let any = random.below(ROOM + 1);
                let length = random.pick(&[near, any, own.valid.len(), other.valid.len()]);
                self.length = length.min(ROOM);
            }
            // The other kind from some offset on, or up to it.
            4 => {
                let any = random.below(other.valid.len());
                let cut = random.pick(&[4, 6, 8, 140, any]);
                if random.below(2) == 0 {
                    self.bytes[cut..other.valid.len()].copy_from_slice(&other.valid[cut..]);
                    self.length = random.pick(&[self.length, other.valid.len()]);
                } else {
                    self.bytes[..cut].copy_from_slice(&other.valid[..cut]);
                }
            }
            // A real.
            5 => {
                let range = random.pick(&[0, 1, 2, 3]).min(own.reals.len() - 1);
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
                    random.0.next_u32(),
                ];
                self.put(at, &random.pick(&extremes).to_le_bytes());
            }
            // An integer of 16 bits: counters, size, id, fill, codes and their neighbours.
            _ => {
                let fields = [0, 2, 4, 6, 136, 138, 140, 144, 146, 178, 180, 182, 184];
                let at = random.pick(&fields);
                let any = random.0.next_u32() as u16;
                let extremes = [0, 1, 2, 3, 4, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF, any];
                let lengths = [375, 376, 377, 915, 916, 917, 0x1005, 0x2006];
                let value = match random.below(3) {
                    0 => random.pick(&lengths),
                    _ => random.pick(&extremes),
                };
                self.put(at, &value.to_le_bytes());
            }
        }
    }
}

/// How often each reader said what.
pub struct Table {
    rows: [(&'static str, [u64; OUTCOMES.len()]); 2],
}

impl Table {
    /// The first error that never occurred, of those that can: a command has no codes.
    pub fn missing(&self) -> Option<String> {
        let rows = self.rows.iter().flat_map(|(kind, row)| {
            let cells = OUTCOMES.iter().zip(row);
            cells.map(move |(&(outcome, name), &count)| (*kind, outcome, name, count))
        });
        rows.into_iter()
            .find(|&(kind, outcome, _, count)| {
                let impossible = kind == "command" && outcome == Outcome::Code;
                (count == 0) != impossible
            })
            .map(|(kind, _, name, count)| format!("{kind}, {name}: {count} times"))
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:12}", "read as")?;
        for (_, name) in OUTCOMES {
            write!(f, "{name:>12}")?;
        }
        for (kind, row) in &self.rows {
            write!(f, "\n{kind:12}")?;
            for count in row {
                write!(f, "{count:>12}")?;
            }
        }
        Ok(())
    }
}

/// Gives `count` datagrams to both readers.
///
/// # Errors
/// The first datagram that is not treated as it must be: number, reason, bytes.
pub fn run(count: u64, seed: u64) -> Result<Table, String> {
    let kinds = kinds();
    let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
    let mut rows = [0, 1].map(|i: usize| (kinds[i].name, [0; OUTCOMES.len()]));
    for number in 0..count {
        let i = random.below(2);
        let (own, other) = (&kinds[i], &kinds[1 - i]);
        let mut datagram = Datagram {
            bytes: [0; ROOM],
            length: own.valid.len(),
        };
        datagram.bytes[..own.valid.len()].copy_from_slice(&own.valid);
        for _ in 0..=random.below(3) {
            datagram.damage(own, other, &mut random);
        }
        let bytes = &datagram.bytes[..datagram.length];
        for (kind, (_, row)) in kinds.iter().zip(&mut rows) {
            let expected = kind.expected(bytes);
            let outcome = kind.outcome(bytes).and_then(|outcome| {
                let as_expected = (outcome == expected).then_some(outcome);
                as_expected.ok_or_else(|| format!("{outcome:?}; expected: {expected:?}"))
            });
            row[outcome.map_err(|why| failure(number, kind.name, &why, bytes))? as usize] += 1;
        }
    }
    Ok(Table { rows })
}

fn failure(number: u64, kind: &str, why: &str, bytes: &[u8]) -> String {
    let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("datagram {number} read as {kind}: {why}; bytes: {hex}")
}
