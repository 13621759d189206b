//! Connect, and what ends a connection.

use fci::robot::{Broken, Operator, Refused};
use fci::status::{ConnectStatus, LibraryStatus, ModelStatus};
use fci::stream::HEADER_LEN;
use fci::{Connect, Error, Kind, Reply, Request, RobotMode, Version};

use crate::bench::{Bench, MODEL, settings};

fn connect(number: u16) -> Request {
    Request::Connect(Connect {
        version: number,
        udp_port: 4711,
    })
}

#[test]
fn the_same_version_is_let_in() {
    for version in Version::ALL {
        let mut bench = Bench::silent(settings(version));
        assert_eq!(bench.robot.client(), None);
        let number = version.number();
        assert_eq!(bench.ask(&connect(number)).refused, None);
        let reply = Reply::Connect {
            status: ConnectStatus::Success,
            version: number,
        };
        assert_eq!(bench.drain(), [(0, format!("{reply:?}"))]);
        assert_eq!(bench.robot.client().map(|it| it.udp_port), Some(4711));
        bench.cycle();
        bench.check_still(RobotMode::Idle);
        assert_eq!(bench.state.message_id, 1);
        bench.unanswered();
        assert_eq!(bench.state.message_id, 2);
    }
}

#[test]
fn another_version_is_told_the_robots_and_gets_nothing_else() {
    for (own, others) in [(Version::V5, [10, 4, 0]), (Version::V10, [5, 9, u16::MAX])] {
        for other in others {
            let mut bench = Bench::silent(settings(own));
            let expected = own.number();
            let found = other;
            let refused = Refused::Version { found, expected };
            assert_eq!(bench.ask(&connect(other)).refused, Some(refused));
            let reply = Reply::Connect {
                status: ConnectStatus::IncompatibleVersion,
                version: expected,
            };
            assert_eq!(bench.drain(), [(0, format!("{reply:?}"))]);
            assert_eq!(bench.robot.client(), None);
            let bytes = bench.bytes(&Request::StopMove);
            let broken = Err(Broken::NotConnected(Kind::StopMove));
            assert_eq!(bench.feed(&bytes), broken);
            // A new connection is.
            bench.robot.disconnect();
            assert_eq!(bench.ask(&connect(expected)).refused, None);
        }
    }
}

#[test]
fn what_is_no_conversation_ends_it() {
    let mut bench = Bench::silent(settings(Version::V10));
    let bytes = bench.bytes(&Request::GetRobotModel);
    let broken = Err(Broken::NotConnected(Kind::GetRobotModel));
    assert_eq!(bench.feed(&bytes), broken);
    // For good: even Connect.
    let bytes = bench.bytes(&connect(10));
    assert_eq!(bench.robot.receive(&mut &bytes[..]), broken);
    assert!(bench.drain().is_empty());

    let mut bench = Bench::new(Version::V10);
    let bytes = bench.bytes(&connect(10));
    assert_eq!(bench.feed(&bytes), Err(Broken::Connected));

    // A code that the version does not have, a payload of another length, a size.
    let message = |code: u32, size: u32| {
        let words = [code, 7, size].map(u32::to_le_bytes);
        [words.as_flattened(), &[0; 16]].concat()
    };
    for (code, size) in [(12, 12), (1, 28), (2, 28), (2, 11), (2, 429), (2, u32::MAX)] {
        let mut bench = Bench::new(Version::V10);
        let broken = bench.robot.receive(&mut &message(code, size)[..]);
        assert!(
            matches!(
                broken,
                Err(Broken::Stream(Error::Code { .. } | Error::Length { .. }))
            ),
            "{code} {size}: {broken:?}"
        );
    }
}

#[test]
fn requests_come_in_any_pieces() {
    let mut bench = Bench::new(Version::V5);
    let one = bench.bytes(&Request::SetJointImpedance([3000.0; 7]));
    let two = bench.bytes(&Request::StopMove);
    let all = [one, two].concat();
    let mut handled = Vec::new();
    for byte in &all {
        handled.extend(bench.feed(&[*byte]).expect("a connection"));
    }
    let kinds: Vec<_> = handled.iter().map(|it| it.kind).collect();
    assert_eq!(kinds, [Kind::SetJointImpedance, Kind::StopMove]);
    assert_eq!(bench.drain().len(), 2);
}

/// A client that asks on and on and never reads is not served on and on.
#[test]
fn requests_wait_while_nobody_reads_the_replies() {
    let mut bench = Bench::new(Version::V10);
    let bytes: Vec<u8> = (0..100)
        .flat_map(|_| bench.bytes(&Request::GetRobotModel))
        .collect();
    let mut rest = &bytes[..];
    let (mut taken, mut replies) = (0, 0);
    while taken < 100 {
        let before = rest.len();
        while let Some(handled) = bench.robot.receive(&mut rest).expect("a connection") {
            assert_eq!(handled.refused, None);
            taken += 1;
        }
        assert!(before - rest.len() <= 8 * HEADER_LEN);
        let drained = bench.drain();
        assert!(!drained.is_empty());
        replies += drained.len();
    }
    assert_eq!(replies, 100);
}

#[test]
fn the_model_is_a_text_and_the_library_is_not_there() {
    for version in Version::ALL {
        let mut bench = Bench::new(version);
        if version >= Version::V8 {
            let id = bench.ask(&Request::GetRobotModel).id;
            let reply = Reply::RobotModel {
                status: ModelStatus::Success,
                urdf: MODEL,
            };
            assert_eq!(bench.drain(), [(id, format!("{reply:?}"))]);
        }
        if version <= Version::V9 {
            let handled = bench.ask(&Request::LoadModelLibrary {
                architecture: fci::request::Architecture::X64,
                system: fci::request::System::Linux,
            });
            let absent = Refused::Absent(Kind::LoadModelLibrary);
            assert_eq!(handled.refused, Some(absent));
            let reply = Reply::ModelLibrary {
                status: LibraryStatus::Error,
                library: &[],
            };
            assert_eq!(bench.drain(), [(handled.id, format!("{reply:?}"))]);
        }
    }
}

#[test]
fn a_second_client_finds_what_the_first_left() {
    let (mut bench, _) = Bench::running(Version::V10);
    bench.answered([0.5; 7]);
    bench.robot.disconnect();
    assert!(bench.drain().is_empty());
    let ended = bench.robot.ended().expect("a motion");
    assert_eq!(ended.status, fci::status::MoveStatus::Aborted);
    assert_eq!((ended.commands, ended.lost), (2, 0));
    assert_eq!(bench.unanswered(), fci::robot::Drive::Hold);
    bench.check_still(RobotMode::Idle);
    assert_eq!(bench.robot.client(), None);
    // A mode that needs a recovery stays.
    assert_eq!(bench.ask(&connect(10)).refused, None);
    bench.drain();
    bench.moving();
    bench.operator.user_stop = true;
    bench.unanswered();
    bench.robot.disconnect();
    bench.operator = Operator::ABSENT;
    bench.unanswered();
    bench.check_still(RobotMode::UserStopped);
}
