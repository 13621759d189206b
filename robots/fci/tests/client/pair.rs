//! Both ends of the crate, byte by byte: the machine against the robot's end, which is held against the
//! vendor's clients.

use fci::client::{Cause, Client, Duty, Event, Facts, Phase, Stop};
use fci::robot::{Arm, IDENTITY, Limits, Operator, Robot, Settings};
use fci::{Command, RobotError, RobotErrors, StatePacket, Version, command, state};

use crate::scripted::{START, URDF};

/// The usual posture, in the ranges of both arms.
const READY: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

/// Two ends of a connection.
struct Pair {
    client: Client,
    robot: Robot<&'static [u8]>,
    operator: Operator,
    arm: Arm,
    /// Torque that the client commands \[Nm\].
    torque: f64,
    /// Cycles that are left in which nothing of the client arrives.
    gone: u32,
    answers: u32,
}

impl Pair {
    fn new(version: Version, may_recover: bool) -> Self {
        let mut o_t_f = IDENTITY;
        o_t_f[12..15].copy_from_slice(&[0.3, 0.0, 0.6]);
        let mut client = Client::new(may_recover);
        client.connected(50_000);
        let limits = if version == Version::V5 {
            Limits::PANDA
        } else {
            Limits::FR3
        };
        Self {
            client,
            robot: Robot::new(Settings::new(version, limits), URDF.as_bytes()),
            operator: Operator::ABSENT,
            arm: Arm {
                q: READY,
                dq: [0.0; 7],
                tau_j: [0.0; 7],
                tau_ext: [0.0; 7],
                wrench: [0.0; 6],
                o_t_f,
                twist: [0.0; 6],
                theta: READY,
                dtheta: [0.0; 7],
            },
            torque: 0.0,
            gone: 0,
            answers: 0,
        }
    }

    fn cycle(&mut self) {
        if self.client.wants_new_connection() {
            self.robot.disconnect();
            self.client.connected(50_000);
        }
        let sent = self.client.transmit().to_vec();
        self.client.transmitted(sent.len());
        let mut rest = &sent[..];
        while let Some(_handled) = self.robot.receive(&mut rest).expect("a request") {}
        let mut room = [0; 11];
        loop {
            let count = self.robot.replies(&mut room);
            if count == 0 {
                break;
            }
            self.client.receive(&room[..count], &mut ());
        }
        let version = self.robot.version();
        let mut room = [0; state::LEN_MAX];
        let state = self.robot.state(&self.arm, &self.operator);
        let datagram = state.emit(version, &mut room).expect("a state");
        let connected = version == self.client.version() && self.robot.client().is_some();
        if connected {
            let packet = StatePacket::new_checked(version, datagram).expect("a state");
            let duty = self.client.state(&Facts::of(&packet));
            if self.gone > 0 {
                self.gone -= 1;
            } else if duty != Duty::Listen {
                let last = duty == Duty::Finish;
                let answer = Command::torque(version, packet.message_id(), [self.torque; 7], last);
                let mut room = [0; command::LEN_MAX];
                let bytes = answer.emit(version, &mut room);
                self.robot.command(bytes);
                self.answers += 1;
            }
        }
        self.robot.advance();
        if self.client.phase() == Phase::Ready {
            self.client.start(&START);
        }
    }

    /// Until the motion has run for so many answers.
    fn moving(&mut self, answers: u32) {
        for _ in 0..10_000 {
            if self.answers >= answers {
                return;
            }
            self.cycle();
        }
        panic!("no motion: {:?}", self.client.phase());
    }

    fn end(&mut self) -> Stop {
        for _ in 0..3000 {
            self.cycle();
            if let Some(stop) = self.client.stopped() {
                return stop;
            }
        }
        panic!("no end: {:?}", self.client.phase());
    }
}

#[test]
fn a_motion_from_connect_to_its_second_reply_in_every_version() {
    for version in Version::ALL {
        let mut pair = Pair::new(version, false);
        pair.moving(2000);
        pair.client.finish();
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
        let mut pair = Pair::new(Version::V10, false);
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
    let halt = motion(|pair| pair.client.halt());
    assert_eq!(halt, Cause::Halted);
    let limit = motion(|pair| pair.arm.q[3] = 0.5);
    assert_eq!(limit, reflex(RobotError::JointPositionLimitsViolation));
}

#[test]
fn nineteen_lost_commands_are_borne() {
    let mut pair = Pair::new(Version::V10, false);
    for _ in 0..50 {
        pair.moving(pair.answers + 30);
        pair.gone = 19;
        pair.cycle();
    }
    pair.moving(pair.answers + 30);
    pair.client.finish();
    assert_eq!(pair.end().cause, Cause::Finished);
    assert_eq!(pair.robot.counters().reflexes, 0);
}

#[test]
fn recovery_on_request_leaves_the_robot_idle() {
    for may_recover in [false, true] {
        let mut pair = Pair::new(Version::V5, may_recover);
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
    let mut pair = Pair::new(Version::V10, false);
    pair.operator.ready = false;
    let stop = pair.end();
    assert_eq!(
        (stop.cause.event(), stop.exit_code()),
        (Event::WrongMode, 4)
    );
    assert_eq!(pair.answers, 0);
}
