//! Counters against a model that does not wrap: every datagram has a position
//! 0, 1, 2 .. in what the peer has sent, and the model compares positions. 2000
//! cases of each property from a fixed seed.

use fri::sequence::{Arrival, Counts, Receiver, Sender};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};

const CASES: u32 = 2000;

fn for_all<S: Strategy>(strategy: S, test: impl Fn(S::Value)) {
    let config = ProptestConfig {
        cases: CASES,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2018),
        ..ProptestConfig::default()
    };
    let outcome = TestRunner::new(config).run(&strategy, |value| {
        test(value);
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
}

/// A receiver that knows positions.
#[derive(Default)]
struct Model {
    newest: Option<i64>,
    counts: Counts,
}

impl Model {
    fn receive(&mut self, position: i64) -> Arrival {
        let counts = &mut self.counts;
        match self.newest {
            Some(newest) if position == newest => {
                counts.repeated += 1;
                return Arrival::Repeated;
            }
            Some(newest) if position < newest => {
                counts.old += 1;
                return Arrival::Old;
            }
            _ => {}
        }
        counts.fresh += 1;
        let before = self.newest.replace(position);
        before.map_or(Arrival::First, |newest| {
            let lost = position - newest - 1;
            counts.lost += lost as u64;
            Arrival::Next { lost: lost as u16 }
        })
    }
}

/// The counter at a position of a peer that began with `first`.
fn counter(first: u16, position: i64) -> u16 {
    (i64::from(first) + position).rem_euclid(65536) as u16
}

/// What the network does next.
#[derive(Clone, Copy, Debug)]
enum Event {
    /// So many are lost, then one arrives.
    Ahead(i64),
    /// The newest again.
    Again,
    /// One from so far behind the newest.
    Behind(i64),
    /// The peer falls silent and starts again with this counter.
    Restart(u16),
}

/// First counters, of which half are close to the wrap-around.
fn first() -> impl Strategy<Value = u16> {
    prop_oneof![any::<u16>(), 65500..=65535u16]
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        8 => Just(Event::Ahead(0)),
        4 => (0..5i64).prop_map(Event::Ahead),
        // As far as a counter of 16 bits can tell.
        2 => (0..32767i64).prop_map(Event::Ahead),
        1 => Just(Event::Ahead(32766)),
        3 => Just(Event::Again),
        3 => (1..5i64).prop_map(Event::Behind),
        2 => (1..=32768i64).prop_map(Event::Behind),
        1 => Just(Event::Behind(32768)),
        1 => first().prop_map(Event::Restart),
    ]
}

/// Every arrival, the newest counter and the counts, after every event.
#[test]
fn any_network_as_the_model() {
    let strategy = (first(), prop::collection::vec(event(), 1..200));
    for_all(strategy, |(mut first, events)| {
        let (mut receiver, mut model) = (Receiver::new(), Model::default());
        for event in events {
            let newest = model.newest.unwrap_or(-1);
            let position = match event {
                Event::Ahead(lost) => newest + 1 + lost,
                Event::Again => newest,
                Event::Behind(distance) => newest - distance,
                Event::Restart(counter) => {
                    receiver.reset();
                    assert_eq!(receiver.newest(), 0);
                    model.newest = None;
                    first = counter;
                    0
                }
            };
            let arrival = receiver.receive(counter(first, position));
            assert_eq!(arrival, model.receive(position), "{event:?}");
            let fresh = matches!(arrival, Arrival::First | Arrival::Next { .. });
            assert_eq!(arrival.is_fresh(), fresh);
            let newest = model.newest.expect("one has arrived");
            assert_eq!(receiver.newest(), counter(first, newest));
            assert_eq!(receiver.counts(), model.counts);
        }
    });
}

/// Without a restart, what is fresh and what is lost add up to what was sent.
#[test]
fn fresh_and_lost_make_the_whole() {
    let lost = prop::collection::vec(any::<bool>(), 1..2000);
    for_all((first(), lost), |(first, lost)| {
        let mut sender = Sender::starting_at(first);
        let mut receiver = Receiver::new();
        let mut arrived: Vec<u16> = Vec::new();
        for lost in lost {
            let counter = sender.advance();
            if !lost {
                arrived.push(counter);
                assert!(receiver.receive(counter).is_fresh());
            }
        }
        let counts = receiver.counts();
        assert_eq!(counts.fresh, arrived.len() as u64);
        assert_eq!((counts.repeated, counts.old), (0, 0));
        if let [earliest, .., newest] = arrived[..] {
            let passed = u64::from(newest.wrapping_sub(earliest)) + 1;
            assert_eq!(counts.fresh + counts.lost, passed);
        }
    });
}

/// Datagrams that overtake each other by at most `depth`, some of them twice: each one
/// is counted once as what it is, and no counter is fresh twice.
#[test]
fn reordering_and_repetition() {
    let keys = prop::collection::vec((0..40i64, any::<bool>()), 2..300);
    for_all((first(), keys), |(first, keys)| {
        // A datagram with the key k is delayed by k places.
        let mut order: Vec<(i64, i64)> = Vec::new();
        for (position, &(delay, twice)) in (0i64..).zip(&keys) {
            order.push((position + delay, position));
            if twice {
                order.push((position + 2 * delay, position));
            }
        }
        order.sort_unstable();
        let (mut receiver, mut model) = (Receiver::new(), Model::default());
        let mut fresh: Vec<i64> = Vec::new();
        for &(_, position) in &order {
            let arrival = receiver.receive(counter(first, position));
            assert_eq!(arrival, model.receive(position));
            if arrival.is_fresh() {
                fresh.push(position);
            }
        }
        assert!(fresh.is_sorted_by(|a, b| a < b), "only forward: {fresh:?}");
        let counts = receiver.counts();
        let all = counts.fresh + counts.repeated + counts.old;
        assert_eq!(all, order.len() as u64);
        // All have come, so each counter that was passed over came later as an old one.
        assert!(counts.lost <= counts.old);
    });
}

/// All differences of two counters.
#[test]
fn every_distance() {
    for newest in [0u16, 1, 32767, 32768, 65535] {
        for distance in 0..=u16::MAX {
            let mut receiver = Receiver::new();
            assert_eq!(receiver.receive(newest), Arrival::First);
            let arrival = receiver.receive(newest.wrapping_add(distance));
            let expected = match distance {
                0 => Arrival::Repeated,
                1..=32767 => Arrival::Next { lost: distance - 1 },
                32768.. => Arrival::Old,
            };
            assert_eq!(arrival, expected, "{newest} and {distance}");
        }
    }
}

/// Any counter may be the first, 0 included, which is also what is said before it.
#[test]
fn any_first_counter() {
    for first in 0..=u16::MAX {
        let mut receiver = Receiver::new();
        assert_eq!(receiver.newest(), 0);
        assert_eq!(receiver.receive(first), Arrival::First);
        assert_eq!(receiver.newest(), first);
        assert_eq!(receiver.receive(first), Arrival::Repeated);
        let mut sender = Sender::starting_at(first);
        assert_eq!(sender.advance(), first);
        assert_eq!(sender.last(), first);
    }
}

/// A link without faults, three times round.
#[test]
fn nothing_is_lost_on_a_good_link() {
    let mut sender = Sender::default();
    let mut receiver = Receiver::default();
    // 0 says that nothing has come: the first datagram is number 1.
    assert_eq!(sender.advance(), 1);
    assert_eq!(receiver.receive(sender.last()), Arrival::First);
    for _ in 1..3 * 65536 {
        let before = sender.last();
        let counter = sender.advance();
        assert_eq!(counter, if before == 65535 { 0 } else { before + 1 });
        assert_eq!(receiver.receive(counter), Arrival::Next { lost: 0 });
    }
    let fresh = 3 * 65536;
    let expected = Counts {
        fresh,
        ..Counts::default()
    };
    assert_eq!(receiver.counts(), expected);
}

/// A peer that starts again lower looks old until it has caught up or a reset.
#[test]
fn a_restart_needs_a_reset() {
    let mut receiver = Receiver::new();
    receiver.receive(20000);
    for counter in 1..=19999 {
        assert_eq!(receiver.receive(counter), Arrival::Old);
    }
    assert_eq!(receiver.receive(20000), Arrival::Repeated);
    let before = receiver.counts();
    receiver.reset();
    assert_eq!(receiver.counts(), before, "the counts stay");
    assert_eq!(receiver.receive(7), Arrival::First);
    assert_eq!(receiver.receive(8), Arrival::Next { lost: 0 });
    assert_eq!(receiver.counts().lost, 0, "no gap across a reset");
}
