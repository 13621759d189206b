//! Datagrams and streams damaged at random, and what the codec must make of them.
//!
//! Everything follows from the seed. Each case begins as a valid one and is damaged one to
//! three times. What readers must answer is decided here, from offsets and codes written down
//! again, without the codec.

#[path = "../../tests/data/mod.rs"]
mod data;
#[path = "mutator/datagrams.rs"]
mod datagrams;
#[path = "mutator/streams.rs"]
mod streams;

use std::fmt;

use fci::Error;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

pub struct Random(ChaCha8Rng);

impl Random {
    /// 0 to n - 1.
    fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.0.next_u32()) * n as u64) >> 32) as usize
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// Flips bits, or sets bytes.
    fn damage(&mut self, bytes: &mut [u8]) {
        if bytes.is_empty() {
            return;
        }
        if self.below(2) == 0 {
            for _ in 0..=self.below(8) {
                let bit = self.below(8 * bytes.len());
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
        } else {
            for _ in 0..=self.below(4) {
                let at = self.below(bytes.len());
                let any = self.0.next_u32() as u8;
                bytes[at] = self.pick(&[0x00, 0x01, 0x02, 0x7F, 0x80, 0xFF, any]);
            }
        }
    }
}

/// What a reader says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Accepted,
    Length,
    Code,
    Bool,
    /// Accepted, with a number that is none.
    NotFinite,
}

const OUTCOMES: [(Outcome, &str); 5] = [
    (Outcome::Accepted, "accepted"),
    (Outcome::Length, "length"),
    (Outcome::Code, "code"),
    (Outcome::Bool, "bool"),
    (Outcome::NotFinite, "not finite"),
];

impl Outcome {
    fn of(error: Error) -> Result<Self, String> {
        match error {
            Error::Length { .. } => Ok(Self::Length),
            Error::Code { .. } => Ok(Self::Code),
            Error::Bool { .. } => Ok(Self::Bool),
            Error::NotFinite { .. } => Ok(Self::NotFinite),
            other => Err(format!("unknown error: {other}")),
        }
    }
}

/// How often each reader said what.
pub struct Table {
    rows: Vec<Row>,
}

pub struct Row {
    name: String,
    counts: [u64; OUTCOMES.len()],
    /// What can be.
    possible: &'static [Outcome],
}

impl Row {
    fn new(name: String, possible: &'static [Outcome]) -> Self {
        let counts = [0; OUTCOMES.len()];
        Self {
            name,
            counts,
            possible,
        }
    }
}

impl Table {
    /// The first answer that occurred though it cannot be, or did not though it can.
    pub fn missing(&self) -> Option<String> {
        self.rows.iter().find_map(|row| {
            let mut cells = OUTCOMES.iter().zip(row.counts);
            let wrong = cells
                .find(|&(&(outcome, _), count)| (count > 0) != row.possible.contains(&outcome));
            wrong.map(|((_, name), count)| format!("{}, {name}: {count} times", row.name))
        })
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:20}", "read as")?;
        for (_, name) in OUTCOMES {
            write!(f, "{name:>12}")?;
        }
        for row in &self.rows {
            write!(f, "\n{:20}", row.name)?;
            for count in row.counts {
                write!(f, "{count:>12}")?;
            }
        }
        Ok(())
    }
}

/// Gives `count` cases to the readers: three datagrams to a stream.
///
/// # Errors
/// The first case that is not treated as it must be: number, reason, bytes.
pub fn run(count: u64, seed: u64) -> Result<Table, String> {
    let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
    let mut datagrams = datagrams::Datagrams::new();
    let mut streams = streams::Streams::new();
    for number in 0..count {
        let outcome = if random.below(4) > 0 {
            datagrams.case(&mut random)
        } else {
            streams.case(&mut random)
        };
        outcome.map_err(|(why, bytes)| failure(number, &why, &bytes))?;
    }
    let rows = datagrams.rows.into_iter().chain(streams.rows).collect();
    Ok(Table { rows })
}

fn failure(number: u64, why: &str, bytes: &[u8]) -> String {
    let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("case {number}: {why}; bytes: {hex}")
}
