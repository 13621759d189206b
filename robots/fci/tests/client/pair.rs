//! Both ends of the crate, byte by byte: the machine against the robot's end, which is held against the
//! vendor's clients.

use fci::client::{Cause, Event, Stop};
use fci::{RobotError, RobotErrors, Version};

#[path = "../pair/mod.rs"]
mod ends;

use ends::{Pair, ToClient, URDF};

fn pair(version: Version, may_recover: bool) -> Pair {
    Pair::new(version, may_recover, URDF, None)
}

#[test]
fn a_motion_from_connect_to_its_second_reply_in_every_version() {
    for version in Version::ALL {
        let mut pair = pair(version, false);
        pair.moving(2000);
        pair.tell_client(ToClient::Finish);
        let stop = pair.end();
        assert_eq!(
            stop,
            Stop {
                cause: Cause::Finished,
                in_motion: true
            }
        );
        let counters = pair.robot.counters();
        assert_eq!(
            (counters.motions, counters.lost, counters.reflexes),
            (1, 0, 0)
        );
    }
}

/// What ends a motion at the robot ends it here, by the same name.
#[test]
fn causes_come_over_the_wire() {
    let motion = |change: fn(&mut Pair)| {
        let mut pair = pair(Version::V10, false);
        pair.moving(100);
        change(&mut pair);
        let stop = pair.end();
        assert!(stop.in_motion && stop.exit_code() != 4);
        stop.cause
    };
    let reflex = |error| Cause::Reflex(RobotErrors::NONE.with(error));
    let jump = motion(|pair| pair.torque = 1.5);
    assert_eq!(jump, reflex(RobotError::ControllerTorqueDiscontinuity));
    let lost = motion(|pair| pair.gone = 20);
    assert_eq!(lost, reflex(RobotError::CommunicationConstraintsViolation));
    assert_eq!(lost.event(), Event::Lost);
    let user = motion(|pair| pair.operator.user_stop = true);
    assert_eq!(user, Cause::UserStop);
    let halt = motion(|pair| {
        pair.tell_client(ToClient::Halt);
    });
    assert_eq!(halt, Cause::Halted);
    let limit = motion(|pair| pair.arm.q[3] = 0.5);
    assert_eq!(limit, reflex(RobotError::JointPositionLimitsViolation));
}

#[test]
fn nineteen_lost_commands_are_borne() {
    let mut pair = pair(Version::V10, false);
    for _ in 0..50 {
        pair.moving(pair.answers + 30);
        pair.gone = 19;
        pair.cycle();
    }
    pair.moving(pair.answers + 30);
    pair.tell_client(ToClient::Finish);
    assert_eq!(pair.end().cause, Cause::Finished);
    assert_eq!(pair.robot.counters().reflexes, 0);
}

#[test]
fn recovery_on_request_leaves_the_robot_idle() {
    for may_recover in [false, true] {
        let mut pair = pair(Version::V5, may_recover);
        pair.moving(100);
        pair.torque = 5.0;
        let stop = pair.end();
        assert_eq!(stop.cause.event(), Event::Reflex);
        pair.cycle();
        let idle = pair.robot.mode() == fci::RobotMode::Idle;
        assert_eq!(idle, may_recover);
    }
}

#[test]
fn a_robot_that_takes_no_motion_says_so() {
    let mut pair = pair(Version::V10, false);
    pair.operator.ready = false;
    let stop = pair.end();
    assert_eq!(
        (stop.cause.event(), stop.exit_code()),
        (Event::WrongMode, 4)
    );
    assert_eq!(pair.answers, 0);
}
