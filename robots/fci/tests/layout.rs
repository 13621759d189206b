//! Places, sizes, codes and names against the wire format as written down in `data`.

mod data;

use data::{EXCHANGES, REALS, layout, message, number, request};
use fci::command::{self, Command};
use fci::modes::{Controller, Generator};
use fci::request::{Connect, GuidingMode, Load, Move, Request};
use fci::state::{FIELDS, LEN_MAX, State, StatePacket, field, position};
use fci::status::{MoveStatus, RecoveryStatus, SetterStatus, StopMoveStatus};
use fci::stream::{REQUEST_LEN_MAX, Stream};
use fci::{ControllerMode, Kind, MotionGeneratorMode, RobotError, RobotMode, Version};

/// Every field of the state: name, count, place.
#[test]
fn fields_of_the_state() {
    for (field, (name, count, double, single)) in FIELDS.iter().zip(REALS) {
        assert_eq!((field.name, field.count), (name, count));
        assert_eq!(field.offset(Version::V5), double, "{name}");
        assert_eq!(field.offset(Version::V9), double, "{name}");
        assert_eq!(field.offset(Version::V10), Some(single), "{name}");
    }
    assert_eq!(FIELDS.len(), REALS.len());
}

#[test]
fn sizes() {
    let sizes = |version: Version| (version.state_len(), version.command_len());
    let all = Version::ALL.map(sizes);
    assert_eq!(all[..2], [(2373, 370); 2]);
    assert_eq!(all[2..5], [(2373, 371); 3]);
    assert_eq!(all[5], (1377, 371));
    assert_eq!(LEN_MAX, 2373);
    assert_eq!(command::LEN_MAX, 371);
}

/// Every number of a state by its accessor, and by its member of the value.
#[test]
fn state_by_name() {
    for version in Version::ALL {
        let bytes = data::state(version);
        let packet = StatePacket::new_checked(version, &bytes).expect("a state");
        let state = State::parse(&packet);
        let has = |name| name != "accelerometer_top" && name != "accelerometer_bottom";
        for (field, values) in FIELDS.iter().zip(state.reals()) {
            for (index, &value) in values.iter().enumerate() {
                let there = version == Version::V10 || has(field.name);
                let expected = if there {
                    number(field.name, index)
                } else {
                    0.0
                };
                assert_eq!(value, expected, "{version:?} {}[{index}]", field.name);
            }
        }
        let seven = |name| std::array::from_fn::<f64, 7, _>(|i| number(name, i));
        assert_eq!(packet.tau_j(), seven("tau_J"));
        assert_eq!(packet.tau_j_d(), seven("tau_J_d"));
        assert_eq!(packet.q(), seven("q"));
        assert_eq!(packet.dq(), seven("dq"));
        assert_eq!(packet.m_load(), number("m_load", 0));
        let [x, y, z] = [12, 13, 14].map(|i| number("O_T_EE", i));
        assert_eq!(position(&packet.o_t_ee()), [x, y, z]);
        assert_eq!(state.message_id, 0x0102_0304_0506_0708);
        assert_eq!(
            state.motion_generator_mode,
            MotionGeneratorMode::JointVelocity
        );
        assert_eq!(state.controller_mode, ControllerMode::External);
        assert_eq!(state.robot_mode, RobotMode::Move);
        for (i, error) in RobotError::all().enumerate() {
            assert_eq!(state.errors.contains(error), i % 3 == 0, "{error}");
            assert_eq!(state.reflex_reason.contains(error), i % 5 == 0, "{error}");
        }
        assert_eq!(packet.check_finite(&FIELDS), Ok(()));
        let mut again = [0xAA; LEN_MAX];
        assert_eq!(state.emit(version, &mut again), Ok(&bytes[..]));
    }
}

#[test]
fn accelerometers_are_rows_of_sensors() {
    let bytes = data::state(Version::V10);
    let packet = StatePacket::new_checked(Version::V10, &bytes).expect("a state");
    assert_eq!(
        packet.accelerometer_top()[1][2],
        number("accelerometer_top", 5)
    );
    assert_eq!(
        packet.accelerometer_bottom()[5],
        [15, 16, 17].map(|i| number("accelerometer_bottom", i))
    );
}

#[test]
fn commands() {
    for version in Version::ALL {
        let bytes = data::command(version);
        let series = |first: usize| move |i| (first + i) as f64 + 0.5;
        let expected = Command {
            message_id: 7,
            q_c: std::array::from_fn(series(0)),
            dq_c: std::array::from_fn(series(7)),
            o_t_ee_c: std::array::from_fn(series(14)),
            o_dp_ee_c: std::array::from_fn(series(30)),
            elbow_c: std::array::from_fn(series(36)),
            valid_elbow: true,
            motion_generation_finished: false,
            tau_j_d: std::array::from_fn(series(38)),
            torque_command_finished: version > Version::V6,
        };
        assert_eq!(Command::parse(version, &bytes), Ok(expected));
        assert_eq!(expected.emit(version, &mut [0xAA; command::LEN_MAX]), bytes);
        assert_eq!(expected.is_last(), version > Version::V6);
    }
}

/// Who ends a motion of torque alone, and by which byte.
#[test]
fn torque_alone() {
    for version in Version::ALL {
        let last = Command::torque(version, 9, [0.5; 7], true);
        let mut bytes = [0; command::LEN_MAX];
        let sent = last.emit(version, &mut bytes);
        let single = version == Version::V10;
        assert_eq!(sent[313], u8::from(!single), "{version:?}");
        assert_eq!(
            sent.get(370),
            [None, Some(&u8::from(single))][usize::from(version > Version::V6)]
        );
        assert!(last.is_last());
        assert!(!Command::torque(version, 9, [0.5; 7], false).is_last());
        let motion = Move::torque(version);
        assert_eq!(motion.controller, Controller::External);
        let generator = if single {
            Generator::None
        } else {
            Generator::JointVelocity
        };
        assert_eq!(motion.generator, generator);
    }
}

/// Codes of requests by version, and the length of each.
#[test]
fn requests_by_code() {
    for version in Version::ALL {
        let mut bytes = [0; REQUEST_LEN_MAX];
        for exchange in &EXCHANGES {
            let kind = Kind::all()
                .find(|kind| kind.name() == exchange.name)
                .expect("a kind");
            let Some(code) = exchange.code(version) else {
                assert!(kind.code(version).is_err(), "{kind} {version:?}");
                continue;
            };
            assert_eq!(kind.code(version), Ok(code), "{kind} {version:?}");
            assert_eq!(Kind::from_code(version, code), Ok(kind));
            let sent = message(code, 77, &request(exchange, version));
            let mut stream = Stream::new([0; REQUEST_LEN_MAX], REQUEST_LEN_MAX).expect("room");
            let message = stream
                .next(&mut &sent[..])
                .expect("a message")
                .expect("whole");
            assert_eq!((message.id, message.skipped), (77, 0));
            let read = Request::parse(version, &message).expect("a request");
            assert_eq!(read.kind(), kind);
            assert_eq!(
                read.emit(version, 77, &mut bytes),
                Ok(&sent[..]),
                "{kind} {version:?}"
            );
        }
        let count = EXCHANGES
            .iter()
            .filter(|it| it.code(version).is_some())
            .count() as u32;
        assert!(Kind::from_code(version, count).is_err());
    }
}

/// The members that stand for bytes: one request of each shape.
#[test]
fn members_of_requests() {
    let read = |name, version| {
        let exchange = EXCHANGES
            .iter()
            .find(|it| it.name == name)
            .expect("an exchange");
        let sent = message(
            exchange.code(version).expect("a code"),
            0,
            &request(exchange, version),
        );
        let mut stream = Stream::new([0; REQUEST_LEN_MAX], REQUEST_LEN_MAX).expect("room");
        let message = stream
            .next(&mut &sent[..])
            .expect("a message")
            .expect("whole");
        Request::parse(version, &message).expect("a request")
    };
    let series = |first: usize| move |i| (first + i) as f64 + 1.25;
    let connect = Connect {
        version: 10,
        udp_port: 1337,
    };
    assert_eq!(read("Connect", Version::V10), Request::Connect(connect));
    assert_eq!(
        read("GetCartesianLimit", Version::V5),
        Request::GetCartesianLimit { limit: 0x0539_000A }
    );
    let mut motion = Move {
        maximum_path_deviation: std::array::from_fn(series(0)),
        maximum_goal_pose_deviation: std::array::from_fn(series(3)),
        ..Move::new(Controller::CartesianImpedance, Generator::JointVelocity)
    };
    assert_eq!(read("Move", Version::V5), Request::Move(motion));
    motion.use_async_motion_generator = true;
    motion.maximum_velocity = std::array::from_fn(series(6));
    assert_eq!(read("Move", Version::V10), Request::Move(motion));
    assert_eq!(
        read("SetLoad", Version::V5),
        Request::SetLoad(Load {
            m_load: 1.25,
            f_x_cload: std::array::from_fn(series(1)),
            i_load: std::array::from_fn(series(4)),
        })
    );
    assert_eq!(
        read("SetGuidingMode", Version::V10),
        Request::SetGuidingMode(GuidingMode {
            axes: [true; 6],
            null_space: true
        })
    );
    let Request::SetCollisionBehavior(behavior) = read("SetCollisionBehavior", Version::V10) else {
        panic!("another request");
    };
    assert_eq!(
        behavior.upper_torque_acceleration,
        std::array::from_fn(series(7))
    );
    assert_eq!(
        behavior.upper_torque_nominal,
        std::array::from_fn(series(21))
    );
    assert_eq!(
        behavior.lower_force_acceleration,
        std::array::from_fn(series(28))
    );
    assert_eq!(
        behavior.upper_force_nominal,
        std::array::from_fn(series(46))
    );
}

/// Statuses by version, in the order of their codes.
#[test]
fn statuses_by_code() {
    use MoveStatus as M;
    let before = [
        M::Success,
        M::MotionStarted,
        M::Preempted,
        M::NotPossible,
        M::StartAtSingularPose,
        M::InvalidArgument,
        M::ReflexAborted,
        M::EmergencyAborted,
        M::InputErrorAborted,
        M::Aborted,
    ];
    let after = [
        M::Success,
        M::MotionStarted,
        M::Preempted,
        M::PreemptedBySafety,
        M::Rejected,
        M::NotPossible,
        M::StartAtSingularPose,
        M::InvalidArgument,
        M::ReflexAborted,
        M::EmergencyAborted,
        M::InputErrorAborted,
        M::Aborted,
    ];
    for (code, &status) in (0..).zip(&before) {
        assert_eq!(M::from_code(Version::V5, code), Ok(status));
    }
    for (code, &status) in (0..).zip(&after) {
        for version in &Version::ALL[1..] {
            assert_eq!(M::from_code(*version, code), Ok(status));
            assert_eq!(status.code(*version), Ok(code));
        }
    }
    let codes = |five, ten| [five, ten];
    let stop = |status: StopMoveStatus| [Version::V5, Version::V10].map(|it| status.code(it).ok());
    assert_eq!(
        stop(StopMoveStatus::EmergencyAborted),
        codes(Some(2), Some(3))
    );
    assert_eq!(stop(StopMoveStatus::ReflexAborted), codes(Some(3), Some(4)));
    assert_eq!(stop(StopMoveStatus::Rejected), codes(None, Some(2)));
    let recovery =
        |status: RecoveryStatus| [Version::V5, Version::V10].map(|it| status.code(it).ok());
    assert_eq!(
        recovery(RecoveryStatus::ManualRecoveryRequired),
        codes(Some(2), Some(3))
    );
    assert_eq!(
        recovery(RecoveryStatus::ReflexAborted),
        codes(Some(3), Some(4))
    );
    assert_eq!(
        recovery(RecoveryStatus::EmergencyAborted),
        codes(Some(4), Some(5))
    );
    let setter = |status: SetterStatus| [Version::V5, Version::V10].map(|it| status.code(it).ok());
    assert_eq!(
        setter(SetterStatus::InvalidArgument),
        codes(Some(2), Some(2))
    );
    assert_eq!(setter(SetterStatus::Rejected), codes(None, Some(3)));
}

/// Move and the state number generators differently.
#[test]
fn generators() {
    for generator in Generator::all() {
        let mode = MotionGeneratorMode::from(generator);
        let code = generator.code(Version::V10).expect("in version 10");
        assert_eq!(mode.code(Version::V10), Ok(code + 1));
    }
    for controller in Controller::all() {
        let mode = ControllerMode::from(controller);
        assert_eq!(mode.code(Version::V5), controller.code(Version::V5));
    }
}

/// Some of the 41 names at their places.
#[test]
fn names_of_errors() {
    let names: Vec<&str> = RobotError::all().map(RobotError::name).collect();
    assert_eq!(names.len(), 41);
    for (code, name) in [
        (0, "joint_position_limits_violation"),
        (6, "joint_reflex"),
        (7, "cartesian_reflex"),
        (25, "communication_constraints_violation"),
        (32, "controller_torque_discontinuity"),
        (34, "tau_J_range_violation"),
        (40, "base_acceleration_invalid_reading"),
    ] {
        assert_eq!(names[code], name);
        assert_eq!(
            RobotError::from_code(Version::V5, code as u32).map(RobotError::name),
            Ok(name)
        );
    }
}

/// The table in the documentation. `UPDATE=1` writes it anew.
#[test]
fn table_of_the_documentation() {
    let mut table = String::from(
        "| field | reals | versions 5 to 9 | 10 | unit | frame | |\n|---|---|---|---|---|---|---|\n\
         | message_id | u64 | 0 | 0 | ms | | since the robot's start |\n",
    );
    let row = |field: &fci::state::Field| {
        let double = field
            .offset(Version::V5)
            .map_or(String::new(), |at| at.to_string());
        let single = field.offset(Version::V10).expect("all are in version 10");
        let (name, count) = (field.name, field.count);
        let (unit, frame, meaning) = (field.unit, field.frame, field.meaning);
        format!("| {name} | {count} | {double} | {single} | {unit} | {frame} | {meaning} |\n")
    };
    let (last, others) = FIELDS.split_last().expect("fields");
    table.extend(others.iter().map(row));
    let (five, ten) = (layout(Version::V5), layout(Version::V10));
    for (name, shape, five, ten, meaning) in [
        (
            "motion_generator_mode",
            "u8",
            five.motion_generator_mode,
            ten.motion_generator_mode,
            "generator that runs",
        ),
        (
            "controller_mode",
            "u8",
            five.controller_mode,
            ten.controller_mode,
            "controller that runs",
        ),
        ("errors", "41 bool", five.errors, ten.errors, "errors now"),
        (
            "reflex_reason",
            "41 bool",
            five.reflex_reason,
            ten.reflex_reason,
            "errors that have aborted the last motion",
        ),
        (
            "robot_mode",
            "u8",
            five.robot_mode,
            ten.robot_mode,
            "state of the robot",
        ),
    ] {
        table += &format!("| {name} | {shape} | {five} | {ten} | | | {meaning} |\n");
    }
    table += &row(last);
    table += &format!("| bytes | | {} | {} | | | |\n", five.len, ten.len);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/layout.md");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(path, &table).expect("layout.md");
    }
    let committed = std::fs::read_to_string(path).expect("layout.md");
    assert_eq!(committed, table, "UPDATE=1 cargo test -p fci --test layout");
    assert_eq!(field::Q.name, "q");
}
