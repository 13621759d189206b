//! States and commands.

use std::panic::catch_unwind;

use fci::state::{self, FIELDS, State, StatePacket};
use fci::{Command, Version, command};

use super::{OUTCOMES, Outcome, Random, Row, data};

/// Room for what is longer than all.
const ROOM: usize = 2560;

const VERSIONS: [Version; 3] = [Version::V5, Version::V6, Version::V10];

/// The layout of a kind of datagram, as far as a check goes.
struct Kind {
    version: Version,
    valid: Vec<u8>,
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
    fn state(version: Version) -> Self {
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

    fn command(version: Version) -> Self {
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
    fn expected(&self, bytes: &[u8]) -> Outcome {
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
        let read = catch_unwind(move || {
            let read = (self.read)(self.version, bytes, &mut again);
            (read, again)
        });
        let (read, again) = read.map_err(|_| "panic".to_string())?;
        let outcome = match read {
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

/// The readers, and what they have said.
pub struct Datagrams {
    kinds: Vec<Kind>,
    pub rows: Vec<Row>,
}

impl Datagrams {
    pub fn new() -> Self {
        let states = VERSIONS.map(Kind::state);
        let kinds = states.into_iter().chain(VERSIONS.map(Kind::command));
        let row = |name, possible| {
            move |version: Version| Row::new(format!("{name} {}", version.number()), possible)
        };
        const ALL: &[Outcome] = &[
            Outcome::Accepted,
            Outcome::Length,
            Outcome::Code,
            Outcome::Bool,
            Outcome::NotFinite,
        ];
        const NO_CODE: &[Outcome] = &[
            Outcome::Accepted,
            Outcome::Length,
            Outcome::Bool,
            Outcome::NotFinite,
        ];
        let states = VERSIONS.map(row("state", ALL));
        let rows = states
            .into_iter()
            .chain(VERSIONS.map(row("command", NO_CODE)));
        Self {
            kinds: kinds.collect(),
            rows: rows.collect(),
        }
    }

    /// One datagram to all readers.
    pub fn case(&mut self, random: &mut Random) -> Result<(), (String, Vec<u8>)> {
        let own = &self.kinds[random.below(self.kinds.len())];
        let other = &self.kinds[random.below(self.kinds.len())];
        let mut bytes = [0; ROOM];
        bytes[..own.valid.len()].copy_from_slice(&own.valid);
        let mut len = own.valid.len();
        for _ in 0..=random.below(3) {
            damage(&mut bytes, &mut len, own, other, random);
        }
        let bytes = &bytes[..len];
        for (kind, row) in self.kinds.iter().zip(&mut self.rows) {
            let expected = kind.expected(bytes);
            let outcome = kind.outcome(bytes).and_then(|outcome| {
                let as_expected = (outcome == expected).then_some(outcome);
                as_expected.ok_or_else(|| format!("{outcome:?}; expected: {expected:?}"))
            });
            let outcome =
                outcome.map_err(|why| (format!("{}: {why}", row.name), bytes.to_vec()))?;
            let place = OUTCOMES.iter().position(|it| it.0 == outcome);
            row.counts[place.expect("in the list")] += 1;
        }
        Ok(())
    }
}

fn damage(bytes: &mut [u8; ROOM], len: &mut usize, own: &Kind, other: &Kind, random: &mut Random) {
    match random.below(6) {
        0 | 1 => random.damage(&mut bytes[..*len]),
        // Cut off, or longer by what was in the buffer.
        2 => {
            let near = (*len + random.below(9)).saturating_sub(4);
            let any = random.below(ROOM + 1);
            let length = random.pick(&[near, any, own.valid.len(), other.valid.len()]);
            *len = length.min(ROOM);
        }
        // The other kind from some offset on.
        3 => {
            let cut = random.below(other.valid.len());
            bytes[cut..other.valid.len()].copy_from_slice(&other.valid[cut..]);
            *len = random.pick(&[*len, other.valid.len()]);
        }
        // A real.
        4 => {
            let (at, count) = random.pick(&own.reals);
            let at = at + own.real_len * random.below(count);
            let extremes = [
                f64::NAN,
                f64::from_bits(0x7FF0_0000_0000_0001), // signalling
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::MAX,
                f64::MIN_POSITIVE,
                f64::from_bits(1), // the smallest
                -0.0,
            ];
            let double = random.pick(&extremes).to_le_bytes();
            let singles = [
                0x7FC0_0000,
                0x7F80_0001,
                0x7F80_0000,
                0xFF80_0000,
                0x7F7F_FFFF,
                1,
            ];
            let single: u32 = random.pick(&singles);
            match own.real_len {
                4 => bytes[at..at + 4].copy_from_slice(&single.to_le_bytes()),
                _ => bytes[at..at + 8].copy_from_slice(&double),
            }
        }
        // A code or a truth value.
        _ => {
            let code = own.codes.iter().map(|&(at, _)| at);
            let places: Vec<usize> = code.chain(own.bools.iter().copied().take(8)).collect();
            bytes[random.pick(&places)] = random.below(9) as u8;
        }
    }
}
