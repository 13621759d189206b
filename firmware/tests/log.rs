//! The log holds every bit, and the replay finds the one that differs.

use controller_core::Measurement;
use firmware::log::{CYCLE_BYTES, Entry, HEADER_BYTES, Header, NUMBERS, Number, replay};
use firmware::recording::{Met, write_run};
use firmware::scenario::{FixedScenario, ReadyScenario};

const CYCLES: u16 = 300;

#[test]
fn headers_and_entries_come_back() {
    for (scenario, bytes) in [(FixedScenario::TwoLevel, 8), (FixedScenario::Case1, 4)] {
        let header = Header {
            scenario,
            bytes,
            cycles: 0xabcd,
        };
        assert_eq!(Header::decode(header.encode()), Some(header));
    }
    assert_eq!(Header::decode(*b"STRM\x07\x08\x01\x00"), None);
    assert_eq!(Header::decode(*b"STRM\x00\x05\x01\x00"), None);
    assert_eq!(Header::decode(*b"strm\x00\x08\x01\x00"), None);

    fn entry<T: Number>() {
        let number = |i: usize| T::from_f64(1.0 / (i as f64 + 3.0));
        let entry = Entry {
            measurement: Measurement {
                q: std::array::from_fn(number).into(),
                dq: std::array::from_fn(|i| -number(i + 7)).into(),
                interval_s: number(14),
            },
            torque: std::array::from_fn(|i| number(i + 15)).into(),
        };
        let bytes = entry.encode();
        assert_eq!(Entry::decode(&bytes), entry);
        assert!(bytes[NUMBERS * T::BYTES..].iter().all(|&byte| byte == 0));
    }
    entry::<f64>();
    entry::<f32>();
}

fn recorded<T: Number>(scenario: FixedScenario) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_run::<T>(&mut bytes, scenario, CYCLES, &mut Met::default()).expect("a clean run");
    assert_eq!(
        bytes.len(),
        HEADER_BYTES + usize::from(CYCLES) * NUMBERS * T::BYTES
    );
    bytes
}

fn entries<T: Number>(bytes: &[u8]) -> impl FnMut() -> Option<[u8; CYCLE_BYTES]> + '_ {
    let mut slots = bytes[HEADER_BYTES..].chunks_exact(NUMBERS * T::BYTES);
    move || {
        let mut entry = [0; CYCLE_BYTES];
        entry[..NUMBERS * T::BYTES].copy_from_slice(slots.next()?);
        Some(entry)
    }
}

fn replays<T: Number>(scenario: FixedScenario) {
    let ready = ReadyScenario::<T>::new(scenario).expect("a valid scenario");
    let mut bytes = recorded::<T>(scenario);
    let same = replay(&ready, CYCLES, entries::<T>(&bytes));
    assert_eq!((same.cycles, same.bits, same.faults), (CYCLES, 0, 0));

    // Two bits of the torque of joint 3 in cycle 200.
    let number = 200 * NUMBERS + 15 + 2;
    bytes[HEADER_BYTES + number * T::BYTES] ^= 0b101;
    let damaged = replay(&ready, CYCLES, entries::<T>(&bytes));
    assert_eq!(damaged.bits, 2);
    let first = damaged.first.expect("a difference");
    assert_eq!((first.cycle, first.joint), (200, 3));
    assert_eq!(first.expected ^ first.found, 0b101);

    // A file that ends early is noticed by its cycles.
    let half = bytes.len() / 2;
    assert!(replay(&ready, CYCLES, entries::<T>(&bytes[..half])).cycles < CYCLES);
}

#[test]
fn a_replay_finds_exactly_what_differs() {
    for scenario in FixedScenario::ALL {
        replays::<f64>(scenario);
        replays::<f32>(scenario);
    }
}
