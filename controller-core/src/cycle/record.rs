//! One cycle as data, and a ring of the last cycles in the caller's storage:
//! what happened before a fault.

use super::measurement::Measurement;
use super::step::Step;
use crate::fault::Status;
use crate::joint::{JointVector, zeros};
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

impl<T: Real> CycleRecord<T> {
    /// All zero.
    const EMPTY: Self = Self {
        number: 0,
        measurement: Measurement {
            q: zeros(),
            dq: zeros(),
            interval_s: T::ZERO,
        },
        torque: zeros(),
        residual: zeros(),
        status: Status::CLEAR,
    };
}

/// The last `N` cycles. Const-constructed, so that it can be a `static`.
#[derive(Debug)]
pub struct Recorder<T: Real, const N: usize> {
    cycles: [CycleRecord<T>; N],
    /// Places that hold a cycle.
    taken: usize,
    /// Where the next cycle goes: the oldest one once all places are taken.
    place: usize,
    next: u32,
}

impl<T: Real, const N: usize> Recorder<T, N> {
    /// An empty recorder.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cycles: [CycleRecord::EMPTY; N],
            taken: 0,
            place: 0,
            next: 0,
        }
    }

    /// Adds a cycle; the oldest one gives way. The number wraps around.
    pub fn push(&mut self, measurement: &Measurement<T>, step: &Step<T>) {
        if let Some(place) = self.cycles.get_mut(self.place) {
            place.number = self.next;
            // One by one: all of it is copied by a call.
            place.measurement.q = measurement.q;
            place.measurement.dq = measurement.dq;
            place.measurement.interval_s = measurement.interval_s;
            place.torque = step.torque;
            place.residual = step.residual;
            place.status = step.status;
            self.place = if self.place + 1 < N {
                self.place + 1
            } else {
                0
            };
            self.taken = N.min(self.taken + 1);
        }
        self.next = self.next.wrapping_add(1);
    }

    /// The recorded cycles, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &CycleRecord<T>> {
        let oldest = if self.taken < N { 0 } else { self.place };
        let in_turn = self.cycles.iter().chain(&self.cycles);
        in_turn.skip(oldest).take(self.taken)
    }
}

impl<T: Real, const N: usize> Default for Recorder<T, N> {
    fn default() -> Self {
        Self::new()
    }
}
