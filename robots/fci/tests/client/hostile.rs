//! Streams of bytes that no robot sends: nothing that nobody has asked for has an effect, and what
//! is broken ends the conversation.

use std::mem::size_of;

use fci::client::{Client, Duty, Event, MODEL_LEN_MAX, ModelSink, Phase};
use fci::{Kind, Version};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use crate::scripted::{Host, Robot, START};

/// Conversations per test.
const CASES: u64 = 100_000;

fn below(random: &mut ChaCha8Rng, n: u32) -> u32 {
    ((u64::from(random.next_u32()) * u64::from(n)) >> 32) as u32
}

/// A message with code, id, payload.
fn message(code: u32, id: u32, payload: &[u8]) -> Vec<u8> {
    let size = 12 + payload.len() as u32;
    let mut bytes: Vec<u8> = [code, id, size]
        .iter()
        .flat_map(|it| it.to_le_bytes())
        .collect();
    bytes.extend(payload);
    bytes
}

/// A well-formed message that answers nothing: ids are counted from 0, and a conversation has
/// less than 8 of them.
fn stray(random: &mut ChaCha8Rng) -> Vec<u8> {
    let code = below(random, 16);
    let id = match below(random, 3) {
        0 => 8 + below(random, 100),
        1 => u32::MAX - below(random, 100),
        _ => 8 + below(random, u32::MAX - 8),
    };
    let payload: Vec<u8> = (0..below(random, 200))
        .map(|_| random.next_u32() as u8)
        .collect();
    message(code, id, &payload)
}

/// Takes pieces in the middle of which strays may stand.
fn feed(client: &mut Client, host: &mut Host, bytes: &[u8], random: &mut ChaCha8Rng) {
    let mut rest = bytes;
    while !rest.is_empty() {
        let count = (1 + below(random, 40) as usize).min(rest.len());
        client.receive(&rest[..count], host);
        rest = &rest[count..];
    }
}

/// Brings a conversation to a place: so many cycles, started when ready.
fn until(cycles: u32, version: Version) -> (Client, Host, Robot) {
    let (mut client, mut host) = (Client::new(true), Host::default());
    let mut robot = Robot::new(version);
    client.connected(1);
    for _ in 0..cycles {
        host.cycle(&mut client, &mut robot);
        client.start(&START);
    }
    (client, host, robot)
}

/// Two conversations, one with strays in every pause: not a byte of what is sent, not a duty
/// differs.
#[test]
fn replies_that_nobody_asked_for_move_no_byte() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut strays = 0;
    let mut seen = std::collections::BTreeSet::new();
    while strays < CASES {
        let version = Version::ALL[below(&mut random, 6) as usize];
        let cycles = 3 + below(&mut random, 40);
        let run = |random: Option<&mut ChaCha8Rng>| {
            let (mut client, mut host) = (Client::new(true), Host::default());
            let mut robot = Robot::new(version);
            let mut random = random;
            let mut count = 0;
            client.connected(1);
            for cycle in 0..cycles {
                if let Some(random) = &mut random {
                    for _ in 0..below(random, 8) {
                        let bytes = stray(random);
                        feed(&mut client, &mut host, &bytes, random);
                        count += 1;
                    }
                }
                host.cycle(&mut client, &mut robot);
                client.start(&START);
                if cycle + 12 == cycles {
                    client.finish();
                }
            }
            (client, host, count)
        };
        let (quiet, told, _) = run(None);
        let (loud, heard, count) = run(Some(&mut random));
        assert_eq!(loud.phase(), quiet.phase());
        assert_eq!((&heard.sent, &heard.duties), (&told.sent, &told.duties));
        assert_eq!(heard.urdf, told.urdf);
        let ignored = u64::from(loud.strays());
        // What comes behind an end, or between two connections, is not even looked at.
        let all_heard = loud.stopped().is_none() && version == Version::V10;
        assert!(ignored == count || ignored < count && !all_heard);
        seen.insert(format!("{:?}", quiet.phase()));
        strays += count;
    }
    assert!(seen.len() >= 4, "{seen:?}");
}

/// Replies to what was asked, damaged, and bytes of no order at all, at every place of a
/// conversation: it goes on, waits, or ends with a reason; never is a state answered whose motion no reply
/// has started.
#[test]
fn damaged_streams_end_with_a_reason_or_are_ignored() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut ends = std::collections::BTreeMap::<&str, u32>::new();
    let places: Vec<_> = Version::ALL
        .into_iter()
        .flat_map(|version| (0..14).map(move |cycles| until(cycles, version)))
        .map(|(client, _, _)| client)
        .collect();
    for _ in 0..CASES {
        let place = below(&mut random, places.len() as u32) as usize;
        let mut client = places[place].clone();
        let ran = matches!(client.phase(), Phase::Running | Phase::Ending);
        let mut bytes = Vec::new();
        for _ in 0..=below(&mut random, 3) {
            let length = [1, 1, 3, 4, below(&mut random, 300)][below(&mut random, 5) as usize];
            let payload: Vec<u8> = (0..length).map(|_| below(&mut random, 14) as u8).collect();
            bytes.extend(message(
                below(&mut random, 14),
                below(&mut random, 7),
                &payload,
            ));
        }
        for _ in 0..below(&mut random, 4) {
            let bit = below(&mut random, 8 * bytes.len() as u32) as usize;
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
        bytes.truncate(1 + below(&mut random, bytes.len() as u32) as usize);
        let mut host = Host::default();
        feed(&mut client, &mut host, &bytes, &mut random);
        assert!(client.transmit().len() <= 428 + 12 && host.urdf.len() <= bytes.len());
        let end = match client.stopped() {
            Some(stop) => {
                assert!(!stop.to_string().is_empty() && client.transmit().is_empty());
                stop.cause.event().name()
            }
            None if client.wants_new_connection() => "other version",
            None => "goes on",
        };
        *ends.entry(end).or_default() += 1;
        // An idle state: no answer, whatever was said.
        let facts = fci::client::Facts {
            message_id: u64::MAX,
            robot_mode: fci::RobotMode::Idle,
            ..Default::default()
        };
        let duty = client.state(&facts);
        assert!(duty == Duty::Listen, "{ran} {duty:?}");
    }
    for event in [Event::Protocol, Event::Refused, Event::Version] {
        assert!(ends.contains_key(event.name()), "{ends:?}");
    }
    assert!(
        ends.contains_key("goes on") && ends.contains_key("other version"),
        "{ends:?}"
    );
}

/// A stream without an end of a message keeps no more than a few bytes of it.
#[test]
fn memory_is_bounded() {
    assert!(size_of::<Client>() < 2048, "{}", size_of::<Client>());

    struct Count(usize);
    impl ModelSink for Count {
        fn piece(&mut self, urdf: &[u8]) {
            self.0 += urdf.len();
        }
    }
    let (mut client, _, _) = until(0, Version::V10);
    let code = |kind: Kind| kind.code(Version::V10).expect("a code");
    client.receive(&message(code(Kind::Connect), 0, &[0, 10, 0]), &mut ());
    assert_eq!(client.phase(), Phase::Reading);
    // The longest model there may be, and then one byte more.
    for (more, fine) in [(0, true), (1, false)] {
        let (mut client, mut count) = (client.clone(), Count(0));
        let size = 13 + MODEL_LEN_MAX as u32 + more;
        let header = [code(Kind::GetRobotModel), 1, size];
        let header: Vec<u8> = header.iter().flat_map(|it| it.to_le_bytes()).collect();
        client.receive(&header, &mut count);
        client.receive(&[0], &mut count);
        for _ in 0..MODEL_LEN_MAX / 4096 {
            client.receive(&[b'x'; 4096], &mut count);
        }
        assert_eq!(client.stopped().is_none(), fine);
        assert_eq!(count.0, if fine { MODEL_LEN_MAX } else { 0 });
    }
    // Nobody reads on behind an end.
    client.receive(&message(99, 1, &[0]), &mut ());
    assert_eq!((client.strays(), client.phase()), (1, Phase::Reading));
    client.closed();
    let stop = client.stopped();
    client.receive(&message(code(Kind::GetRobotModel), 1, &[0; 64]), &mut ());
    assert_eq!((client.strays(), client.stopped()), (1, stop));
}
