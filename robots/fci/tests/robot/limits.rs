//! What the robot watches in a motion, each limit at its number and beyond it.

use fci::request::CollisionBehavior;
use fci::robot::{Drive, Received, Refused};
use fci::status::{MoveStatus, RecoveryStatus};
use fci::{Request, RobotError, RobotErrors, RobotMode, Version};

use crate::bench::{Bench, READY, moved, recovered};

fn only(error: RobotError) -> RobotErrors {
    RobotErrors::NONE.with(error)
}

#[test]
fn torque_may_go_one_newton_metre_in_a_cycle() {
    for version in [Version::V5, Version::V10] {
        for joint in 0..7 {
            for sign in [1.0, -1.0] {
                let (mut bench, id) = Bench::running(version);
                let torque = |value: f64| {
                    let mut torque = [0.0; 7];
                    torque[joint] = sign * value;
                    torque
                };
                for value in [1.0, 2.0, 3.0, 2.0, 2.1, 3.1, 4.1] {
                    bench.answered(torque(value));
                    bench.check_moving();
                }
                let jump = bench.torque(torque(5.1001));
                let error = RobotError::ControllerTorqueDiscontinuity;
                assert_eq!(bench.command(&jump), Received::Reflex(error));
                assert_eq!(bench.unanswered(), Drive::Hold);
                bench.check_still(RobotMode::Reflex);
                assert_eq!(bench.state.errors, only(error));
                assert_eq!(bench.state.reflex_reason, only(error));
                assert_eq!(bench.drain(), [(id, moved(MoveStatus::ReflexAborted))]);
            }
        }
    }
}

#[test]
fn the_first_torque_is_compared_with_none() {
    let mut bench = Bench::new(Version::V10);
    bench.moving();
    let error = RobotError::ControllerTorqueDiscontinuity;
    assert_eq!(
        bench.command(&bench.torque([1.01; 7])),
        Received::Reflex(error)
    );
}

/// Beyond 87 and 12 Nm the torque is cut, and what is cut is compared.
#[test]
fn torque_beyond_the_limit_is_cut() {
    let (mut bench, _) = Bench::running(Version::V10);
    for k in 1..=100 {
        let value = f64::from(k);
        assert_eq!(bench.command(&bench.torque([value; 7])), Received::Accepted);
        let [big, small] = [value.min(87.0), value.min(12.0)];
        let expected = [big, big, big, big, small, small, small];
        assert_eq!(bench.robot.advance(), Drive::Torque(expected));
        bench.cycle();
        assert_eq!(bench.state.tau_j_d, expected);
    }
}

/// What the arm does in the next cycle, and the error that this is.
fn reflex(version: Version, change: impl Fn(&mut Bench)) -> RobotErrors {
    let (mut bench, id) = Bench::running(version);
    change(&mut bench);
    bench.answered([0.0; 7]);
    if bench.state.robot_mode == RobotMode::Move {
        return RobotErrors::NONE;
    }
    bench.check_still(RobotMode::Reflex);
    assert_eq!(bench.state.errors, bench.state.reflex_reason);
    assert_eq!(bench.drain(), [(id, moved(MoveStatus::ReflexAborted))]);
    bench.state.errors
}

#[test]
fn joints_are_kept_in_their_ranges() {
    let error = only(RobotError::JointPositionLimitsViolation);
    for (version, joint, inside, outside) in [
        (Version::V5, 0, 2.8973, 2.8974),
        (Version::V5, 3, -0.0698, -0.0697),
        (Version::V5, 3, -3.0718, -3.0719),
        (Version::V5, 5, -0.0175, -0.0176),
        (Version::V10, 1, -1.7837, -1.7838),
        (Version::V10, 3, -0.1518, -0.1517),
        (Version::V10, 5, 0.5445, 0.5444),
        (Version::V10, 5, 4.5169, 4.517),
    ] {
        let at = |q| reflex(version, |bench| bench.arm.q[joint] = q);
        assert_eq!(at(inside), RobotErrors::NONE, "{joint}");
        assert_eq!(at(outside), error, "{joint}");
        assert_eq!(at(f64::NAN), error, "{joint}");
    }
}

#[test]
fn joints_and_end_effector_are_kept_below_their_speeds() {
    let error = only(RobotError::JointVelocityViolation);
    for (version, joint, speed) in [
        (Version::V5, 0, 2.175),
        (Version::V5, 6, 2.61),
        (Version::V10, 0, 2.62),
        (Version::V10, 4, 5.26),
        (Version::V10, 6, 5.26),
    ] {
        for sign in [1.0, -1.0] {
            let at = |dq: f64| reflex(version, |bench| bench.arm.dq[joint] = sign * dq);
            assert_eq!(at(speed), RobotErrors::NONE, "{joint}");
            assert_eq!(at(speed + 1e-4), error, "{joint}");
        }
    }
    // Near its end joint 1 of the FR3 is slower: -0.3 + sqrt(2 * 6 * (2.7501 - 2.5)) = 1.4324.
    let near = |sign: f64, dq: f64| {
        reflex(Version::V10, |bench| {
            bench.arm.q[0] = sign * 2.5;
            bench.arm.dq[0] = dq;
        })
    };
    assert_eq!(near(1.0, 1.432), RobotErrors::NONE);
    assert_eq!(near(1.0, 1.433), error);
    assert_eq!(near(-1.0, -1.433), error);
    // Away from it it may be as fast as anywhere.
    assert_eq!(near(1.0, -2.6), RobotErrors::NONE);

    let error = only(RobotError::CartesianVelocityViolation);
    for (version, linear) in [(Version::V5, 1.7), (Version::V10, 3.0)] {
        let at = |axis: usize, v| reflex(version, |bench| bench.arm.twist[axis] = v);
        assert_eq!(at(1, -linear), RobotErrors::NONE);
        assert_eq!(at(1, linear + 1e-3), error);
        assert_eq!(at(4, 2.5), RobotErrors::NONE);
        assert_eq!(at(4, 2.501), error);
    }
}

/// The end effector that a client has set is what is fast.
#[test]
fn the_end_effector_is_faster_than_the_flange() {
    let turning = |length: f64| {
        let mut bench = Bench::new(Version::V5);
        let mut frame = fci::robot::IDENTITY;
        frame[12] = length;
        assert_eq!(bench.ask(&Request::SetNeToEe(frame)).refused, None);
        bench.drain();
        bench.moving();
        bench.arm.twist = [0.0, 0.0, 0.0, 0.0, 0.0, 2.0];
        bench.unanswered();
        assert_eq!(bench.state.o_t_ee[12], 0.3 + length);
        bench.state.errors
    };
    assert_eq!(turning(0.84), RobotErrors::NONE);
    assert_eq!(turning(0.86), only(RobotError::CartesianVelocityViolation));
}

#[test]
fn torque_sensors_have_an_end() {
    let error = only(RobotError::TauJRangeViolation);
    let at = |joint: usize, torque| reflex(Version::V5, |bench| bench.arm.tau_j[joint] = torque);
    assert_eq!(at(1, -100.0), RobotErrors::NONE);
    assert_eq!(at(1, -101.0), error);
    assert_eq!(at(6, 15.1), error);
}

fn thresholds(torque: f64, force: f64) -> Request {
    let ([lower, upper], [force_lower, force_upper]) = (
        [[torque / 2.0; 7], [torque; 7]],
        [[force / 2.0; 6], [force; 6]],
    );
    Request::SetCollisionBehavior(CollisionBehavior {
        lower_torque_acceleration: lower,
        upper_torque_acceleration: upper,
        lower_torque_nominal: lower,
        upper_torque_nominal: upper,
        lower_force_acceleration: force_lower,
        upper_force_acceleration: force_upper,
        lower_force_nominal: force_lower,
        upper_force_nominal: force_upper,
    })
}

/// Thresholds of 8 Nm and 16 N, and an arm that is pushed for 0.2 s.
fn pushed(tau_ext: f64, force: f64) -> Bench {
    let mut bench = Bench::new(Version::V10);
    assert_eq!(bench.ask(&thresholds(8.0, 16.0)).refused, None);
    bench.drain();
    bench.moving();
    bench.arm.tau_ext[2] = tau_ext;
    bench.arm.wrench[1] = force;
    for _ in 0..200 {
        bench.robot.advance();
        bench.cycle();
    }
    bench
}

#[test]
fn contact_is_reported_and_a_collision_aborts() {
    let bench = pushed(3.9, -7.9);
    bench.check_moving();
    assert_eq!(bench.state.joint_contact, [0.0; 7]);
    assert!((bench.state.tau_ext_hat_filtered[2] - 3.9).abs() < 1e-6);
    assert!((bench.state.o_f_ext_hat_k[1] + 7.9).abs() < 1e-6);

    let bench = pushed(7.9, -15.9);
    bench.check_moving();
    assert_eq!(bench.state.joint_contact[2], 1.0);
    assert_eq!(bench.state.cartesian_contact[1], 1.0);
    assert_eq!(bench.state.joint_collision, [0.0; 7]);

    for (torque, force, error) in [
        (-8.1, 0.0, RobotError::JointReflex),
        (0.0, 16.1, RobotError::CartesianReflex),
    ] {
        let mut bench = pushed(torque, force);
        bench.check_still(RobotMode::Reflex);
        assert_eq!(bench.state.errors, only(error));
        let collision =
            |bench: &Bench| bench.state.joint_collision[2] + bench.state.cartesian_collision[1];
        // The collision stays until the recovery, the contact does not.
        bench.arm = crate::bench::rest();
        for _ in 0..200 {
            bench.unanswered();
        }
        assert_eq!(collision(&bench), 1.0);
        assert_eq!(bench.state.joint_contact, [0.0; 7]);
        bench.drain();
        assert_eq!(bench.recover()[0].1, recovered(RecoveryStatus::Success));
        assert_eq!(collision(&bench), 0.0);
    }
}

/// A pole at 30 Hz: a step is through by 1 - 1/e in 5.3 ms.
#[test]
fn the_external_torque_is_filtered() {
    let mut bench = Bench::new(Version::V5);
    bench.arm.tau_ext = [10.0; 7];
    let mut cycles = 0;
    while bench.state.tau_ext_hat_filtered[0] < 10.0 * (1.0 - (-1.0_f64).exp()) {
        bench.unanswered();
        cycles += 1;
    }
    assert_eq!(cycles, 6);
}

/// A joint beyond its range is no matter for the robot itself.
#[test]
fn a_joint_beyond_its_range_asks_for_a_hand() {
    let (mut bench, _) = Bench::running(Version::V10);
    bench.arm.q[3] = 0.0;
    bench.unanswered();
    bench.check_still(RobotMode::Reflex);
    bench.drain();
    let handled = bench.ask(&Request::AutomaticErrorRecovery);
    assert_eq!(handled.refused, Some(Refused::Beyond { joint: 4 }));
    let expected = recovered(RecoveryStatus::ManualRecoveryRequired);
    assert_eq!(bench.drain(), [(handled.id, expected)]);
    bench.arm.q = READY;
    bench.unanswered();
    assert_eq!(bench.recover()[0].1, recovered(RecoveryStatus::Success));
}

#[test]
fn nothing_is_watched_without_a_motion() {
    let mut bench = Bench::new(Version::V10);
    bench.arm.tau_j = [1e3; 7];
    bench.arm.dq = [10.0; 7];
    bench.arm.tau_ext = [50.0; 7];
    for _ in 0..50 {
        bench.unanswered();
    }
    bench.check_still(RobotMode::Idle);
    assert_eq!(bench.state.joint_contact, [1.0; 7]);
    assert_eq!(bench.state.joint_collision, [0.0; 7]);
}
