//! Every event of the table: what is seen makes it, and what is done follows.

use fci::client::{Cause, Client, Duty, Event, Phase, Stop};
use fci::status::{ConnectStatus, MoveStatus, RecoveryStatus, SetterStatus};
use fci::{Kind, RobotError, RobotErrors, RobotMode, Version};

use crate::scripted::{Abort, Host, Robot, START, Wish, talk};

/// Ways to an event: the robot, what the host wishes.
fn ways(event: Event) -> Vec<(bool, Robot, Wish)> {
    let robot = || Robot::new(Version::V10);
    let with = |change: &dyn Fn(&mut Robot)| {
        let mut robot = robot();
        change(&mut robot);
        robot
    };
    let one = |error| RobotErrors::NONE.with(error);
    let abort = |mode, reasons, status| {
        with(&|robot| {
            robot.abort = Some(Abort {
                answers: 50,
                mode,
                reasons,
                status,
            });
        })
    };
    let (reflex, none) = (RobotMode::Reflex, RobotErrors::NONE);
    match event {
        Event::Finished => vec![(true, robot(), Wish::Finish(10))],
        Event::Halted => vec![
            (true, robot(), Wish::Halt(10)),
            (false, robot(), Wish::Halt(0)),
        ],
        Event::UserStop => {
            let status = Some(MoveStatus::EmergencyAborted);
            vec![
                (
                    true,
                    abort(RobotMode::UserStopped, none, status),
                    Wish::Nothing,
                ),
                (
                    true,
                    abort(RobotMode::UserStopped, none, None),
                    Wish::Nothing,
                ),
                (
                    false,
                    with(&|robot| robot.mode = RobotMode::UserStopped),
                    Wish::Nothing,
                ),
            ]
        }
        Event::Reflex => {
            let reason = one(RobotError::JointReflex);
            let status = Some(MoveStatus::ReflexAborted);
            let found = with(&|robot| {
                robot.mode = reflex;
                robot.reasons = reason;
            });
            vec![
                (true, abort(reflex, reason, status), Wish::Nothing),
                (true, abort(reflex, reason, None), Wish::Nothing),
                (true, abort(RobotMode::Idle, reason, status), Wish::Nothing),
                (false, found, Wish::Nothing),
            ]
        }
        Event::Lost => {
            let reason = one(RobotError::CommunicationConstraintsViolation);
            let status = Some(MoveStatus::ReflexAborted);
            vec![(true, abort(reflex, reason, status), Wish::Nothing)]
        }
        Event::WrongMode => vec![
            (
                true,
                abort(RobotMode::Guiding, none, Some(MoveStatus::Aborted)),
                Wish::Nothing,
            ),
            (true, abort(RobotMode::Other, none, None), Wish::Nothing),
            (
                false,
                with(&|robot| robot.mode = RobotMode::Other),
                Wish::Nothing,
            ),
            (
                false,
                with(&|robot| robot.mode = RobotMode::Guiding),
                Wish::Nothing,
            ),
        ],
        Event::Aborted => {
            let all = [
                MoveStatus::Success,
                MoveStatus::Preempted,
                MoveStatus::PreemptedBySafety,
                MoveStatus::EmergencyAborted,
                MoveStatus::InputErrorAborted,
                MoveStatus::Aborted,
            ];
            let of = |status| {
                (
                    true,
                    abort(RobotMode::Idle, none, Some(status)),
                    Wish::Nothing,
                )
            };
            all.map(of).into()
        }
        Event::Refused => {
            let mut all: Vec<_> = SetterStatus::all()
                .filter(|&status| status != SetterStatus::Success)
                .map(|status| with(&|robot| robot.setter = status))
                .collect();
            let started = |status: &MoveStatus| {
                !matches!(status, MoveStatus::Success | MoveStatus::MotionStarted)
            };
            let statuses = MoveStatus::all().filter(started);
            all.extend(statuses.map(|status| with(&|robot| robot.started = status)));
            all.into_iter()
                .map(|robot| (false, robot, Wish::Nothing))
                .collect()
        }
        Event::Version => {
            let of = |connect| {
                let robot = with(&|robot| robot.connect = Some(connect));
                (false, robot, Wish::Nothing)
            };
            let incompatible = ConnectStatus::IncompatibleVersion;
            [0, 4, 7, 10, 11, 65_535]
                .map(|version| of((incompatible, version)))
                .into()
        }
        Event::Late => {
            let deaf = |kind| {
                (
                    false,
                    with(&|robot| robot.deaf_to = Some(kind)),
                    Wish::Nothing,
                )
            };
            let mut all: Vec<_> = [
                Kind::GetRobotModel,
                Kind::SetCollisionBehavior,
                Kind::SetLoad,
                Kind::Move,
            ]
            .map(deaf)
            .into();
            all.extend([
                (true, with(&|robot| robot.moves = false), Wish::Nothing),
                (true, with(&|robot| robot.ends = false), Wish::Finish(10)),
                (true, abort(RobotMode::Idle, none, None), Wish::Nothing),
            ]);
            all
        }
        Event::Closed => vec![
            (true, robot(), Wish::Close(10)),
            (false, robot(), Wish::Close(0)),
        ],
        Event::Silent => vec![
            (true, robot(), Wish::Silence(10)),
            (false, robot(), Wish::Silence(0)),
        ],
        // Bytes that are no message: with them below.
        Event::Protocol => Vec::new(),
    }
}

/// A stop goes on for ever: nothing more is sent, no state is answered.
fn stays(client: &mut Client, host: &mut Host, robot: &mut Robot, stop: Stop) {
    let (heard, answers) = (robot.heard.len(), robot.answers);
    for _ in 0..50 {
        assert_eq!(host.cycle(client, robot), Duty::Listen);
        client.start(&START);
        client.finish();
        client.halt();
        client.closed();
        client.connected(1);
    }
    assert_eq!(client.stopped(), Some(stop));
    assert_eq!((robot.heard.len(), robot.answers), (heard, answers));
}

#[test]
fn each_event_comes_from_what_the_table_says_and_ends_with_its_exit_code() {
    for event in Event::ALL {
        let ways = ways(event);
        assert_eq!(ways.is_empty(), event == Event::Protocol, "{event}");
        for (number, (in_motion, mut robot, wish)) in ways.into_iter().enumerate() {
            let (stop, mut client, mut host) = talk(&mut robot, false, wish);
            let at = format!("{event}, way {number}: {stop:?}");
            assert_eq!(stop.cause.event(), event, "{at}");
            assert_eq!(stop.in_motion, in_motion, "{at}");
            let code = match event {
                Event::Finished => 0,
                Event::Halted => 3,
                _ if in_motion => 3,
                _ => 4,
            };
            assert_eq!(stop.exit_code(), code, "{at}");
            assert_eq!(robot.heard(Kind::AutomaticErrorRecovery), 0, "{at}");
            if !in_motion {
                assert_eq!(robot.answers, 0, "{at}");
            }
            stays(&mut client, &mut host, &mut robot, stop);
        }
    }
}

#[test]
fn texts_have_the_numbers_and_names() {
    let text = |robot: &mut Robot| talk(robot, false, Wish::Nothing).0.to_string();
    let mut robot = Robot::new(Version::V10);
    robot.connect = Some((ConnectStatus::IncompatibleVersion, 4));
    assert_eq!(
        text(&mut robot),
        "version of the robot: 4; tried: 10; allowed: 5 to 10"
    );
    // The robot names 7, and then refuses that as well.
    robot.connect = Some((ConnectStatus::IncompatibleVersion, 7));
    robot.version = Version::V7;
    assert_eq!(
        text(&mut robot),
        "version of the robot: 7; tried: 7; allowed: 5 to 10"
    );

    let mut robot = Robot::new(Version::V10);
    robot.setter = SetterStatus::InvalidArgument;
    let expected = "SetCollisionBehavior refused: invalid argument, in robot mode idle";
    assert_eq!(text(&mut robot), expected);

    let mut robot = Robot::new(Version::V10);
    robot.abort = Some(Abort {
        answers: 1,
        mode: RobotMode::Reflex,
        reasons: [RobotError::JointReflex, RobotError::CartesianReflex]
            .into_iter()
            .collect(),
        status: Some(MoveStatus::ReflexAborted),
    });
    assert_eq!(text(&mut robot), "reflex: joint_reflex, cartesian_reflex");
}

/// Once, and only on request: behind a reflex in the motion, and before one.
#[test]
fn recovery_is_asked_for_once() {
    let reasons = RobotErrors::NONE.with(RobotError::JointReflex);
    for status in RecoveryStatus::all() {
        let mut robot = Robot::new(Version::V10);
        robot.recovery = status;
        robot.abort = Some(Abort {
            answers: 50,
            mode: RobotMode::Reflex,
            reasons,
            status: Some(MoveStatus::ReflexAborted),
        });
        let (stop, mut client, mut host) = talk(&mut robot, true, Wish::Nothing);
        assert_eq!((stop.cause, stop.exit_code()), (Cause::Reflex(reasons), 3));
        assert_eq!(client.recovery(), Some(status));
        assert_eq!(robot.heard(Kind::AutomaticErrorRecovery), 1);
        stays(&mut client, &mut host, &mut robot, stop);

        // Found in a reflex: it moves, and the next reflex is left alone.
        let mut robot = Robot::new(Version::V10);
        robot.recovery = status;
        robot.mode = RobotMode::Reflex;
        robot.reasons = reasons;
        robot.abort = Some(Abort {
            answers: 50,
            mode: RobotMode::Reflex,
            reasons,
            status: Some(MoveStatus::ReflexAborted),
        });
        let (stop, _, _) = talk(&mut robot, true, Wish::Nothing);
        assert_eq!(robot.heard(Kind::AutomaticErrorRecovery), 1);
        if status == RecoveryStatus::Success {
            assert_eq!((stop.cause, stop.in_motion), (Cause::Reflex(reasons), true));
        } else {
            assert_eq!(
                (stop.cause.event(), stop.in_motion),
                (Event::Refused, false)
            );
            assert!(stop.to_string().contains(status.name()), "{stop}");
        }
    }
}

#[test]
fn what_is_known_of_the_end_counts_more_than_a_lost_link() {
    // The reflex is seen, and the cable is out before the second reply comes.
    let reasons = RobotErrors::NONE.with(RobotError::PowerLimitViolation);
    let mut robot = Robot::new(Version::V5);
    robot.abort = Some(Abort {
        answers: 5,
        mode: RobotMode::Reflex,
        reasons,
        status: None,
    });
    let (mut client, mut host) = (Client::new(false), Host::default());
    client.connected(1);
    while robot.answers < 5 {
        host.cycle(&mut client, &mut robot);
        client.start(&START);
    }
    host.cycle(&mut client, &mut robot);
    assert_eq!(client.phase(), Phase::Ending);
    client.silent();
    assert_eq!(
        client.stopped().map(|stop| stop.cause),
        Some(Cause::Reflex(reasons))
    );
}

/// A table whose rows say something, each another thing.
#[test]
fn rows_of_the_table_differ() {
    let names: std::collections::BTreeSet<_> =
        Event::ALL.iter().map(|event| event.name()).collect();
    assert_eq!(names.len(), Event::ALL.len());
    for event in Event::ALL {
        assert_eq!(event.example().event(), event);
        assert!(!event.seen().is_empty() && !event.done().is_empty());
    }
}

/// The table in the documentation. `UPDATE=1` writes it anew.
#[test]
fn table_of_the_documentation() {
    const BEGIN: &str = "<!-- events: made by robots/fci/tests/client/events.rs -->\n";
    const END: &str = "<!-- end of events -->\n";
    let mut table = String::from(
        "| event | what is seen | what the client does | before | in it | text, for example |\n\
         |---|---|---|---|---|---|\n",
    );
    for event in Event::ALL {
        let [before, within] = [false, true].map(|in_motion| event.exit_code(in_motion));
        let (seen, done, text) = (event.seen(), event.done(), event.example());
        table += &format!("| {event} | {seen} | {done} | {before} | {within} | {text} |\n");
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/robots.md");
    let text = std::fs::read_to_string(path).expect("the document");
    let (head, rest) = text.split_once(BEGIN).expect("the begin of the table");
    let (committed, tail) = rest.split_once(END).expect("the end of the table");
    if std::env::var_os("UPDATE").is_some() {
        let text = format!("{head}{BEGIN}{table}{END}{tail}");
        std::fs::write(path, text).expect("the document");
    } else {
        assert_eq!(committed, table, "UPDATE=1 cargo test -p fci --test client");
    }
}
