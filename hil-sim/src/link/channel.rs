//! One direction of the link in virtual time.

use super::fault::{Direction, Fault, FaultKind};
use crate::plant::Rng;
use crate::plant::noise::stream;

/// Times closer than this are one: what is sent together stays in order \[s\].
const ROUNDING_S: f64 = 1e-10;

/// A datagram that arrives.
#[derive(Clone, Debug, PartialEq)]
pub struct Delivery {
    /// When \[s\], on the clock of [`Channel::send`].
    pub time_s: f64,
    /// What.
    pub bytes: Vec<u8>,
    /// Whether the channel changed it or it came before: the receiver need not
    /// react as to a sound one.
    pub damaged: bool,
    /// Number of the datagram, in the order of sending.
    pub number: u64,
}

/// Datagrams under way, and the faults that meet them.
#[derive(Clone, Debug)]
pub struct Channel {
    direction: Direction,
    faults: Vec<Fault>,
    cycle_s: f64,
    rng: Rng,
    /// Still to be lost of a burst, per fault.
    burst: Vec<u32>,
    sent: u64,
    /// Ordered by time, then by entry.
    queue: Vec<Delivery>,
}

impl Channel {
    /// An empty channel of a link with cycles of `cycle_s` \[s\].
    #[must_use]
    pub fn new(direction: Direction, faults: &[Fault], cycle_s: f64, seed: u64) -> Self {
        let number = match direction {
            Direction::ToClient => stream::TO_CLIENT,
            Direction::ToRobot => stream::TO_ROBOT,
        };
        Self {
            direction,
            burst: vec![0; faults.len()],
            faults: faults.to_vec(),
            cycle_s,
            rng: Rng::new(seed, number),
            sent: 0,
            queue: Vec::new(),
        }
    }

    /// Whether it is perfect.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let here = |fault: &Fault| fault.direction.is_none_or(|only| only == self.direction);
        !self.faults.iter().any(here)
    }

    /// Sends at `now_s` \[s\], scenario time `t_s` \[s\] if that runs.
    pub fn send(&mut self, now_s: f64, t_s: Option<f64>, bytes: &[u8]) {
        let number = self.sent;
        self.sent += 1;
        let (mut lost, mut twice, mut damaged) = (false, false, false);
        let (mut delay, mut frozen) = (0.0, 0.0f64);
        let mut bytes = bytes.to_vec();
        // Every fault that acts draws its numbers, so that one does not change
        // what another does to later datagrams.
        for index in 0..self.faults.len() {
            let fault = self.faults[index];
            if !fault.acts(self.direction, t_s) {
                continue;
            }
            match fault.kind {
                FaultKind::Drop(p) => lost |= self.chance(p),
                FaultKind::Duplicate(p) => twice |= self.chance(p),
                FaultKind::Reorder(p) => {
                    if self.chance(p) {
                        delay += 1.5 * self.cycle_s;
                    }
                }
                FaultKind::Delay(time) => delay += time,
                FaultKind::Jitter(time) => delay += time * self.rng.uniform(),
                FaultKind::Corrupt(p) => {
                    if self.chance(p) {
                        self.corrupt(&mut bytes);
                        damaged = true;
                    }
                }
                FaultKind::Burst(p, count) => {
                    if self.chance(p) && self.burst[index] == 0 {
                        self.burst[index] = count;
                    }
                    if self.burst[index] > 0 {
                        self.burst[index] -= 1;
                        lost = true;
                    }
                }
                FaultKind::Freeze => {
                    if let Some((window, t)) = fault.window.zip(t_s) {
                        frozen = frozen.max(window.to_s - t);
                    }
                }
            }
        }
        if lost {
            return;
        }
        let time_s = match delay.max(frozen) {
            0.0 => now_s,
            // Whole nanoseconds: what is released together stays in order.
            late => ((now_s + late) * 1e9).round() / 1e9,
        };
        let delivery = Delivery {
            time_s,
            bytes,
            damaged,
            number,
        };
        if twice {
            self.insert(delivery.clone());
        }
        self.insert(delivery);
    }

    fn insert(&mut self, delivery: Delivery) {
        let place = self
            .queue
            .partition_point(|other| other.time_s <= delivery.time_s + ROUNDING_S);
        self.queue.insert(place, delivery);
    }

    /// The next datagram that arrives before `before_s` \[s\], which is the end of a
    /// cycle; one that arrives at it, but for rounding, belongs to the next.
    pub fn receive(&mut self, before_s: f64) -> Option<Delivery> {
        let due = self.next_time_s()? < before_s - ROUNDING_S;
        due.then(|| self.queue.remove(0))
    }

    /// When the next datagram arrives \[s\].
    #[must_use]
    pub fn next_time_s(&self) -> Option<f64> {
        self.queue.first().map(|delivery| delivery.time_s)
    }

    fn chance(&mut self, p: f64) -> bool {
        self.rng.uniform() < p
    }

    fn corrupt(&mut self, bytes: &mut [u8]) {
        let count = 1 + self.below(4);
        for _ in 0..count {
            let place = self.below(bytes.len());
            let change = 1 + self.below(255);
            if let Some(byte) = bytes.get_mut(place) {
                *byte ^= change as u8;
            }
        }
    }

    fn below(&mut self, count: usize) -> usize {
        (self.rng.uniform() * count as f64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: f64 = 0.002;

    /// Arrivals of 1000 datagrams, sent at whole cycles, as (number, time).
    fn through(spec: &str, seed: u64) -> Vec<(u64, f64, Vec<u8>)> {
        let faults = [spec.parse().expect("a spec")];
        let mut channel = Channel::new(Direction::ToRobot, &faults, CYCLE, seed);
        let mut arrived = Vec::new();
        for n in 0..1000_u32 {
            let now = f64::from(n) * CYCLE;
            channel.send(now, Some(now), &n.to_le_bytes());
            while let Some(one) = channel.receive(now + CYCLE) {
                arrived.push((one.number, one.time_s - now, one.bytes));
            }
        }
        arrived
    }

    #[test]
    fn a_seed_decides_everything() {
        for spec in [
            "both:drop=0.3",
            "both:jitter=5",
            "both:corrupt=0.2",
            "both:burst=0.02x5",
            "both:reorder=0.1",
            "both:duplicate=0.1",
        ] {
            assert_eq!(through(spec, 4), through(spec, 4));
            assert_ne!(through(spec, 4), through(spec, 5));
        }
    }

    #[test]
    fn kinds_do_what_they_say() {
        let sound = through("to-client:drop=1", 1);
        assert!(sound.len() == 1000 && sound.iter().all(|one| one.1 == 0.0));
        // Four standard deviations of a share of 1000.
        let lost = 1000 - through("to-robot:drop=0.3", 1).len();
        assert!((242..358).contains(&lost), "{lost}");
        let twice = through("both:duplicate=0.3", 1).len() - 1000;
        assert!((242..358).contains(&twice), "{twice}");
        let damaged = through("both:corrupt=0.3", 1);
        let damaged = damaged
            .iter()
            .filter(|(number, _, bytes)| bytes[..] != (*number as u32).to_le_bytes())
            .count();
        assert!((240..358).contains(&damaged), "{damaged}");
        let late = through("both:delay=3", 1);
        assert!(late.len() == 999 && late.iter().all(|one| (one.1 - 1e-3).abs() < 1e-9));
        let window = through("both:drop=1@0.5-1", 1);
        assert_eq!(window.len(), 750);
    }

    #[test]
    fn reordered_datagrams_are_overtaken_once() {
        let order: Vec<_> = through("both:reorder=0.2", 1)
            .iter()
            .map(|one| one.0)
            .collect();
        let overtaken = order.windows(2).filter(|pair| pair[1] < pair[0]).count();
        assert!(overtaken > 100);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.windows(2).all(|pair| pair[1] == pair[0] + 1));
    }

    #[test]
    fn bursts_come_in_rows() {
        let numbers: Vec<_> = through("both:burst=0.01x7", 1)
            .iter()
            .map(|one| one.0)
            .collect();
        let gaps = numbers.windows(2).map(|pair| pair[1] - pair[0] - 1);
        let gaps: Vec<_> = gaps.filter(|gap| *gap > 0).collect();
        assert!(
            !gaps.is_empty() && gaps.iter().all(|gap| gap % 7 == 0),
            "{gaps:?}"
        );
    }

    #[test]
    fn a_freeze_holds_everything_back_to_its_end() {
        let arrived = through("both:freeze@0.5-0.6", 1);
        assert_eq!(arrived.len(), 1000);
        assert!(arrived.windows(2).all(|pair| pair[1].0 == pair[0].0 + 1));
        let late = arrived.iter().filter(|one| one.0 >= 250 && one.0 < 300);
        assert_eq!(late.count(), 50);
    }
}
