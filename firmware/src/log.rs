//! The log of the self-test: what went into every cycle and which torque came
//! out, to the last bit.
//!
//! A file is a sequence of runs. A run is a header of eight bytes, `STRM`, number
//! of the scenario, bytes per number (8 or 4) and the number of cycles as u16, and then per
//! cycle q, dq, h and the torque: 22 numbers, little endian.

use controller_core::joint::{DOF, JointVector};
use controller_core::real::Real;
use controller_core::{Measurement, State};

use crate::scenario::{FixedScenario, ReadyScenario};

/// Numbers per cycle.
pub const NUMBERS: usize = 3 * DOF + 1;

/// Bytes of a cycle in double precision, the longest.
pub const CYCLE_BYTES: usize = NUMBERS * 8;

/// First bytes of a run.
pub const MAGIC: [u8; 4] = *b"STRM";

/// Bytes of a header.
pub const HEADER_BYTES: usize = 8;

/// A precision of the log.
pub trait Number: Real {
    /// Bytes of a number.
    const BYTES: usize;
    /// Name in reports.
    const NAME: &'static str;
    /// The pattern, widened with zeros.
    fn pattern(self) -> u64;
    /// From a pattern.
    fn from_pattern(pattern: u64) -> Self;
}

impl Number for f64 {
    const BYTES: usize = 8;
    const NAME: &'static str = "f64";
    fn pattern(self) -> u64 {
        self.to_bits()
    }
    fn from_pattern(pattern: u64) -> Self {
        Self::from_bits(pattern)
    }
}

impl Number for f32 {
    const BYTES: usize = 4;
    const NAME: &'static str = "f32";
    fn pattern(self) -> u64 {
        u64::from(self.to_bits())
    }
    fn from_pattern(pattern: u64) -> Self {
        Self::from_bits(pattern as u32)
    }
}

/// Where a run begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Which scenario.
    pub scenario: FixedScenario,
    /// 8 or 4.
    pub bytes: u8,
    /// How many cycles follow.
    pub cycles: u16,
}

impl Header {
    /// Its bytes.
    #[must_use]
    pub fn encode(self) -> [u8; HEADER_BYTES] {
        let [m0, m1, m2, m3] = MAGIC;
        let [low, high] = self.cycles.to_le_bytes();
        [m0, m1, m2, m3, self.scenario as u8, self.bytes, low, high]
    }

    /// From its bytes; none where they are no header.
    #[must_use]
    pub fn decode(bytes: [u8; HEADER_BYTES]) -> Option<Self> {
        let [m0, m1, m2, m3, number, size, low, high] = bytes;
        let scenario = FixedScenario::from_number(number)?;
        let known = [m0, m1, m2, m3] == MAGIC && (size == 8 || size == 4);
        known.then_some(Self {
            scenario,
            bytes: size,
            cycles: u16::from_le_bytes([low, high]),
        })
    }
}

/// One cycle of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry<T: Real> {
    /// What went in.
    pub measurement: Measurement<T>,
    /// What came out \[Nm\].
    pub torque: JointVector<T>,
}

impl<T: Number> Entry<T> {
    /// The bytes of all numbers; those behind `NUMBERS * T::BYTES` are zero.
    #[must_use]
    pub fn encode(&self) -> [u8; CYCLE_BYTES] {
        let Measurement { q, dq, interval_s } = &self.measurement;
        let numbers = q.iter().chain(dq).chain([interval_s]).chain(&self.torque);
        let mut bytes = [0; CYCLE_BYTES];
        for (slot, number) in bytes.chunks_exact_mut(T::BYTES).zip(numbers) {
            for (byte, value) in slot.iter_mut().zip(number.pattern().to_le_bytes()) {
                *byte = value;
            }
        }
        bytes
    }

    /// From those bytes.
    #[must_use]
    pub fn decode(bytes: &[u8; CYCLE_BYTES]) -> Self {
        let mut numbers = bytes.chunks_exact(T::BYTES).map(|slot| {
            let pattern = slot.iter().rev().fold(0, |sum, &b| sum << 8 | u64::from(b));
            T::from_pattern(pattern)
        });
        let mut next = || numbers.next().unwrap_or(T::ZERO);
        let mut vector = || JointVector::from_fn(|_, _| next());
        let (q, dq) = (vector(), vector());
        let interval_s = next();
        let torque = JointVector::from_fn(|_, _| next());
        Self {
            measurement: Measurement { q, dq, interval_s },
            torque,
        }
    }
}

/// The first torque that differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Cycle, counted from 0.
    pub cycle: u16,
    /// Joint, 1 to 7.
    pub joint: u8,
    /// Pattern in the log.
    pub expected: u64,
    /// Pattern computed here.
    pub found: u64,
}

/// What a replay found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Cycles compared.
    pub cycles: u16,
    /// Torque bits that differ, over all cycles and joints.
    pub bits: u32,
    /// Cycles with a fault.
    pub faults: u16,
    /// Where they begin to differ.
    pub first: Option<Difference>,
}

/// Runs the controller over `cycles` entries and compares every torque with the
/// log. `next` gives the bytes of an entry, none at the end of the file.
pub fn replay<T: Number>(
    ready: &ReadyScenario<T>,
    cycles: u16,
    mut next: impl FnMut() -> Option<[u8; CYCLE_BYTES]>,
) -> Comparison {
    let mut state = State::new();
    let mut result = Comparison::default();
    for cycle in 0..cycles {
        let Some(bytes) = next() else { break };
        let entry = Entry::<T>::decode(&bytes);
        let reference = ready.reference(u32::from(cycle));
        let step = (ready.controller).step(&mut state, &entry.measurement, &reference);
        result.cycles += 1;
        result.faults += u16::from(step.status.fault.is_some());
        for (joint, (found, expected)) in (1..).zip(step.torque.iter().zip(&entry.torque)) {
            let (found, expected) = (found.pattern(), expected.pattern());
            result.bits += (found ^ expected).count_ones();
            if found != expected && result.first.is_none() {
                result.first = Some(Difference {
                    cycle,
                    joint,
                    expected,
                    found,
                });
            }
        }
    }
    result
}
