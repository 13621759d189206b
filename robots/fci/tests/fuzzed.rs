//! What cargo-fuzz drives, with random bytes and with good messages among them: without nightly the
//! machines get at least these.

#[path = "../fuzz/machines/client.rs"]
mod client;
#[path = "data/mod.rs"]
mod data;
#[path = "../fuzz/machines/robot.rs"]
mod robot;

use std::panic::catch_unwind;

use fci::stream::REQUEST_LEN_MAX;
use fci::{Command, Move, Request, Version, command};
use hostile::Random;

const CASES: u32 = 20_000;

/// What waits is on its way.
const TRANSMITTED: u8 = 47;

/// A piece of the stream, as a client is told of it.
fn reply(bytes: &mut Vec<u8>, message: &[u8]) {
    let message = &message[..message.len().min(255)];
    bytes.extend([TRANSMITTED, 0, message.len() as u8]);
    bytes.extend(message);
}

/// A piece of the stream or a datagram, as a robot is told of it: in words, and a byte more.
fn piece(bytes: &mut Vec<u8>, what: u8, message: &[u8]) {
    let odd = (message.len() % 2) as u8;
    bytes.extend([what | odd << 3, (message.len() / 2) as u8]);
    bytes.extend(message);
}

/// What leads to a motion, and then anything.
fn to_client(random: &mut Random) -> Vec<u8> {
    let version = Version::V10;
    let mut bytes = vec![1];
    let state = |bytes: &mut Vec<u8>, modes: [u8; 3]| {
        bytes.push(3);
        bytes.extend(modes);
        bytes.push(1);
    };
    let names = [
        "Connect",
        "GetRobotModel",
        "SetCollisionBehavior",
        "SetLoad",
        "Move",
    ];
    for (name, id) in names.into_iter().zip(0..) {
        if id == 2 {
            state(&mut bytes, [0, 3, 1]);
            state(&mut bytes, [0, 3, 1]);
        }
        let exchange = data::EXCHANGES.iter().find(|it| it.name == name);
        let exchange = exchange.expect("in the list");
        let code = exchange.code(version).expect("of this version");
        let payload = data::reply(exchange, u8::from(name == "Move"), 0);
        reply(&mut bytes, &data::message(code, id, &payload));
    }
    for _ in 0..3 {
        state(&mut bytes, [5, 2, 2]);
    }
    for _ in 0..random.below(20) {
        match random.below(3) {
            0 => state(&mut bytes, [0; 3].map(|_: u8| random.below(6) as u8)),
            1 => bytes.push(random.byte() | 7),
            _ => {
                let exchange = &data::EXCHANGES[random.below(data::EXCHANGES.len())];
                let code = exchange.code(version).unwrap_or(99);
                let payload = data::reply(exchange, random.below(4) as u8, 0);
                reply(
                    &mut bytes,
                    &data::message(code, random.below(6) as u32, &payload),
                );
            }
        }
    }
    bytes
}

/// The same for a robot.
fn to_robot(random: &mut Random) -> Vec<u8> {
    let first = random.below(Version::ALL.len());
    let version = Version::ALL[first];
    let mut bytes = vec![first as u8];
    let mut room = [0; REQUEST_LEN_MAX];
    let wanted = Request::Move(Move::torque(version));
    let wanted = wanted.emit(version, 1, &mut room).expect("of any version");
    bytes.push(5);
    piece(&mut bytes, 0, wanted);
    // Replies, a state that shows the motion.
    bytes.extend([0xFC, 0xFC, 5]);
    for id in 2..6 + random.below(20) as u64 {
        let torque = [0.02 * random.below(52) as f64; 7];
        let command = Command::torque(version, id, torque, random.below(20) == 0);
        let mut room = [0; command::LEN_MAX];
        piece(&mut bytes, 3, command.emit(version, &mut room));
        match random.below(8) {
            0 => bytes.push(random.byte() | 7),
            1 => {
                let exchange = &data::EXCHANGES[random.below(data::EXCHANGES.len())];
                let code = exchange.code(version).unwrap_or(99);
                let mut message = data::message(code, 7, &data::request(exchange, version));
                if random.below(2) == 0 {
                    random.flip(&mut message);
                }
                piece(&mut bytes, 0, &message);
            }
            _ => {}
        }
        bytes.push(5);
    }
    bytes
}

/// A share of the cases has to come to a motion: without it little is shown.
fn drive(seed: u64, good: fn(&mut Random) -> Vec<u8>, machine: fn(&[u8]) -> bool) {
    let mut random = Random::new(seed, 0);
    let mut moved = 0;
    for case in 0..CASES {
        let mut bytes = match random.below(4) {
            0 => (0..random.below(400)).map(|_| random.byte()).collect(),
            _ => good(&mut random),
        };
        if random.below(4) == 0 {
            random.set(&mut bytes);
        }
        let outcome = catch_unwind(|| machine(&bytes));
        assert!(outcome.is_ok(), "case {case}: {bytes:02x?}");
        moved += u32::from(outcome.is_ok_and(|moved| moved));
    }
    assert!(moved > CASES / 4, "{moved} of {CASES} moved");
}

#[test]
fn a_client_bears_anything_in_any_order() {
    drive(1, to_client, client::client);
}

#[test]
fn a_robot_bears_anything_in_any_order() {
    drive(2, to_robot, robot::robot);
}
