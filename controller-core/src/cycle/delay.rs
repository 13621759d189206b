//! Dead time: which of the torques sent acts now.

use crate::joint::{JointVector, zeros};
use crate::ranges::DEAD_CYCLES_MAX;
use crate::real::Real;

/// The torques of the last cycles: which of them acts now, behind a dead time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay<T: Real> {
    /// A ring.
    sent: [JointVector<T>; REMEMBERED],
    /// Where the next torque goes.
    place: usize,
    started: bool,
}

const REMEMBERED: usize = DEAD_CYCLES_MAX as usize;

impl<T: Real> Delay<T> {
    /// Nothing sent.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            sent: [zeros(); REMEMBERED],
            place: 0,
            started: false,
        }
    }

    /// Sends `torque` and returns the one that acts in this cycle: sent
    /// `cycles` cycles ago, or `before` if that was before the first.
    #[inline]
    pub fn send(
        &mut self,
        cycles: u8,
        torque: &JointVector<T>,
        before: &JointVector<T>,
    ) -> JointVector<T> {
        let ago = usize::from(cycles).min(REMEMBERED);
        if ago == 0 {
            return *torque;
        }
        if !self.started {
            self.sent = [*before; REMEMBERED];
            self.started = true;
        }
        let acting = self.sent[(self.place + REMEMBERED - ago) % REMEMBERED];
        self.place %= REMEMBERED;
        self.sent[self.place] = *torque;
        self.place = (self.place + 1) % REMEMBERED;
        acting
    }
}

impl<T: Real> Default for Delay<T> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_that_acts_is_the_one_sent_that_many_cycles_ago() {
        for cycles in 0..=DEAD_CYCLES_MAX {
            let mut line = Delay::<f64>::new();
            let before = JointVector::repeat(-1.0);
            for k in 0..12u8 {
                let acting = line.send(cycles, &JointVector::repeat(f64::from(k)), &before);
                let expected = if k < cycles {
                    -1.0
                } else {
                    f64::from(k - cycles)
                };
                assert_eq!(acting, JointVector::repeat(expected), "{cycles} {k}");
            }
        }
    }
}
