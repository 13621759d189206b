//! What is refused, with the words: thing, value, what is allowed.

mod data;

use fci::command::Command;
use fci::request::{Connect, Load, Move, Request};
use fci::sequence::{Arrival, Sequence};
use fci::state::{FIELDS, LEN_MAX, State, StatePacket, field};
use fci::status::{MoveStatus, SetterStatus};
use fci::stream::{REQUEST_LEN_MAX, Stream};
use fci::{
    Controller, Error, Generator, Kind, Message, MotionGeneratorMode, Reply, RobotError,
    RobotErrors, Setter, Version,
};

fn words<T: std::fmt::Debug>(outcome: Result<T, Error>) -> String {
    outcome.expect_err("refused").to_string()
}

fn message(code: u32, payload: &[u8]) -> Message<'_> {
    Message {
        code,
        id: 0,
        payload,
        skipped: 0,
    }
}

#[test]
fn versions() {
    for number in [0, 4, 11, 0xFFFF] {
        let text = format!("version: {number}; allowed: 5 to 10");
        assert_eq!(words(Version::from_number(number)), text);
    }
    for version in Version::ALL {
        assert_eq!(Version::from_number(version.number()), Ok(version));
    }
}

#[test]
fn states() {
    let check = |version, bytes: &[u8]| words(StatePacket::new_checked(version, bytes));
    assert_eq!(
        check(Version::V10, &data::state(Version::V5)),
        "length of state: 2373 bytes; allowed: 1377"
    );
    assert_eq!(
        check(Version::V5, &[]),
        "length of state: 0 bytes; allowed: 2373"
    );
    for (version, layout) in [(Version::V5, data::DOUBLE), (Version::V10, data::SINGLE)] {
        let with = |at: usize, value| {
            let mut bytes = data::state(version);
            bytes[at] = value;
            check(version, &bytes)
        };
        let max = data::generator_mode_max(version);
        assert_eq!(
            with(layout.motion_generator_mode, max + 1),
            format!("motion generator mode: {}; allowed: 0 to {max}", max + 1)
        );
        assert_eq!(
            with(layout.controller_mode, 4),
            "controller mode: 4; allowed: 0 to 3"
        );
        assert_eq!(
            with(layout.robot_mode, 255),
            "robot mode: 255; allowed: 0 to 6"
        );
        assert_eq!(
            with(layout.errors + 40, 2),
            "errors[40]: 2; allowed: 0 and 1"
        );
        assert_eq!(
            with(layout.reflex_reason, 255),
            "reflex_reason[0]: 255; allowed: 0 and 1"
        );
    }
}

/// Of the fields that are used, and of no others.
#[test]
fn numbers_of_a_state() {
    for version in Version::ALL {
        let mut state = State::default();
        state.dq[3] = f64::NAN;
        state.m_ee = f64::INFINITY;
        let mut bytes = [0; LEN_MAX];
        let sent = state.emit(version, &mut bytes).expect("a state");
        let packet = StatePacket::new_checked(version, sent).expect("a state");
        assert_eq!(packet.check_finite(&[field::Q, field::TAU_J]), Ok(()));
        assert_eq!(
            words(packet.check_finite(&[field::Q, field::DQ])),
            "dq[3]: not finite; allowed: finite numbers"
        );
        assert_eq!(
            words(packet.check_finite(&FIELDS)),
            "m_ee[0]: not finite; allowed: finite numbers"
        );
        // Accelerometers are not looked at where there are none.
        assert_eq!(packet.check_finite(&[field::ACCELEROMETER_TOP]), Ok(()));
    }
}

#[test]
fn what_a_version_does_not_have() {
    let state = State {
        motion_generator_mode: MotionGeneratorMode::None,
        ..State::default()
    };
    assert_eq!(
        words(state.emit(Version::V5, &mut [0; LEN_MAX])),
        "none in version 5; allowed: 6 to 10"
    );
    let mut bytes = [0; REQUEST_LEN_MAX];
    let mut emit = |version, request: Request| words(request.emit(version, 0, &mut bytes));
    assert_eq!(
        emit(Version::V6, Request::SetFilters([1.0; 5])),
        "SetFilters in version 6; allowed: 5 to 5"
    );
    assert_eq!(
        emit(Version::V7, Request::GetRobotModel),
        "GetRobotModel in version 7; allowed: 8 to 10"
    );
    let motion = Request::Move(Move::new(Controller::External, Generator::None));
    assert_eq!(
        emit(Version::V5, motion),
        "none in version 5; allowed: 6 to 10"
    );
    let reply = Reply::Setter {
        setter: Setter::Load,
        status: SetterStatus::Rejected,
    };
    assert_eq!(
        words(reply.emit(Version::V5, 0, &mut bytes)),
        "rejected by a safety function in version 5; allowed: 6 to 10"
    );
}

#[test]
fn commands() {
    let parse = |version, bytes: &[u8]| words(Command::parse(version, bytes));
    let mut bytes = data::command(Version::V10);
    assert_eq!(
        parse(Version::V5, &bytes),
        "length of command: 371 bytes; allowed: 370"
    );
    bytes[370] = 2;
    assert_eq!(
        parse(Version::V10, &bytes),
        "torque_command_finished[0]: 2; allowed: 0 and 1"
    );
    bytes[312] = 9;
    assert_eq!(
        parse(Version::V10, &bytes),
        "valid_elbow[0]: 9; allowed: 0 and 1"
    );
    let command = Command {
        tau_j_d: [0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0],
        ..Command::default()
    };
    assert_eq!(
        words(command.check()),
        "tau_J_d[1]: not finite; allowed: finite numbers"
    );
}

#[test]
fn requests() {
    let parse =
        |version, code, payload: &[u8]| words(Request::parse(version, &message(code, payload)));
    assert_eq!(parse(Version::V5, 14, &[]), "request: 14; allowed: 0 to 13");
    assert_eq!(
        parse(Version::V10, 12, &[]),
        "request: 12; allowed: 0 to 11"
    );
    assert_eq!(
        parse(Version::V5, 0, &[0; 5]),
        "length of Connect: 5 bytes; allowed: 4"
    );
    assert_eq!(
        parse(Version::V10, 1, &[0; 56]),
        "length of Move: 56 bytes; allowed: 113"
    );
    assert_eq!(
        parse(Version::V5, 1, &[3; 56]),
        "controller of Move: 50529027; allowed: 0 to 2"
    );
    let mut motion = [0; 113];
    motion[4] = 4;
    assert_eq!(
        parse(Version::V5, 1, &motion[..56]),
        "motion generator of Move: 4; allowed: 0 to 3"
    );
    motion[56] = 2;
    assert_eq!(
        parse(Version::V10, 1, &motion),
        "use_async_motion_generator[0]: 2; allowed: 0 and 1"
    );
    assert_eq!(
        parse(Version::V10, 6, &[0, 0, 0, 3, 0, 0, 0]),
        "guiding_mode[3]: 3; allowed: 0 and 1"
    );
    assert_eq!(
        parse(Version::V5, 13, &[4, 0]),
        "architecture of LoadModelLibrary: 4; allowed: 0 to 3"
    );
    let short = Message {
        skipped: 100,
        ..message(9, &[0; 4])
    };
    assert_eq!(
        words(Request::parse(Version::V10, &short)),
        "length of SetLoad: 4 bytes; allowed: 104"
    );
}

#[test]
fn numbers_of_requests() {
    let check = |request: Request| words(request.check());
    let mut joints = [0.0, 14_250.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    assert_eq!(Request::SetJointImpedance(joints).check(), Ok(()));
    joints[6] = 14_250.5;
    assert_eq!(
        check(Request::SetJointImpedance(joints)),
        "K_theta[6]: 14250.5; allowed: 0 to 14250"
    );
    let mut axes = [10.0, 3000.0, 10.0, 1.0, 300.0, 1.0];
    assert_eq!(Request::SetCartesianImpedance(axes).check(), Ok(()));
    axes[4] = 300.5;
    assert_eq!(
        check(Request::SetCartesianImpedance(axes)),
        "K_x[4]: 300.5; allowed: 1 to 300"
    );
    axes[0] = 9.5;
    assert_eq!(
        check(Request::SetCartesianImpedance(axes)),
        "K_x[0]: 9.5; allowed: 10 to 3000"
    );
    axes[2] = f64::NAN;
    axes[0] = 10.0;
    assert_eq!(
        check(Request::SetCartesianImpedance(axes)),
        "K_x[2]: not finite; allowed: finite numbers"
    );
    let load = Load {
        m_load: 1.0,
        f_x_cload: [0.0, 0.0, f64::INFINITY],
        i_load: [0.0; 9],
    };
    assert_eq!(
        check(Request::SetLoad(load)),
        "F_x_Cload[2]: not finite; allowed: finite numbers"
    );
    assert_eq!(Request::Move(Move::torque(Version::V5)).check(), Ok(()));
}

#[test]
fn replies() {
    let parse =
        |version, code, payload: &[u8]| words(Reply::parse(version, &message(code, payload)));
    assert_eq!(
        parse(Version::V5, 1, &[10]),
        "status of Move: 10; allowed: 0 to 9"
    );
    assert_eq!(
        parse(Version::V10, 1, &[12]),
        "status of Move: 12; allowed: 0 to 11"
    );
    assert_eq!(
        parse(Version::V5, 0, &[0, 5]),
        "length of Connect: 2 bytes; allowed: 3 and more"
    );
    assert_eq!(
        parse(Version::V5, 4, &[3]),
        "status of a setter: 3; allowed: 0 to 2"
    );
    let mut wall = [0; 154];
    wall[153] = 4;
    assert_eq!(
        parse(Version::V5, 3, &wall),
        "object_activation[0]: 4; allowed: 0 and 1"
    );
    // Fill behind a status is nothing.
    assert_eq!(
        Reply::parse(Version::V10, &message(1, &[1, 7, 7, 7])),
        Ok(Reply::Move(MoveStatus::MotionStarted))
    );
    assert!(MoveStatus::MotionStarted.is_running() && !MoveStatus::Success.is_running());
}

#[test]
fn streams() {
    assert_eq!(
        words(Stream::new([0; 11], 100)),
        "room for a message: 11 bytes; allowed: 12 and more"
    );
    let mut stream = Stream::new([0; REQUEST_LEN_MAX], REQUEST_LEN_MAX).expect("room");
    for size in [0u32, 11, 429, u32::MAX] {
        let mut bytes = data::message(2, 0, &[]);
        bytes[8..].copy_from_slice(&size.to_le_bytes());
        let text = format!("length of message: {size} bytes; allowed: 12 to 428");
        let good = data::message(2, 0, &[]);
        let mut rest = &[&bytes[..], &good].concat()[..];
        assert_eq!(words(stream.next(&mut rest)), text);
        // It does not come back by itself.
        assert_eq!(words(stream.next(&mut rest)), text);
        assert_eq!(words(stream.next(&mut &good[..])), text);
        stream.reset();
        assert!(stream.next(&mut &good[..]).is_ok_and(|it| it.is_some()));
    }
    let mut short = [0; 15];
    let connect = Request::Connect(Connect {
        version: 5,
        udp_port: 1,
    });
    assert_eq!(
        words(connect.emit(Version::V5, 0, &mut short)),
        "room for a message: 15 bytes; allowed: 16 and more"
    );
}

/// A long reply into a short buffer: its begin, and how much is missing.
#[test]
fn the_end_of_long_messages_is_skipped() {
    let urdf = [b'x'; 20_000];
    let reply = Reply::RobotModel {
        status: fci::status::ModelStatus::Success,
        urdf: &urdf,
    };
    let mut room = vec![0; 30_000];
    let sent = reply.emit(Version::V10, 5, &mut room).expect("room");
    let mut stream = Stream::new([0; 256], 30_000).expect("room");
    let mut found = None;
    for piece in sent.chunks(1448) {
        let mut rest = piece;
        while let Some(message) = stream.next(&mut rest).expect("a message") {
            assert_eq!(message.skipped, 20_013 - 256);
            let Ok(Reply::RobotModel { urdf, .. }) = Reply::parse(Version::V10, &message) else {
                panic!("another reply");
            };
            found = Some(urdf.len());
        }
    }
    assert_eq!(found, Some(256 - 13));
}

#[test]
fn errors_as_words() {
    assert_eq!(RobotErrors::NONE.to_string(), "none");
    let two = RobotErrors::NONE
        .with(RobotError::JointReflex)
        .with(RobotError::PowerLimitViolation);
    assert_eq!(two.to_string(), "joint_reflex, power_limit_violation");
    assert_eq!(two.bits(), 1 << 6 | 1 << 26);
    assert_eq!(Kind::SetNeToEe.to_string(), "SetNEToEE");
}

#[test]
fn states_that_count() {
    let mut sequence = Sequence::new();
    for (id, expected) in [
        (100, Arrival::First),
        (101, Arrival::Next { lost: 0 }),
        (104, Arrival::Next { lost: 2 }),
        (104, Arrival::Old),
        (102, Arrival::Old),
        (
            u64::MAX,
            Arrival::Next {
                lost: u64::MAX - 105,
            },
        ),
        (0, Arrival::Old),
    ] {
        assert_eq!(sequence.receive(id), expected);
        assert_eq!(expected.is_fresh(), expected != Arrival::Old);
    }
    assert_eq!(sequence.newest(), Some(u64::MAX));
}
