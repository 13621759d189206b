//! Values through bytes and bytes through values, whatever the numbers, NaN with any bits
//! included. 2000 cases of each property from a fixed seed.

mod data;

use fci::command::{self, Command};
use fci::reply::{CartesianLimit, Reply};
use fci::request::{
    Architecture, CollisionBehavior, Connect, GuidingMode, Load, Move, Request, System,
};
use fci::state::{FIELDS, LEN_MAX, State, StatePacket};
use fci::status::{
    ConnectStatus, LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus,
    StopMoveStatus,
};
use fci::stream::{HEADER_LEN, REQUEST_LEN_MAX, Stream};
use fci::{
    Controller, ControllerMode, Generator, MotionGeneratorMode, RobotError, RobotErrors, RobotMode,
    Setter, Version,
};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{RngSeed, TestRunner};

const CASES: u32 = 2000;

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

fn any_version() -> impl Strategy<Value = Version> {
    select(&Version::ALL[..])
}

/// Any 64 bits; every fourth a NaN with any payload, every eighth an infinity or a zero.
fn any_real() -> impl Strategy<Value = f64> {
    let nan = any::<u64>().prop_map(|bits| bits | 0x7FF0_0000_0000_0001);
    let special = select(vec![f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0]).prop_map(f64::to_bits);
    prop_oneof![5 => any::<u64>(), 2 => nan, 1 => special].prop_map(f64::from_bits)
}

fn reals<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    prop::collection::vec(any_real(), N).prop_map(|values| values.try_into().expect("N numbers"))
}

/// One of those that a version has.
fn any_of<T: Copy + std::fmt::Debug + 'static>(
    all: impl Iterator<Item = T>,
    has: impl Fn(T) -> bool,
) -> impl Strategy<Value = T> {
    select(all.filter(|&it| has(it)).collect::<Vec<T>>())
}

fn any_errors() -> impl Strategy<Value = RobotErrors> {
    any::<u64>().prop_map(|bits| {
        let all = RobotError::all().enumerate();
        all.filter(|(i, _)| bits >> i & 1 == 1)
            .map(|(_, error)| error)
            .collect()
    })
}

fn any_state(version: Version) -> impl Strategy<Value = State> {
    let count: usize = FIELDS.iter().map(|field| field.count).sum();
    (
        any::<u64>(),
        prop::collection::vec(any_real(), count),
        any_of(MotionGeneratorMode::all(), move |it| {
            it.code(version).is_ok()
        }),
        any_of(ControllerMode::all(), move |it| it.code(version).is_ok()),
        any_of(RobotMode::all(), move |it| it.code(version).is_ok()),
        any_errors(),
        any_errors(),
    )
        .prop_map(
            move |(message_id, reals, generator, controller, mode, errors, reasons)| {
                let mut state = State {
                    message_id,
                    motion_generator_mode: generator,
                    controller_mode: controller,
                    robot_mode: mode,
                    errors,
                    reflex_reason: reasons,
                    ..State::default()
                };
                let mut reals = reals.into_iter();
                for (field, values) in FIELDS.iter().zip(state.reals_mut()) {
                    for (value, real) in values.iter_mut().zip(&mut reals) {
                        // What the version does not have is read as zeros.
                        *value = if field.offset(version).is_some() {
                            real
                        } else {
                            0.0
                        };
                    }
                }
                state
            },
        )
}

#[test]
fn state_through_bytes() {
    let strategy = any_version().prop_flat_map(|it| (Just(it), any_state(it)));
    for_all(strategy, |(version, state)| {
        let mut bytes = [0xFF; LEN_MAX];
        let sent = state
            .emit(version, &mut bytes)
            .expect("modes of this version");
        let packet = StatePacket::new_checked(version, sent).expect("what can be made can be sent");
        let read = State::parse(&packet);
        let mut finite = true;
        for (field, (sent, came)) in FIELDS
            .iter()
            .zip(state.reals().into_iter().zip(read.reals()))
        {
            for (sent, came) in sent.iter().zip(came) {
                if version < Version::V10 {
                    assert_eq!(sent.to_bits(), came.to_bits(), "{}", field.name);
                } else if sent.is_nan() {
                    assert!(came.is_nan(), "{}", field.name);
                } else {
                    // To the next number of binary32.
                    assert_eq!(
                        f64::from(*sent as f32).to_bits(),
                        came.to_bits(),
                        "{}",
                        field.name
                    );
                }
                finite &= came.is_finite();
            }
        }
        assert_eq!(packet.check_finite(&FIELDS).is_ok(), finite);
        let rest = |state: &State| {
            (
                state.message_id,
                state.motion_generator_mode,
                state.controller_mode,
                state.robot_mode,
                state.errors,
                state.reflex_reason,
            )
        };
        assert_eq!(rest(&read), rest(&state));
    });
}

#[test]
fn bytes_through_state() {
    let strategy = (any_version(), prop::collection::vec(any::<u8>(), LEN_MAX));
    for_all(strategy, |(version, mut bytes)| {
        let layout = data::layout(version);
        bytes.truncate(layout.len);
        for at in layout.errors..layout.errors + 82 {
            bytes[at] &= 1;
        }
        bytes[layout.motion_generator_mode] %= data::generator_mode_max(version) + 1;
        bytes[layout.controller_mode] %= 4;
        bytes[layout.robot_mode] %= 7;
        let packet = StatePacket::new_checked(version, &bytes[..]).expect("a state");
        let mut again = [0; LEN_MAX];
        let again = State::parse(&packet)
            .emit(version, &mut again)
            .expect("its own modes");
        // NaN in binary32 may be another one behind binary64.
        if version < Version::V10 || packet.check_finite(&FIELDS).is_ok() {
            assert_eq!(again, bytes);
        }
    });
}

#[test]
fn command_through_bytes() {
    let reals = (reals(), reals(), reals(), reals(), reals(), reals());
    for_all(
        (any_version(), any::<u64>(), reals, any::<[bool; 3]>()),
        |(version, message_id, (q, dq, pose, twist, elbow, tau), [valid, generated, torque])| {
            let value = Command {
                message_id,
                q_c: q,
                dq_c: dq,
                o_t_ee_c: pose,
                o_dp_ee_c: twist,
                elbow_c: elbow,
                valid_elbow: valid,
                motion_generation_finished: generated,
                tau_j_d: tau,
                torque_command_finished: torque && version > Version::V6,
            };
            let mut bytes = [0xFF; command::LEN_MAX];
            let sent = value.emit(version, &mut bytes);
            let read = Command::parse(version, sent).expect("what can be made can be sent");
            let mut again = [0; command::LEN_MAX];
            // Bits of NaN are compared as bytes, members as text.
            assert_eq!(read.emit(version, &mut again), sent);
            assert_eq!(format!("{read:?}"), format!("{value:?}"));
            let all = [&q[..], &dq, &pose, &twist, &elbow, &tau].concat();
            assert_eq!(value.check().is_ok(), all.iter().all(|it| it.is_finite()));
        },
    );
}

fn any_request(version: Version) -> BoxedStrategy<Request> {
    let connect = any::<(u16, u16)>()
        .prop_map(|(version, udp_port)| Request::Connect(Connect { version, udp_port }));
    let single = version == Version::V10;
    let motion = (
        any_of(Controller::all(), |_| true),
        any_of(Generator::all(), move |it| it.code(version).is_ok()),
        (reals(), reals(), reals()),
        any::<bool>(),
    )
        .prop_map(
            move |(controller, generator, (path, goal, velocity), asynchronous)| {
                Request::Move(Move {
                    controller,
                    generator,
                    maximum_path_deviation: path,
                    maximum_goal_pose_deviation: goal,
                    use_async_motion_generator: single && asynchronous,
                    maximum_velocity: if single { velocity } else { [0.0; 7] },
                })
            },
        );
    let collision = (reals::<28>(), reals::<24>()).prop_map(|(torques, forces)| {
        let (torques, _) = torques.as_chunks::<7>();
        let (forces, _) = forces.as_chunks::<6>();
        Request::SetCollisionBehavior(CollisionBehavior {
            lower_torque_acceleration: torques[0],
            upper_torque_acceleration: torques[1],
            lower_torque_nominal: torques[2],
            upper_torque_nominal: torques[3],
            lower_force_acceleration: forces[0],
            upper_force_acceleration: forces[1],
            lower_force_nominal: forces[2],
            upper_force_nominal: forces[3],
        })
    });
    let load = (any_real(), reals(), reals()).prop_map(|(m_load, f_x_cload, i_load)| {
        Request::SetLoad(Load {
            m_load,
            f_x_cload,
            i_load,
        })
    });
    let guiding = any::<([bool; 6], bool)>()
        .prop_map(|(axes, null_space)| Request::SetGuidingMode(GuidingMode { axes, null_space }));
    let library = (
        any_of(Architecture::all(), |_| true),
        any_of(System::all(), |_| true),
    )
        .prop_map(|(architecture, system)| Request::LoadModelLibrary {
            architecture,
            system,
        });
    prop_oneof![
        connect,
        motion,
        collision,
        load,
        guiding,
        library,
        any::<i32>().prop_map(|limit| Request::GetCartesianLimit { limit }),
        reals().prop_map(Request::SetJointImpedance),
        reals().prop_map(Request::SetCartesianImpedance),
        reals().prop_map(Request::SetEeToK),
        reals().prop_map(Request::SetNeToEe),
        reals().prop_map(Request::SetFilters),
        select(vec![
            Request::StopMove,
            Request::AutomaticErrorRecovery,
            Request::GetRobotModel
        ]),
    ]
    .boxed()
}

#[test]
fn request_through_bytes() {
    let strategy = any_version().prop_flat_map(|it| (Just(it), any_request(it), any::<u32>()));
    for_all(strategy, |(version, value, id)| {
        let mut bytes = [0xFF; REQUEST_LEN_MAX];
        let sent = value.emit(version, id, &mut bytes);
        if value.kind().code(version).is_err() {
            assert_eq!(
                sent,
                Err(value.kind().code(version).expect_err("not there"))
            );
            return;
        }
        let sent = sent.expect("room for all");
        let mut stream = Stream::new([0; REQUEST_LEN_MAX], REQUEST_LEN_MAX).expect("room");
        let message = stream
            .next(&mut &sent[..])
            .expect("a message")
            .expect("whole");
        assert_eq!(message.id, id);
        let read = Request::parse(version, &message).expect("what can be made can be sent");
        let mut again = [0; REQUEST_LEN_MAX];
        assert_eq!(read.emit(version, id, &mut again).expect("room"), sent);
        assert_eq!(format!("{read:?}"), format!("{value:?}"));
    });
}

fn any_reply(version: Version) -> BoxedStrategy<(Reply<'static>, Vec<u8>)> {
    let setter = any_of(SetterStatus::all(), move |it| it.code(version).is_ok());
    let wall = any_of(SetterStatus::all(), move |it| it.code(version).is_ok());
    let wall = (wall, reals(), reals(), any::<bool>()).prop_map(|(status, size, frame, active)| {
        let limit = CartesianLimit {
            size,
            frame,
            active,
        };
        Reply::CartesianLimit { status, limit }
    });
    let replies = prop_oneof![
        (any_of(ConnectStatus::all(), |_| true), any::<u16>())
            .prop_map(|(status, version)| Reply::Connect { status, version }),
        any_of(MoveStatus::all(), move |it| it.code(version).is_ok()).prop_map(Reply::Move),
        any_of(StopMoveStatus::all(), move |it| it.code(version).is_ok()).prop_map(Reply::StopMove),
        any_of(RecoveryStatus::all(), move |it| it.code(version).is_ok()).prop_map(Reply::Recovery),
        (select(&Setter::ALL[..]), setter)
            .prop_map(|(setter, status)| Reply::Setter { setter, status }),
        wall,
        any_of(LibraryStatus::all(), |_| true).prop_map(|status| Reply::ModelLibrary {
            status,
            library: &[]
        }),
        any_of(ModelStatus::all(), |_| true)
            .prop_map(|status| Reply::RobotModel { status, urdf: &[] }),
    ];
    (replies, prop::collection::vec(any::<u8>(), 0..300)).boxed()
}

#[test]
fn reply_through_bytes() {
    let strategy = any_version().prop_flat_map(|it| (Just(it), any_reply(it), any::<u32>()));
    for_all(strategy, |(version, (reply, model), id)| {
        let value = match reply {
            Reply::ModelLibrary { status, .. } => Reply::ModelLibrary {
                status,
                library: &model,
            },
            Reply::RobotModel { status, .. } => Reply::RobotModel {
                status,
                urdf: &model,
            },
            other => other,
        };
        let mut bytes = [0xFF; 512];
        let sent = value.emit(version, id, &mut bytes);
        if value.kind().code(version).is_err() {
            assert!(sent.is_err());
            return;
        }
        let sent = sent.expect("room for all");
        let mut stream = Stream::new([0; 512], 512).expect("room");
        let message = stream
            .next(&mut &sent[..])
            .expect("a message")
            .expect("whole");
        let read = Reply::parse(version, &message).expect("what can be made can be sent");
        let mut again = [0; 512];
        assert_eq!(read.emit(version, id, &mut again).expect("room"), sent);
        assert_eq!(format!("{read:?}"), format!("{value:?}"));
    });
}

/// Whatever the bytes and the pieces: messages are those of the whole, nothing is left, no panic.
#[test]
fn streams_in_pieces() {
    let message = (
        any::<u32>(),
        any::<u32>(),
        prop::collection::vec(any::<u8>(), 0..80),
    );
    let strategy = (
        prop::collection::vec(message, 0..6),
        prop::collection::vec(any::<u8>(), 0..40),
        prop::collection::vec(0..600usize, 0..8),
        HEADER_LEN..100usize,
    );
    for_all(strategy, |(messages, tail, mut cuts, room)| {
        let parts = messages
            .iter()
            .map(|(code, id, payload)| data::message(*code, *id, payload));
        let mut bytes: Vec<u8> = parts.flatten().collect();
        bytes.extend(&tail);
        cuts.push(bytes.len());
        cuts.sort_unstable();
        let mut stream = Stream::new(vec![0; room], HEADER_LEN + 79).expect("room");
        let mut expected = messages.iter();
        let mut begin = 0;
        'pieces: for cut in cuts {
            let cut = cut.min(bytes.len());
            let mut rest = &bytes[begin..cut];
            begin = cut;
            loop {
                match stream.next(&mut rest) {
                    Ok(Some(found)) => {
                        // Behind the messages there may be more, by chance.
                        let Some((code, id, payload)) = expected.next() else {
                            continue;
                        };
                        let kept = payload.len().min(room - HEADER_LEN);
                        assert_eq!((found.code, found.id), (*code, *id));
                        assert_eq!(found.payload, &payload[..kept]);
                        assert_eq!(found.skipped, payload.len() - kept);
                    }
                    Ok(None) => {
                        assert!(rest.is_empty());
                        break;
                    }
                    Err(_) => {
                        assert_eq!(expected.next(), None, "an error before the end");
                        break 'pieces;
                    }
                }
            }
        }
        assert_eq!(expected.next(), None);
    });
}

/// Any bytes to all readers of all versions: an answer.
#[test]
fn any_bytes() {
    let strategy = (
        any_version(),
        prop::collection::vec(any::<u8>(), 0..2500),
        any::<u32>(),
    );
    for_all(strategy, |(version, bytes, code)| {
        let _ = StatePacket::new_checked(version, &bytes[..]).map(|it| State::parse(&it));
        let _ = Command::parse(version, &bytes).map(|it| it.check());
        let message = fci::Message {
            code: code % 20,
            id: 0,
            payload: &bytes[..bytes.len().min(420)],
            skipped: 0,
        };
        let _ = Request::parse(version, &message).map(|it| it.check());
        let _ = Reply::parse(version, &message);
        let mut rest = &bytes[..];
        let mut stream = Stream::new([0; 64], 1 << 20).expect("room");
        while let Ok(Some(_)) = stream.next(&mut rest) {}
    });
}
