//! Any bytes as what a client hears, in any order.

use fci::client::{Client, Duty, Facts, Phase, Start};
use fci::stream::{HEADER_LEN, REQUEST_LEN_MAX};
use fci::{ControllerMode, RobotMode, StatePacket, Version, state};

/// Tells a client what the bytes say: the first one whether it may recover, then a byte for what
/// happens and what it needs. The host
/// starts as soon as it can. Whether a state was answered.
///
/// # Panics
/// A state is answered that shows no motion, more waits for the robot than there is room for, or
/// something is said or done behind an end.
pub fn client(bytes: &[u8]) -> bool {
    let Some((&may_recover, mut bytes)) = bytes.split_first() else {
        return false;
    };
    let mut client = Client::new(may_recover & 1 == 1);
    client.connected(50_000);
    let (mut message_id, mut answered) = (0, false);
    while let Some((&what, rest)) = bytes.split_first() {
        bytes = rest;
        let stopped = client.stopped();
        match what % 8 {
            // A piece of the stream.
            0..=2 => {
                let Some((&length, rest)) = bytes.split_first() else {
                    return answered;
                };
                let (piece, rest) = rest.split_at(usize::from(length).min(rest.len()));
                client.receive(piece, &mut ());
                bytes = rest;
            }
            // A state whose modes these bytes are.
            3..=5 => {
                let Some((modes, rest)) = bytes.split_first_chunk::<4>() else {
                    return answered;
                };
                bytes = rest;
                message_id += u64::from(modes[3]);
                answered |= state(&mut client, message_id, modes);
            }
            6 => client.transmitted(usize::from(what)),
            _ => match what / 8 % 6 {
                0 => client.finish(),
                1 => client.halt(),
                2 => client.closed(),
                3 => client.silent(),
                4 => client.connected(1),
                _ => client.transmitted(usize::MAX),
            },
        }
        if client.phase() == Phase::Ready {
            client.start(&Start::uniform(20.0, 20.0));
        }
        assert!(client.transmit().len() <= REQUEST_LEN_MAX + HEADER_LEN);
        if stopped.is_some() {
            assert!(client.stopped() == stopped && client.transmit().is_empty());
        }
    }
    answered
}

/// A state with these modes, as far as they mean something: whether it is answered.
fn state(
    client: &mut Client,
    message_id: u64,
    &[generator, controller, robot, _]: &[u8; 4],
) -> bool {
    let version = client.version();
    let mut datagram = [0; state::LEN_MAX];
    let (modes, mode) = match version {
        Version::V10 => (1288, 1372),
        _ => (2280, 2364),
    };
    datagram[..8].copy_from_slice(&message_id.to_le_bytes());
    datagram[modes..modes + 2].copy_from_slice(&[generator, controller]);
    datagram[mode] = robot;
    let Some(datagram) = datagram.get(..version.state_len()) else {
        return false;
    };
    let Ok(packet) = StatePacket::new_checked(version, datagram) else {
        return false;
    };
    let answered = client.state(&Facts::of(&packet)) != Duty::Listen;
    if answered {
        let shown = (packet.robot_mode(), packet.controller_mode());
        assert_eq!(shown, (RobotMode::Move, ControllerMode::External));
    }
    answered
}
