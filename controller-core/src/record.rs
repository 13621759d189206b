//! One cycle as data, and a ring of the last cycles in the caller's storage:
//! what happened before a fault.

use heapless::Vec;

use crate::controller::Step;
use crate::fault::Status;
use crate::joint::JointVector;
use crate::measurement::Measurement;
use crate::real::Real;

/// What went into a cycle and what came out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleRecord<T: Real> {
    /// Cycle number, counted by the recorder.
    pub number: u32,
    /// The measurement as it came, plausible or not.
    pub measurement: Measurement<T>,
    /// Torque after limits \[Nm\].
    pub torque: JointVector<T>,
    /// r \[Nm\].
    pub residual: JointVector<T>,
    /// Limits and fault.
    pub status: Status,
}

/// The last `N` cycles. Const-constructed, so that it can be a `static`.
#[derive(Debug, Default)]
pub struct Recorder<T: Real, const N: usize> {
    cycles: Vec<CycleRecord<T>, N>,
    /// Where the next cycle goes once all places are taken.
    oldest: usize,
    next: u32,
}

impl<T: Real, const N: usize> Recorder<T, N> {
    /// An empty recorder.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cycles: Vec::new(),
            oldest: 0,
            next: 0,
        }
    }

    /// Adds a cycle; the oldest one gives way. The number wraps around.
    pub fn push(&mut self, measurement: &Measurement<T>, step: &Step<T>) {
        let record = CycleRecord {
            number: self.next,
            measurement: *measurement,
            torque: step.torque,
            residual: step.residual,
            status: step.status,
        };
        if !self.cycles.is_full() {
            let _ = self.cycles.push(record);
        } else if let Some(place) = self.cycles.get_mut(self.oldest) {
            *place = record;
            self.oldest = (self.oldest + 1) % N;
        }
        self.next = self.next.wrapping_add(1);
    }

    /// The recorded cycles, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &CycleRecord<T>> {
        let (newer, older) = (self.cycles.iter(), self.cycles.iter());
        older.skip(self.oldest).chain(newer.take(self.oldest))
    }
}
