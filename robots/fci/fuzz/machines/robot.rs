//! Any bytes as what a robot is told, in any order.

use fci::robot::{Arm, Drive, IDENTITY, Limits, Operator, Robot, Settings};
use fci::stream::REQUEST_LEN_MAX;
use fci::{Connect, Request, Version, state};

const READY: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

/// Largest change of a torque in a cycle \[Nm\], and how far it may be rounded.
const STEP_MAX_NM: f64 = 1.0 + 1e-9;

/// Tells a robot what the bytes say: the first one its version, then a byte for what happens and
/// what it needs. Whether a torque acted.
///
/// # Panics
/// A state cannot be sent, a torque makes a step that the robot does not take, or a connection that
/// is broken takes more.
pub fn robot(bytes: &[u8]) -> bool {
    let Some((&version, mut bytes)) = bytes.split_first() else {
        return false;
    };
    let version = Version::ALL[usize::from(version) % Version::ALL.len()];
    let limits = Limits::FR3;
    let mut robot = Robot::new(Settings::new(version, limits), &b"<robot/>"[..]);
    connect(&mut robot);
    let mut arm = Arm {
        q: READY,
        dq: [0.0; 7],
        tau_j: [0.0; 7],
        tau_ext: [0.0; 7],
        wrench: [0.0; 6],
        o_t_f: IDENTITY,
        twist: [0.0; 6],
        theta: READY,
        dtheta: [0.0; 7],
    };
    let (mut operator, mut torque, mut acted) = (Operator::ABSENT, [0.0; 7], false);
    while let Some((&what, rest)) = bytes.split_first() {
        bytes = rest;
        match what % 8 {
            // A piece of the stream, or a datagram.
            0..=3 => {
                let Some((&length, rest)) = bytes.split_first() else {
                    return acted;
                };
                // As long as a command may be.
                let length = 2 * usize::from(length) + usize::from(what / 8 % 2);
                let (mut piece, rest) = rest.split_at(length.min(rest.len()));
                bytes = rest;
                if what % 8 == 3 {
                    robot.command(piece);
                    continue;
                }
                while let Ok(Some(_)) = robot.receive(&mut piece) {}
            }
            // Replies go out, in pieces.
            4 => {
                let mut room = [0; 64];
                let room = &mut room[..1 + usize::from(what / 8)];
                assert!(robot.replies(room) <= room.len());
            }
            // A cycle.
            5 | 6 => {
                let mut room = [0; state::LEN_MAX];
                let sent = robot.state(&arm, &operator).emit(version, &mut room);
                assert_eq!(sent.map(<[u8]>::len), Ok(version.state_len()));
                let last = torque;
                torque = match robot.advance() {
                    Drive::Torque(torque) => torque,
                    Drive::Hold | Drive::Follow(_) => [0.0; 7],
                };
                let moves = torque != [0.0; 7];
                acted |= moves;
                for (now, last) in torque.iter().zip(last) {
                    assert!(!moves || (now - last).abs() <= STEP_MAX_NM, "{now} {last}");
                }
            }
            _ => match what / 8 % 4 {
                0 => operator.user_stop = !operator.user_stop,
                1 => operator.ready = !operator.ready,
                2 => arm.q[3] = -2.856 - arm.q[3],
                _ => connect(&mut robot),
            },
        }
    }
    acted
}

/// Another connection, by a client of the same version.
fn connect(robot: &mut Robot<&[u8]>) {
    robot.disconnect();
    let (version, mut room) = (robot.version(), [0; REQUEST_LEN_MAX]);
    let request = Request::Connect(Connect {
        version: version.number(),
        udp_port: 1,
    });
    if let Ok(mut bytes) = request.emit(version, 0, &mut room) {
        let handled = robot.receive(&mut bytes);
        assert!(matches!(handled, Ok(Some(handled)) if handled.refused.is_none()));
    }
}
