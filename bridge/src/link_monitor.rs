//! The monitor of the link: counters on both sides, and whether it carries a motion.

use crate::protocol::{Arrival, Clock};

/// A counter that is ahead by more than this is no loss but another sender, or a
/// damaged datagram that has passed its check.
const JUMP_MAX: u64 = 1000;

/// A gap of more than this is believed when the next datagram confirms it: a cycle more
/// is lost then, and a damaged counter alone moves nothing.
const GAP_MAX: u64 = 100;

/// How long the link must have been sound at the end of a motion \[s\].
const SOUND_S: f64 = 1.0;

/// Datagrams in a row that do not fit the counters, after which they are believed:
/// the robot has started again.
const RESYNC: u8 = 10;

/// Counters and their gaps.
#[derive(Clone, Debug)]
pub(crate) struct LinkMonitor<C> {
    clock: C,
    /// Datagrams in a row that were not fresh.
    stale: u8,
    /// The last counter, if it was too far ahead to be believed.
    outlier: Option<u64>,
    /// What the robot mirrored last.
    mirrored: Option<u64>,
    /// Cycles since that changed.
    unheard: u16,
    /// Cycles since the last trouble, those in this spell of command state.
    clean: u16,
    /// The same, lost cycles and all spells included.
    calm: u32,
    bad: bool,
    /// Cycles since trouble began.
    pub bad_cycles: u32,
}

impl<C: Clock> LinkMonitor<C> {
    pub fn new() -> Self {
        Self {
            clock: C::default(),
            stale: 0,
            outlier: None,
            mirrored: None,
            unheard: 0,
            clean: 0,
            calm: u32::MAX,
            bad: false,
            bad_cycles: 0,
        }
    }

    /// Accepts any counter next.
    pub fn resync(&mut self) {
        self.clock.reset();
    }

    /// Measurements lost before this one; none if it is not to be answered. `mirrored` is
    /// what the robot says of the last command that it has.
    pub fn arrival(&mut self, counter: u64, mirrored: Option<u64>) -> Option<u16> {
        let known = self.clock;
        let mut probe = known;
        let mut arrival = probe.receive(counter);
        if matches!(arrival, Arrival::Next { lost } if lost > JUMP_MAX) {
            arrival = Arrival::Old;
            probe = known;
        }
        self.clock = probe;
        let lost = match arrival {
            Arrival::First => 0,
            Arrival::Next { lost } if lost > GAP_MAX && !self.confirms(counter) => {
                self.clock = known;
                self.outlier = Some(counter);
                return None;
            }
            // At most JUMP_MAX.
            Arrival::Next { lost } => lost as u16,
            Arrival::Repeated => return None,
            Arrival::Old => {
                self.stale += 1;
                if self.stale >= RESYNC {
                    self.stale = 0;
                    self.clock.reset();
                }
                return None;
            }
        };
        self.stale = 0;
        self.outlier = None;
        let passed = lost.saturating_add(1);
        self.unheard = if mirrored == self.mirrored {
            self.unheard.saturating_add(passed)
        } else {
            0
        };
        self.mirrored = mirrored;
        Some(lost)
    }

    /// Whether a counter goes on from the one that was not believed.
    fn confirms(&self, counter: u64) -> bool {
        self.outlier.is_some_and(|outlier| {
            let mut from = C::default();
            from.receive(outlier);
            matches!(from.receive(counter), Arrival::Next { lost } if lost < GAP_MAX)
        })
    }

    /// Judges the link in this cycle: bad when more than `limit` measurements were
    /// lost or commands are not heard, good again after `resume` clean cycles.
    pub fn judge(&mut self, lost: u16, limit: u16, resume: u16) -> bool {
        // A robot that mirrors nothing says nothing about what it hears.
        let deaf = self.unheard > limit && self.mirrored.is_some();
        if lost > limit || deaf {
            if !self.bad {
                self.bad_cycles = 0;
            }
            self.bad = true;
            self.clean = 0;
            self.calm = 0;
        } else {
            self.calm = self.calm.saturating_add(1 + u32::from(lost));
            self.clean = self.clean.saturating_add(1);
            if self.clean >= resume {
                self.bad = false;
            }
        }
        if self.bad {
            self.bad_cycles = self.bad_cycles.saturating_add(1 + u32::from(lost));
        }
        self.bad
    }

    /// Whether the link was good for the last second, this cycle with `lost` before it
    /// included.
    pub fn was_sound(&self, lost: u16, limit: u16, cycle_s: f64) -> bool {
        lost <= limit && f64::from(self.calm) * cycle_s >= SOUND_S
    }

    /// Whether, in this cycle, the motion is out of the controller's hands:
    /// measurements were missing, or commands are not heard.
    pub fn is_broken(&self) -> bool {
        self.bad && self.clean == 0
    }

    /// Forgets the trouble of before.
    pub fn clear(&mut self) {
        self.bad = false;
        self.clean = 0;
        self.unheard = 0;
    }
}
