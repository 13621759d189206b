//! What the null space follows.

use super::super::decay::Clock;
use super::super::trajectory::quintic;
use crate::cells::Cells;
use crate::joint::{DOF, JointVector, zeros};
use crate::ranges::{JOIN_S, JOIN_SPEED, POSTURE_JUMP};
use crate::real::Real;

/// The posture. It has no velocity: its difference leaves at rest, on b of [`quintic`].
#[derive(Clone, Copy, Debug)]
pub(super) struct FollowedPosture<T: Real> {
    known: bool,
    /// q_d as wanted \[rad\].
    pub(super) wanted: JointVector<T>,
    /// What was followed less what is wanted, where it jumped \[rad\].
    from: JointVector<T>,
    clock: Clock<T>,
}

impl<T: Real> FollowedPosture<T> {
    pub(super) const FRESH: Self = Self {
        known: false,
        wanted: zeros(),
        from: zeros(),
        clock: Clock::ENDED,
    };

    /// What it remembers.
    pub(super) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.flag("posture_known", &mut self.known);
        cells.numbers("posture", self.wanted.as_mut_slice());
        cells.numbers("posture_from", self.from.as_mut_slice());
        self.clock.visit(cells);
    }

    /// Whether there is a difference.
    #[inline(always)]
    pub(super) fn joins(&self) -> bool {
        self.clock.runs()
    }

    /// What is wanted in the next cycle, `interval_s` later; the arm is at `q`.
    #[inline(always)]
    pub(super) fn advance(
        &mut self,
        wanted: &JointVector<T>,
        q: &JointVector<T>,
        interval_s: T,
        at_once: bool,
    ) {
        let before = if self.known { &self.wanted } else { q };
        let allowed = T::from_f64(POSTURE_JUMP);
        let mut jumps = false;
        for i in 0..DOF {
            jumps |= (wanted[i] - before[i]).magnitude() > allowed;
        }
        if at_once {
            self.clock.end();
        } else if jumps {
            let before = *before;
            self.join(wanted, &before);
        } else {
            self.clock.advance(interval_s);
        }
        self.wanted = *wanted;
        self.known = true;
    }

    #[cold]
    #[inline(never)]
    fn join(&mut self, wanted: &JointVector<T>, before: &JointVector<T>) {
        self.from = before - wanted + self.offset();
        let mut largest = T::ZERO;
        for value in &self.from {
            largest = largest.most(value.magnitude());
        }
        let [_, speed] = JOIN_SPEED.map(T::from_f64);
        self.clock = Clock::new((largest / speed).most(T::from_f64(JOIN_S)));
    }

    /// What is followed less what is wanted \[rad\].
    #[cold]
    #[inline(never)]
    pub(super) fn offset(&self) -> JointVector<T> {
        if self.joins() {
            let [share, ..] = quintic(self.clock.share());
            self.from * (T::ONE - share)
        } else {
            zeros()
        }
    }
}
