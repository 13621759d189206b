//! Counters of 16 bits: what was lost, repeated or overtaken.

/// The counter of a sender.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Sender {
    last: u16,
}

impl Sender {
    /// The first datagram will have the counter `first`.
    #[must_use]
    pub const fn starting_at(first: u16) -> Self {
        Self {
            last: first.wrapping_sub(1),
        }
    }

    /// The counter of the next datagram.
    pub fn advance(&mut self) -> u16 {
        self.last = self.last.wrapping_add(1);
        self.last
    }

    /// The counter of the last datagram.
    #[must_use]
    pub fn last(&self) -> u16 {
        self.last
    }
}

/// How a datagram stands to those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub enum Arrival {
    /// The first one: any counter.
    First,
    /// Newer than all before it; so many between them have not come.
    Next {
        /// 0 if it is the very next.
        lost: u16,
    },
    /// The same as the newest.
    Repeated,
    /// Older than the newest: overtaken, or repeated late.
    Old,
}

impl Arrival {
    /// Whether it is newer than all before it. Only such a datagram counts.
    #[must_use]
    pub fn is_fresh(self) -> bool {
        matches!(self, Self::First | Self::Next { .. })
    }
}

/// Counts of a receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Counts {
    /// Fresh datagrams.
    pub fresh: u64,
    /// Counters that were passed over. One that comes later is also counted as old.
    pub lost: u64,
    /// Repetitions of the newest.
    pub repeated: u64,
    /// Overtaken ones.
    pub old: u64,
}

/// The counters of a peer.
///
/// A counter is newer if it is ahead by 1 to 32767. A peer that starts again with
/// a lower counter looks old until it has caught up: who notices its silence calls
/// [`Receiver::reset`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Receiver {
    newest: Option<u16>,
    counts: Counts,
}

impl Receiver {
    /// Nothing received.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            newest: None,
            counts: Counts {
                fresh: 0,
                lost: 0,
                repeated: 0,
                old: 0,
            },
        }
    }

    /// Takes the counter of a datagram that has passed its check.
    pub fn receive(&mut self, counter: u16) -> Arrival {
        let arrival = match self.newest {
            None => Arrival::First,
            Some(newest) => match counter.wrapping_sub(newest) {
                0 => Arrival::Repeated,
                ahead @ 1..=32767 => Arrival::Next { lost: ahead - 1 },
                _ => Arrival::Old,
            },
        };
        match arrival {
            Arrival::First => self.counts.fresh += 1,
            Arrival::Next { lost } => {
                self.counts.fresh += 1;
                self.counts.lost += u64::from(lost);
            }
            Arrival::Repeated => self.counts.repeated += 1,
            Arrival::Old => self.counts.old += 1,
        }
        if arrival.is_fresh() {
            self.newest = Some(counter);
        }
        arrival
    }

    /// The newest counter; 0, which a header says before the first, if there is none.
    #[must_use]
    pub fn newest(&self) -> u16 {
        self.newest.unwrap_or(0)
    }

    /// Counts so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Accepts any counter next. The counts stay.
    pub fn reset(&mut self) {
        self.newest = None;
    }
}
