//! A client of a few lines: what it says, and what it makes of a state.

use fci::request::CollisionBehavior;
use fci::stream::REQUEST_LEN_MAX;
use fci::{Command, Connect, Move, Request, State, Version, command};

pub fn bytes(version: Version, id: u32, request: &Request) -> Vec<u8> {
    let mut room = [0; REQUEST_LEN_MAX];
    let bytes = request.emit(version, id, &mut room);
    bytes.expect("a request of the version").to_vec()
}

pub fn connect(version: Version, udp_port: u16) -> Request {
    Request::Connect(Connect {
        version: version.number(),
        udp_port,
    })
}

pub fn motion(version: Version) -> Request {
    Request::Move(Move::torque(version))
}

/// The same thresholds everywhere \[Nm\], \[N\].
pub fn thresholds(torque: f64, force: f64) -> Request {
    let (torque, force) = ([torque; 7], [force; 6]);
    Request::SetCollisionBehavior(CollisionBehavior {
        lower_torque_acceleration: torque,
        upper_torque_acceleration: torque,
        lower_torque_nominal: torque,
        upper_torque_nominal: torque,
        lower_force_acceleration: force,
        upper_force_acceleration: force,
        lower_force_nominal: force,
        upper_force_nominal: force,
    })
}

pub fn command(version: Version, state: &State, torque: [f64; 7], last: bool) -> Vec<u8> {
    let mut room = [0; command::LEN_MAX];
    let command = Command::torque(version, state.message_id, torque, last);
    command.emit(version, &mut room).to_vec()
}

/// Springs and dampers that bring the arm to a posture, within the step that the robot allows.
pub fn springs(state: &State, posture: &[f64; 7]) -> [f64; 7] {
    let stiffness = [100.0, 100.0, 100.0, 100.0, 30.0, 30.0, 1.0];
    std::array::from_fn(|i| {
        let k = stiffness[i];
        let wish = k * (posture[i] - state.q[i]) - 0.1 * k * state.dq[i];
        let acted = state.tau_j_d[i];
        acted + (wish - acted).clamp(-0.9, 0.9)
    })
}
