//! Hostile datagrams and streams, all from one seed: what is refused changes no byte of what the
//! robot says and does, and nothing that it keeps grows.
//!
//! Beside the robot runs a twin that gets none of it. What has to be refused is decided here from
//! offsets written down again, without the codec.

use std::collections::BTreeMap;

use fci::robot::{Arm, Drive, Operator, Received, Robot};
use fci::stream::REQUEST_LEN_MAX;
use fci::{Command, Move, Reply, Request, StatePacket, Stream, Version, command, state};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use crate::bench::{Bench, rest, settings};

const CASES: u32 = 100_000;

struct Random(ChaCha8Rng);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.0.next_u32()) * n as u64) >> 32) as usize
    }

    /// Flips bits, sets bytes, cuts, fills up, or is noise.
    fn damage(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(3) {
            match self.below(6) {
                0 => bytes.truncate(self.below(bytes.len() + 1)),
                1 => {
                    let fill = self.0.next_u32() as u8;
                    bytes.resize(bytes.len() + self.below(40), fill);
                }
                2 => {
                    for byte in bytes.iter_mut() {
                        *byte = self.0.next_u32() as u8;
                    }
                }
                _ if bytes.is_empty() => {}
                3 => {
                    let bit = self.below(8 * bytes.len());
                    bytes[bit / 8] ^= 1 << (bit % 8);
                }
                4 => {
                    let at = self.below(bytes.len());
                    bytes[at] = [0, 1, 2, 0x7F, 0x80, 0xFF][self.below(6)];
                }
                _ => {
                    // A number that is none, where a real may be.
                    let at = self.below(bytes.len());
                    let none = [f64::NAN, f64::INFINITY, f64::MAX, -0.0][self.below(4)];
                    for (place, byte) in bytes[at..].iter_mut().zip(none.to_le_bytes()) {
                        *place = byte;
                    }
                }
            }
        }
    }
}

/// One cycle of both: their states are equal, byte by byte, and so is what the arm does.
fn equal_cycle(
    robot: &mut Robot<&'static [u8]>,
    twin: &mut Robot<&'static [u8]>,
    arm: &Arm,
) -> (bool, Drive) {
    let version = robot.version();
    let ([mut one, mut other], operator) = ([[0; state::LEN_MAX]; 2], Operator::ABSENT);
    let drives = (robot.advance(), twin.advance());
    let state = robot.state(arm, &operator);
    let state = state.emit(version, &mut one).expect("modes of the version");
    StatePacket::new_checked(version, state).expect("a state");
    let twins = twin.state(arm, &operator);
    let twins = twins
        .emit(version, &mut other)
        .expect("modes of the version");
    (state == twins && drives.0 == drives.1, drives.0)
}

/// Whether a datagram is a command to this state, by offsets.
fn is_command(version: Version, message_id: u64, bytes: &[u8]) -> bool {
    let long = version >= Version::V7;
    if bytes.len() != 370 + usize::from(long) || bytes[..8] != message_id.to_le_bytes() {
        return false;
    }
    let real = |at: usize| f64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes"));
    let finite = |from: usize, count: usize| (0..count).all(|i| real(from + 8 * i).is_finite());
    bytes[312] <= 1
        && bytes[313] <= 1
        && (!long || bytes[370] <= 1)
        && finite(8, 38)
        && finite(314, 7)
}

#[test]
fn datagrams_that_are_refused_change_no_byte() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(1337));
    let mut counts = BTreeMap::<&str, u32>::new();
    for version in [Version::V5, Version::V10] {
        let (bench, _) = Bench::running(version);
        let (start, arm) = (bench.robot, rest());
        let (mut robot, mut twin) = (start.clone(), start.clone());
        let mut message_id = bench.state.message_id;
        for case in 0..CASES / 2 {
            let mut room = [0; command::LEN_MAX];
            let id = message_id
                .wrapping_add(random.below(3) as u64)
                .wrapping_sub(1);
            let torque = [0.001 * random.below(700) as f64; 7];
            let finished = random.below(8) == 0;
            let command = Command::torque(version, id, torque, finished);
            let mut bytes = command.emit(version, &mut room).to_vec();
            random.damage(&mut bytes);
            let received = robot.command(&bytes);
            let taken = is_command(version, message_id, &bytes);
            let kind = match received {
                Received::Accepted | Received::Last => "taken",
                Received::Reflex(_) => "reflex",
                Received::Late => "late",
                Received::Unreadable(_) => "unreadable",
                Received::Repeated | Received::NoMotion => "unexpected",
            };
            *counts.entry(kind).or_default() += 1;
            let acts = matches!(kind, "taken" | "reflex");
            assert_eq!(
                taken, acts,
                "case {case}: {received:?}; bytes: {bytes:02x?}"
            );
            if taken {
                // It does what it says; both begin again.
                (robot, twin) = (start.clone(), start.clone());
                message_id = bench.state.message_id;
                continue;
            }
            // Answer both, so that the motion goes on.
            let answer = Command::torque(version, message_id, [0.0; 7], false);
            let answer = answer.emit(version, &mut room);
            assert_eq!(robot.command(answer), Received::Accepted, "case {case}");
            assert_eq!(twin.command(answer), Received::Accepted);
            let (equal, drive) = equal_cycle(&mut robot, &mut twin, &arm);
            assert!(equal, "case {case}: {received:?}; bytes: {bytes:02x?}");
            assert_eq!(drive, Drive::Torque([0.0; 7]));
            message_id += 1;
        }
    }
    let at_least = |kind, count| counts.get(kind).copied().unwrap_or_default() >= count;
    for (kind, count) in [
        ("taken", 500),
        ("reflex", 100),
        ("late", 5000),
        ("unreadable", 20_000),
    ] {
        assert!(at_least(kind, count), "{kind}: {counts:?}");
    }
    assert!(!counts.contains_key("unexpected"), "{counts:?}");
}

/// Requests of the version, one behind the other, with some damage.
fn stream(random: &mut Random, bench: &mut Bench) -> Vec<u8> {
    let version = bench.version();
    let mut bytes = Vec::new();
    for _ in 0..=random.below(3) {
        let request = match random.below(8) {
            0 => Request::Move(Move::torque(version)),
            1 => Request::StopMove,
            2 => Request::AutomaticErrorRecovery,
            3 => Request::SetNeToEe(fci::robot::IDENTITY),
            4 => Request::SetJointImpedance([1e3; 7]),
            5 if version >= Version::V8 => Request::GetRobotModel,
            5 => Request::GetCartesianLimit { limit: 0 },
            6 => Request::SetLoad(fci::request::Load {
                m_load: 1.0,
                f_x_cload: [0.0; 3],
                i_load: [0.0; 9],
            }),
            _ => Request::SetCartesianImpedance([100.0; 6]),
        };
        let mut one = bench.bytes(&request);
        if random.below(3) > 0 {
            random.damage(&mut one);
        }
        bytes.extend(one);
    }
    bytes
}

/// What comes back are whole replies, at most as many as there were requests and motions to end.
fn replies(robot: &mut Robot<&'static [u8]>) -> usize {
    let (mut all, mut room) = (Vec::new(), [0; 61]);
    loop {
        let count = robot.replies(&mut room);
        if count == 0 {
            break;
        }
        all.extend(&room[..count]);
    }
    let mut stream = Stream::new(vec![0; 1024], 1024).expect("room");
    let (mut rest, mut count) = (&all[..], 0);
    while let Some(message) = stream.next(&mut rest).expect("sizes") {
        Reply::parse(robot.version(), &message).expect("a reply");
        count += 1;
    }
    assert!(rest.is_empty() && count <= 8);
    count
}

#[test]
fn streams_that_are_refused_change_no_byte() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(7331));
    let mut counts = BTreeMap::<&str, u32>::new();
    // The model is the caller's; everything else is in here.
    let size = size_of::<Robot<&[u8]>>();
    assert!(size < 8 * 1024, "{size} bytes");
    for version in [Version::V5, Version::V10] {
        let (mut running, _) = Bench::running(version);
        let mut idle = Bench::new(version);
        let mut silent = Bench::silent(settings(version));
        silent.cycle();
        for case in 0..CASES / 2 {
            let bench = match random.below(4) {
                0 => &mut idle,
                1 => &mut silent,
                _ => &mut running,
            };
            let bytes = stream(&mut random, bench);
            let (mut robot, mut twin) = (bench.robot.clone(), bench.robot.clone());
            // In pieces, until the robot wants no more.
            let (mut left, mut changed, mut asked) = (&bytes[..], false, 0);
            let broken = loop {
                let piece = left.len().min(1 + random.below(REQUEST_LEN_MAX));
                let (mut now, later) = left.split_at(piece);
                let outcome = robot.receive(&mut now);
                let taken = piece - now.len();
                left = &left[taken..];
                match outcome {
                    Err(_) => break true,
                    Ok(Some(handled)) => {
                        asked += 1;
                        changed |= handled.refused.is_none();
                        assert!(handled.request.is_some() || handled.refused.is_some());
                    }
                    Ok(None) if left.is_empty() => break false,
                    // More bytes are wanted, or replies have to go out first.
                    Ok(None) => {
                        assert!((taken > 0 && later.len() == left.len()) || replies(&mut robot) > 0)
                    }
                }
            };
            let kind = match (broken, changed, asked > 0) {
                (true, ..) => "broken",
                (_, true, _) => "done",
                (_, _, true) => "refused",
                _ => "partial",
            };
            *counts.entry(kind).or_default() += 1;
            if broken {
                let again = robot.clone().receive(&mut &bytes[..]);
                assert_eq!(again, robot.receive(&mut &[][..]));
                assert!(again.is_err());
            }
            replies(&mut robot);
            let (equal, _) = equal_cycle(&mut robot, &mut twin, &rest());
            assert!(equal || changed, "case {case}: bytes {bytes:02x?}");
            replies(&mut robot);
            // A new connection finds a robot that serves.
            robot.disconnect();
            let (number, udp_port) = (version.number(), 1);
            let connect = Request::Connect(fci::Connect {
                version: number,
                udp_port,
            });
            let bytes = idle.bytes(&connect);
            let handled = robot.receive(&mut &bytes[..]).expect("a new connection");
            assert_eq!(handled.and_then(|it| it.refused), None);
        }
    }
    for (kind, count) in [
        ("broken", 20_000),
        ("done", 5000),
        ("refused", 5000),
        ("partial", 500),
    ] {
        let found = counts.get(kind).copied().unwrap_or_default();
        assert!(found >= count, "{kind}: {counts:?}");
    }
}
