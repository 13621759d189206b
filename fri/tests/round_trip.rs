//! Values through bytes and bytes through values, and everything a check refuses.
//! 2000 cases of each property from a fixed seed.

mod data;
#[path = "round_trip/values.rs"]
mod values;

use fri::{Command, CommandPacket, Error, Measurement, MeasurementPacket, command, measurement};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use values::{any_command, any_measurement, codes, make_finite};

const CASES: u32 = 2000;

/// Fields with reals, in the order of the wire: name, offset, count.
type Reals = &'static [(&'static str, usize, usize)];

const MEASUREMENT_REALS: Reals = &[
    ("user data real", 8, 16),
    ("timestamp", 140, 1),
    ("periods and safety limits", 148, 3),
    ("statistics", 160, 4),
    ("temperature", 188, 7),
    ("measured joint position", 216, 7),
    ("measured frame", 244, 12),
    ("commanded joint position", 292, 7),
    ("joint position offset", 320, 7),
    ("commanded frame", 348, 12),
    ("frame offset", 396, 12),
    ("joint torque", 444, 7),
    ("external joint torque", 472, 7),
    ("external wrench", 500, 6),
    ("jacobian", 524, 42),
    ("mass matrix", 692, 49),
    ("gravity", 888, 7),
];

const COMMAND_REALS: Reals = &[
    ("user data real", 8, 16),
    ("joint position", 144, 7),
    ("frame", 172, 12),
    ("added joint torque", 220, 7),
    ("added wrench", 248, 6),
    ("joint stiffness", 272, 7),
    ("joint damping", 300, 7),
    ("cartesian stiffness", 328, 6),
    ("cartesian damping", 352, 6),
];

/// Codes of the measurement: name, offset, largest with a meaning.
const CODES: [(&str, usize, u16); 3] = [
    ("interface state", 144, 2),
    ("quality", 146, 3),
    ("control scheme", 182, 3),
];

/// Offset of the fill.
const FILL: usize = 138;

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

fn check_measurement(bytes: &[u8]) -> Result<(), Error> {
    MeasurementPacket::new_checked(bytes).map(|_| ())
}

fn check_command(bytes: &[u8]) -> Result<(), Error> {
    CommandPacket::new_checked(bytes).map(|_| ())
}

fn put(bytes: &mut [u8], at: usize, value: u16) {
    bytes[at..at + 2].copy_from_slice(&value.to_le_bytes());
}

#[test]
fn measurement_through_bytes() {
    for_all(any_measurement(), |value| {
        let mut bytes = [0xFF; measurement::LEN];
        value.emit(&mut bytes);
        let packet = MeasurementPacket::new_checked(bytes).expect("what can be made can be sent");
        let read = Measurement::parse(&packet);
        assert_eq!(read, value);
        // Equality does not tell the zeros apart, bytes do.
        let mut again = [0; measurement::LEN];
        read.emit(&mut again);
        assert_eq!(again, bytes);
    });
}

#[test]
fn command_through_bytes() {
    for_all(any_command(), |value| {
        let mut bytes = [0xFF; command::LEN];
        value.emit(&mut bytes);
        let packet = CommandPacket::new_checked(bytes).expect("what can be made can be sent");
        let read = Command::parse(&packet);
        assert_eq!(read, value);
        let mut again = [0; command::LEN];
        read.emit(&mut again);
        assert_eq!(again, bytes);
    });
}

/// Any bytes, the fill included, changed no more than the check demands.
fn acceptable<const N: usize>(id: u16, reals: Reals) -> impl Strategy<Value = [u8; N]> {
    prop::collection::vec(any::<u8>(), N).prop_map(move |bytes| {
        let mut bytes: [u8; N] = bytes.try_into().expect("length");
        put(&mut bytes, 4, N as u16);
        put(&mut bytes, 6, id);
        for &(_, at, count) in reals {
            for word in bytes[at..at + 4 * count].as_chunks_mut().0 {
                *word = make_finite(u32::from_le_bytes(*word)).to_le_bytes();
            }
        }
        bytes
    })
}

#[test]
fn measurement_bytes_through_a_value() {
    let strategy = (acceptable(measurement::ID, MEASUREMENT_REALS), codes());
    for_all(strategy, |(mut bytes, (state, quality, control))| {
        put(&mut bytes, 144, state.code());
        put(&mut bytes, 146, quality.code());
        put(&mut bytes, 182, control.code());
        let packet = MeasurementPacket::new_checked(bytes).expect("acceptable");
        let mut again = [0xFF; measurement::LEN];
        Measurement::parse(&packet).emit(&mut again);
        put(&mut bytes, FILL, 0);
        assert_eq!(again, bytes);
    });
}

#[test]
fn command_bytes_through_a_value() {
    for_all(acceptable(command::ID, COMMAND_REALS), |mut bytes| {
        let packet = CommandPacket::new_checked(bytes).expect("acceptable");
        let mut again = [0xFF; command::LEN];
        Command::parse(&packet).emit(&mut again);
        put(&mut bytes, FILL, 0);
        assert_eq!(again, bytes);
    });
}

#[test]
fn any_bytes_get_an_answer() {
    let length = prop_oneof![0..1000usize, Just(measurement::LEN), Just(command::LEN)];
    let bytes = length.prop_flat_map(|n| prop::collection::vec(any::<u8>(), n));
    for_all(bytes, |mut bytes| {
        let _ = (check_measurement(&bytes), check_command(&bytes));
        // Past the header too.
        if bytes.len() >= 8 {
            let (length, id) = (bytes.len() as u16, [measurement::ID, command::ID]);
            put(&mut bytes, 4, length);
            for id in id {
                put(&mut bytes, 6, id);
                let _ = (check_measurement(&bytes), check_command(&bytes));
            }
        }
    });
}

/// Whatever the bytes: of a datagram, of the other one, all zeros, all ones.
#[test]
fn every_other_length_is_refused() {
    let mut contents = [[0; 1000], [0xFF; 1000], [0; 1000], [0; 1000]];
    contents[2][..measurement::LEN].copy_from_slice(&data::measurement());
    contents[3][..command::LEN].copy_from_slice(&data::command());
    for content in &contents {
        for found in 0..=content.len() {
            let bytes = &content[..found];
            for (outcome, expected) in [
                (check_measurement(bytes), measurement::LEN),
                (check_command(bytes), command::LEN),
            ] {
                if found != expected {
                    assert_eq!(outcome, Err(Error::Length { found, expected }));
                } else {
                    assert!(!matches!(outcome, Err(Error::Length { .. })));
                }
            }
        }
    }
}

/// A check under test, a datagram that passes it, its id.
type Checked = (fn(&[u8]) -> Result<(), Error>, Vec<u8>, u16, Reals);

fn both() -> [Checked; 2] {
    let (m, c) = (data::measurement().to_vec(), data::command().to_vec());
    [
        (check_measurement, m, measurement::ID, MEASUREMENT_REALS),
        (check_command, c, command::ID, COMMAND_REALS),
    ]
}

#[test]
fn every_other_id_and_size_is_refused() {
    for (check, valid, id, _) in both() {
        let size = valid.len() as u16;
        for found in 0..=u16::MAX {
            let mut bytes = valid.clone();
            put(&mut bytes, 6, found);
            let expected = id;
            let error = Error::Id { found, expected };
            assert_eq!(check(&bytes), if found == id { Ok(()) } else { Err(error) });

            let mut bytes = valid.clone();
            put(&mut bytes, 4, found);
            let expected = size;
            let error = Error::Size { found, expected };
            assert_eq!(
                check(&bytes),
                if found == size { Ok(()) } else { Err(error) }
            );
        }
    }
}

#[test]
fn every_real_must_be_finite() {
    // Infinities, a quiet NaN, the smallest signalling one, all ones.
    let bad = [
        0x7F80_0000u32,
        0xFF80_0000,
        0x7FC0_0000,
        0x7F80_0001,
        u32::MAX,
    ];
    // The finite numbers next to them.
    let good = [f32::MAX.to_bits(), f32::MIN.to_bits(), 1, 0x8000_0000];
    for (check, valid, _, reals) in both() {
        for &(field, at, count) in reals {
            for index in 0..count {
                let place = at + 4 * index..at + 4 * index + 4;
                let mut bytes = valid.clone();
                for bits in bad {
                    bytes[place.clone()].copy_from_slice(&bits.to_le_bytes());
                    assert_eq!(check(&bytes), Err(Error::NotFinite { field, index }));
                }
                for bits in good {
                    bytes[place.clone()].copy_from_slice(&bits.to_le_bytes());
                    assert_eq!(check(&bytes), Ok(()));
                }
            }
        }
    }
}

/// The bytes that are no reals may have any value, codes and header apart.
#[test]
fn integers_may_be_anything() {
    for (check, valid, _, reals) in both() {
        let mut bytes = vec![0xFF; valid.len()];
        bytes[4..8].copy_from_slice(&valid[4..8]);
        for &(_, at, count) in reals {
            bytes[at..at + 4 * count].fill(0);
        }
        // 65535 is a code, too: invalid.
        assert_eq!(check(&bytes), Ok(()));
    }
}

#[test]
fn every_code() {
    for (field, at, max) in CODES {
        for found in 0..=u16::MAX {
            let mut bytes = data::measurement();
            put(&mut bytes, at, found);
            let outcome = check_measurement(&bytes);
            if found <= max || found == 0xFFFF {
                assert_eq!(outcome, Ok(()));
                let packet = MeasurementPacket::new_checked(bytes).expect("checked");
                let read = match at {
                    144 => packet.state().code(),
                    146 => packet.quality().code(),
                    _ => packet.control().code(),
                };
                assert_eq!(read, found);
            } else {
                assert_eq!(outcome, Err(Error::Code { field, found, max }));
            }
        }
    }
}

/// Everything is wrong; one thing after the other is put right.
#[test]
fn the_first_thing_wrong_is_named() {
    let valid = data::measurement();
    let mut bytes = [0xFE; measurement::LEN + 1];
    bytes[216..].fill(0xFF);
    let names = |bytes: &[u8]| check_measurement(bytes).map_err(|error| error.to_string());
    let says = |text: &str| Err(text.to_string());
    assert_eq!(names(&bytes), says("length: 917 bytes; allowed: 916"));
    let bytes = &mut bytes[..measurement::LEN];
    assert_eq!(names(bytes), says("id: 0xfefe; allowed: 0x2006"));
    bytes[6..8].copy_from_slice(&valid[6..8]);
    assert_eq!(names(bytes), says("size field: 65278; allowed: 916"));
    bytes[4..6].copy_from_slice(&valid[4..6]);
    for (at, text) in [
        (144, "interface state: 65278; allowed: 0 to 2, 65535"),
        (146, "quality: 65278; allowed: 0 to 3, 65535"),
        (182, "control scheme: 65278; allowed: 0 to 3, 65535"),
    ] {
        assert_eq!(names(bytes), says(text));
        put(bytes, at, 0);
    }
    // Large, but finite before offset 216.
    for &(field, at, count) in MEASUREMENT_REALS.iter().filter(|(_, at, _)| *at >= 216) {
        let text = format!("{field}[0]: not finite; allowed: finite numbers");
        assert_eq!(names(bytes), says(&text));
        bytes[at..at + 4 * count].fill(0);
    }
    assert_eq!(names(bytes), Ok(()));
}
