//! Conversations in good order.

use fci::client::{Cause, Client, Duty, Facts, Phase, Stop};
use fci::status::{ConnectStatus, ModelStatus, MoveStatus};
use fci::{Kind, Move, Request, RobotMode, Version};

use crate::scripted::{Host, Robot, START, URDF, Wish, talk};

#[test]
fn every_version_in_the_order_of_the_vendors_client() {
    for version in Version::ALL {
        for (reply_late, padding, piece) in [(0, 0, 1), (3, 3, 5), (-3, 100, 4096)] {
            let mut robot = Robot::new(version);
            (robot.reply_late, robot.padding, robot.piece) = (reply_late, padding, piece);
            let (stop, client, host) = talk(&mut robot, false, Wish::Finish(100));
            let cause = Cause::Finished;
            let expected = Stop {
                cause,
                in_motion: true,
            };
            assert_eq!(stop, expected, "{version:?} {reply_late}");
            assert_eq!((stop.exit_code(), client.version()), (0, version));

            let mut kinds: Vec<Kind> = robot.heard.iter().map(Request::kind).collect();
            if version != Version::V10 {
                assert_eq!(kinds.remove(0), Kind::Connect, "as 10 first");
            }
            let mut wanted = vec![Kind::Connect];
            if version >= Version::V8 {
                wanted.push(Kind::GetRobotModel);
                assert_eq!(host.urdf[..URDF.len()], *URDF.as_bytes());
                assert_eq!(client.model(), Some(ModelStatus::Success));
            } else {
                assert_eq!((host.urdf.len(), client.model()), (0, None));
            }
            wanted.extend([Kind::SetCollisionBehavior, Kind::SetLoad, Kind::Move]);
            assert_eq!(kinds, wanted, "{version:?}");
            let motion = Request::Move(Move::torque(version));
            assert_eq!(robot.heard.last(), Some(&motion));
            let (thresholds, load) = (START.thresholds, START.load);
            assert!(
                robot
                    .heard
                    .contains(&Request::SetCollisionBehavior(thresholds))
            );
            assert!(robot.heard.contains(&Request::SetLoad(load)));
        }
    }
}

#[test]
fn the_first_state_of_a_motion_is_not_answered_and_the_flag_goes_out_until_the_end() {
    let mut robot = Robot::new(Version::V10);
    robot.reply_late = 4;
    let (_, _, host) = talk(&mut robot, false, Wish::Finish(3));
    let motion: Vec<_> = host
        .duties
        .into_iter()
        .filter(|&duty| duty != Duty::Listen)
        .collect();
    let answers = [Duty::Answer, Duty::Answer, Duty::Answer, Duty::Finish];
    assert_eq!(motion, answers);
    // Started, and shown to the machine once before.
    assert_eq!((robot.answers, robot.last), (4, 1));

    // A robot that is slow to end it gets the last command with each state.
    let mut robot = Robot::new(Version::V10);
    robot.ends = false;
    let (mut client, mut host) = (Client::new(false), Host::default());
    client.connected(1);
    while robot.last < 20 {
        host.cycle(&mut client, &mut robot);
        client.start(&START);
        if robot.answers == 3 {
            client.finish();
        }
        robot.ends = robot.last == 19;
    }
    host.cycle(&mut client, &mut robot);
    assert_eq!(
        client.stopped().map(|stop| stop.cause),
        Some(Cause::Finished)
    );
}

#[test]
fn nothing_starts_before_it_is_asked_for() {
    let mut robot = Robot::new(Version::V10);
    let (mut client, mut host) = (Client::new(false), Host::default());
    client.start(&START);
    client.connected(1);
    for _ in 0..3000 {
        assert_eq!(host.cycle(&mut client, &mut robot), Duty::Listen);
    }
    assert_eq!(client.phase(), Phase::Ready);
    assert_eq!(robot.heard.len(), 2, "Connect, GetRobotModel");
    client.finish();
    let stop = client.stopped().expect("no motion to end");
    assert_eq!((stop.cause, stop.in_motion), (Cause::Finished, false));
}

#[test]
fn a_success_with_the_version_at_another_place_is_one_and_with_another_version_is_none() {
    // franky-sim fills up behind the status: the number is read as 10 * 256.
    let mut robot = Robot::new(Version::V10);
    robot.connect = Some((ConnectStatus::Success, 10 << 8));
    let (stop, client, _) = talk(&mut robot, false, Wish::Finish(5));
    assert_eq!(
        (stop.cause, client.version()),
        (Cause::Finished, Version::V10)
    );

    let mut robot = Robot::new(Version::V5);
    robot.connect = Some((ConnectStatus::Success, 5));
    let (stop, client, _) = talk(&mut robot, false, Wish::Finish(5));
    assert_eq!(
        (stop.cause, client.version()),
        (Cause::Finished, Version::V5)
    );
    assert_eq!(robot.heard(Kind::Connect), 2);
}

#[test]
fn a_robot_without_a_model_moves_and_it_is_told() {
    let mut robot = Robot::new(Version::V10);
    robot.model = ModelStatus::NotPossible;
    let (stop, client, _) = talk(&mut robot, false, Wish::Finish(5));
    assert_eq!(stop.cause, Cause::Finished);
    assert_eq!(client.model(), Some(ModelStatus::NotPossible));
}

#[test]
fn move_may_begin_with_success_and_wait_for_the_mode_idle() {
    let mut robot = Robot::new(Version::V10);
    robot.mode = RobotMode::Other;
    let (mut client, mut host) = (Client::new(false), Host::default());
    client.connected(1);
    for cycle in 0..900 {
        host.cycle(&mut client, &mut robot);
        client.start(&START);
        if cycle == 800 {
            assert_eq!(robot.heard(Kind::SetCollisionBehavior), 0);
            robot.mode = RobotMode::Idle;
        }
    }
    assert_eq!(client.phase(), Phase::Running);
}

#[test]
fn old_states_are_not_answered() {
    let mut robot = Robot::new(Version::V10);
    let (mut client, mut host) = (Client::new(false), Host::default());
    client.connected(1);
    while host.cycle(&mut client, &mut robot) == Duty::Listen {
        client.start(&START);
    }
    let facts = |message_id| Facts {
        message_id,
        robot_mode: RobotMode::Move,
        motion_generator_mode: fci::MotionGeneratorMode::None,
        controller_mode: fci::ControllerMode::External,
        ..Facts::default()
    };
    assert_eq!(client.state(&facts(u64::MAX - 1)), Duty::Answer);
    for old in [0, 1, 1_000_000, u64::MAX - 1] {
        assert_eq!(client.state(&facts(old)), Duty::Listen);
    }
    assert_eq!(client.state(&facts(u64::MAX)), Duty::Answer);
}

#[test]
fn a_wish_before_the_motion_runs_is_kept() {
    for (halt, cause) in [(false, Cause::Finished), (true, Cause::Halted)] {
        let mut robot = Robot::new(Version::V10);
        let (mut client, mut host) = (Client::new(false), Host::default());
        client.connected(1);
        let mut wished = false;
        for _ in 0..100 {
            host.cycle(&mut client, &mut robot);
            client.start(&START);
            // Move is on its way, or has started and no state shows it.
            if robot.heard(Kind::Move) == 1 && !wished {
                wished = true;
                if halt { client.halt() } else { client.finish() }
            }
        }
        let stop = client.stopped().expect("an end");
        assert_eq!((stop.cause, stop.in_motion), (cause, true));
        assert_eq!(robot.heard(Kind::StopMove), usize::from(halt));
        assert_eq!(robot.answers, robot.last, "never a torque");
    }
    assert_eq!(MoveStatus::Preempted.name(), "preempted");
}
