//! States and commands.

use fci::state::{self, FIELDS, State, StatePacket};
use fci::{Command, Version, command};

use hostile::{Cases, Random, Table};

use super::{OUTCOMES, Outcome, data};

/// Room for what is longer than all.
const ROOM: usize = 2560;

const VERSIONS: [Version; 3] = [Version::V5, Version::V6, Version::V10];

pub const DAMAGES: [&str; 6] = [
    "bits",
    "bytes",
    "length",
    "other kind",
    "real",
    "code or bool",
];

/// The layout of a kind of datagram, as far as a check goes.
pub struct Kind {
    pub version: Version,
    pub valid: Vec<u8>,
    /// Offset and number of reals, one block after the other; bytes of each.
    reals: Vec<(usize, usize)>,
    real_len: usize,
    /// Offset and largest value with a meaning.
    codes: Vec<(usize, u8)>,
    bools: Vec<usize>,
    read: Read,
}

/// The datagram as the codec would send it, or why not.
type Read = fn(Version, &[u8], &mut [u8; ROOM]) -> Result<Outcome, fci::Error>;

/// Whether numbers are used does not keep them from coming back.
fn usable(check: Result<(), fci::Error>) -> Result<Outcome, fci::Error> {
    match check {
        Err(fci::Error::NotFinite { .. }) => Ok(Outcome::NotFinite),
        other => other.map(|()| Outcome::Accepted),
    }
}

fn read_state(version: Version, bytes: &[u8], out: &mut [u8; ROOM]) -> Result<Outcome, fci::Error> {
    let packet = StatePacket::new_checked(version, bytes)?;
    let out: &mut [u8; state::LEN_MAX] = out.first_chunk_mut().expect("room");
    State::parse(&packet).emit(version, out)?;
    usable(packet.check_finite(&FIELDS))
}

fn read_command(
    version: Version,
    bytes: &[u8],
    out: &mut [u8; ROOM],
) -> Result<Outcome, fci::Error> {
    let value = Command::parse(version, bytes)?;
    let out: &mut [u8; command::LEN_MAX] = out.first_chunk_mut().expect("room");
    value.emit(version, out);
    usable(value.check())
}

impl Kind {
    pub fn state(version: Version) -> Self {
        let layout = data::layout(version);
        let place = |&(_, count, double, single): &(_, usize, Option<usize>, usize)| {
            let at = if layout.real == 4 {
                Some(single)
            } else {
                double
            };
            Some((at?, count))
        };
        let codes = vec![
            (
                layout.motion_generator_mode,
                data::generator_mode_max(version),
            ),
            (layout.controller_mode, 3),
            (layout.robot_mode, 6),
        ];
        Self {
            version,
            valid: data::state(version),
            reals: data::REALS.iter().filter_map(place).collect(),
            real_len: layout.real,
            codes,
            bools: (layout.errors..layout.errors + 82).collect(),
            read: read_state,
        }
    }

    pub fn command(version: Version) -> Self {
        Self {
            version,
            valid: data::command(version),
            reals: vec![(8, 38), (314, 7)],
            real_len: 8,
            codes: Vec::new(),
            bools: data::command_bools(version).to_vec(),
            read: read_command,
        }
    }

    /// What the reader must say.
    pub fn expected(&self, bytes: &[u8]) -> Outcome {
        if bytes.len() != self.valid.len() {
            Outcome::Length
        } else if self.codes.iter().any(|&(at, max)| bytes[at] > max) {
            Outcome::Code
        } else if self.bools.iter().any(|&at| bytes[at] > 1) {
            Outcome::Bool
        } else if self
            .reals
            .iter()
            .any(|&block| self.not_finite(bytes, block))
        {
            Outcome::NotFinite
        } else {
            Outcome::Accepted
        }
    }

    /// Whether a block has a number with an exponent of ones.
    fn not_finite(&self, bytes: &[u8], (at, count): (usize, usize)) -> bool {
        let block = &bytes[at..at + self.real_len * count];
        // In the two upper bytes: 8 bits behind the sign, or 11.
        let ones = if self.real_len == 4 { 0x7F80 } else { 0x7FF0 };
        block.chunks_exact(self.real_len).any(|real| {
            let [low, high] = *real.last_chunk().expect("two bytes");
            u16::from_le_bytes([low, high]) & ones == ones
        })
    }

    /// What it says, and that what it accepts comes back.
    fn outcome(&self, bytes: &[u8]) -> Result<Outcome, String> {
        let mut again = [0xAA; ROOM];
        let outcome = match (self.read)(self.version, bytes, &mut again) {
            Err(error) => return Outcome::of(error),
            Ok(outcome) => outcome,
        };
        if again[..bytes.len()] == *bytes {
            return Ok(outcome);
        }
        for (at, (&sent, &came)) in again.iter().zip(bytes).enumerate() {
            // The quiet bit of a NaN in binary32 may be set on the way through binary64.
            let quiet = outcome == Outcome::NotFinite && self.real_len == 4 && sent == came | 0x40;
            if sent != came && !quiet {
                return Err(format!("byte {at}: {sent:#04x}; expected: {came:#04x}"));
            }
        }
        Ok(outcome)
    }
}

/// A datagram that is being damaged.
pub struct Datagram {
    bytes: [u8; ROOM],
    len: usize,
}

impl Datagram {
    /// None.
    pub fn new() -> Self {
        Self {
            bytes: [0; ROOM],
            len: 0,
        }
    }

    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.len]
    }

    /// Begins anew.
    pub fn set(&mut self, valid: &[u8]) {
        self.bytes[..valid.len()].copy_from_slice(valid);
        self.bytes[valid.len()..].fill(0);
        self.len = valid.len();
    }

    /// Writes over it, as far as it goes.
    pub fn put(&mut self, at: usize, bytes: &[u8]) {
        let places = self.bytes[..self.len].iter_mut().skip(at);
        for (place, byte) in places.zip(bytes) {
            *place = *byte;
        }
    }

    /// Which damage it was, of one of a kind by a part of another one.
    pub fn damage(&mut self, own: &Kind, other: &Kind, random: &mut Random) -> usize {
        let damage = random.below(DAMAGES.len());
        let bytes = &mut self.bytes;
        match damage {
            0 => random.flip(&mut bytes[..self.len]),
            1 => random.set(&mut bytes[..self.len]),
            // Cut off, or longer by what was in the buffer.
            2 => {
                let any = random.length(self.len, ROOM);
                self.len = random.pick(&[any, any, own.valid.len(), other.valid.len()]);
            }
            // The other kind from some offset on.
            3 => {
                let cut = random.below(other.valid.len());
                bytes[cut..other.valid.len()].copy_from_slice(&other.valid[cut..]);
                self.len = random.pick(&[self.len, other.valid.len()]);
            }
            4 => {
                let (at, count) = random.pick(&own.reals);
                let at = at + own.real_len * random.below(count);
                let (low, high) = (random.bits(), random.bits());
                let doubles = [
                    f64::NAN.to_bits(),
                    0x7FF0_0000_0000_0001, // signalling
                    f64::INFINITY.to_bits(),
                    f64::NEG_INFINITY.to_bits(),
                    f64::MAX.to_bits(),
                    1, // the smallest
                    u64::from(high) << 32 | u64::from(low),
                ];
                let singles = [
                    f32::NAN.to_bits(),
                    0x7F80_0001,
                    f32::INFINITY.to_bits(),
                    f32::NEG_INFINITY.to_bits(),
                    f32::MAX.to_bits(),
                    1,
                    low,
                ];
                let place = &mut bytes[at..at + own.real_len];
                match own.real_len {
                    4 => place.copy_from_slice(&random.pick(&singles).to_le_bytes()),
                    _ => place.copy_from_slice(&random.pick(&doubles).to_le_bytes()),
                }
            }
            _ => {
                let codes = own.codes.len();
                let place = random.below(codes + own.bools.len().min(8));
                let at = match own.codes.get(place) {
                    Some(&(at, _)) => at,
                    None => own.bools[place - codes],
                };
                bytes[at] = random.below(9) as u8;
            }
        }
        damage
    }
}

/// The readers, and what they have said.
pub struct Datagrams {
    kinds: Vec<Kind>,
    datagram: Datagram,
    damages: Table,
    outcomes: Table,
}

impl Datagrams {
    pub fn new() -> Self {
        let mut damages = Table::new("damage", &DAMAGES);
        let mut outcomes = Table::new("read as", &OUTCOMES);
        for version in VERSIONS {
            let head = format!("state {}", version.number());
            damages = damages.with(&head, &[]);
            outcomes = outcomes.with(&head, &[]);
        }
        for version in VERSIONS {
            let head = format!("command {}", version.number());
            damages = damages.with(&head, &[]);
            // It has no codes.
            outcomes = outcomes.with(&head, &[Outcome::Code as usize]);
        }
        let states = VERSIONS.map(Kind::state);
        let kinds = states.into_iter().chain(VERSIONS.map(Kind::command));
        Self {
            kinds: kinds.collect(),
            datagram: Datagram::new(),
            damages,
            outcomes,
        }
    }
}

impl Cases for Datagrams {
    /// One datagram to all readers.
    fn case(&mut self, random: &mut Random) -> Result<(), String> {
        let chosen = random.below(self.kinds.len());
        let own = &self.kinds[chosen];
        let other = &self.kinds[random.below(self.kinds.len())];
        self.datagram.set(&own.valid);
        for _ in 0..=random.below(3) {
            let damage = self.datagram.damage(own, other, random);
            self.damages.count(damage, chosen);
        }
        let bytes = self.datagram.bytes();
        for (column, kind) in self.kinds.iter().enumerate() {
            let expected = kind.expected(bytes);
            let outcome = kind.outcome(bytes).and_then(|outcome| {
                let as_expected = (outcome == expected).then_some(outcome);
                as_expected.ok_or_else(|| format!("{outcome:?}; expected: {expected:?}"))
            });
            let version = kind.version.number();
            let outcome = outcome.map_err(|why| format!("version {version}: {why}"))?;
            self.outcomes.count(outcome as usize, column);
        }
        Ok(())
    }

    fn bytes(&self) -> &[u8] {
        self.datagram.bytes()
    }

    fn tables(self) -> Vec<Table> {
        vec![self.damages, self.outcomes]
    }
}
