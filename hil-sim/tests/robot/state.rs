//! In command state: what ends it, what is bridged, and the way back.

use cell::names::PlantKind::{Ideal, Realistic};
use fri::InterfaceState;
use hil_sim::robot::State;

use crate::client::{Loop, robot};

#[test]
fn ten_missing_answers_are_bridged_and_eleven_are_not() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    link.run(10, |_, _| false);
    assert_eq!(link.robot.control_box().state(), State::Command);
    link.polite(300);
    assert_eq!(link.robot.control_box().state(), State::Command);
    link.run(11, |_, _| false);
    assert_eq!(link.robot.control_box().state(), State::Monitor);
    assert!(link.said("monitor state: 11 answers missing in a row"));
    // Back by itself, also with a client that counts anew.
    link.client.counter = 3;
    link.enter();
    let figures = link.robot.summary().link.expect("a link");
    assert_eq!((figures.fallbacks, figures.recoveries), (1, 1));
    assert_eq!(figures.missed, 21);
}

#[test]
fn losses_that_add_up_end_command_state() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    let mut n = 0;
    link.run(300, |_, _| {
        n += 1;
        n % 4 != 0
    });
    assert!(link.said("link unacceptable"), "{:?}", link.robot.events());
}

#[test]
fn flags_must_stay() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    link.client.flags = 0x15;
    link.polite(1);
    assert_eq!(link.robot.control_box().state(), State::Monitor);
    assert!(link.said("cmdFlags changed in command state"));
    link.enter();
}

/// What a client sends after it lost its measurement: all zeros.
#[test]
fn a_jump_of_position_is_not_used() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    link.run(5, |_, command| {
        command.joint_position = [0.0; 7];
        command.joint_torque = [50.0; 7];
        true
    });
    assert_eq!(link.robot.control_box().state(), State::Command);
    link.polite(1);
    assert!(link.robot.plant().state().dq.amax() < 1e-3);
    let figures = link.robot.summary().link.expect("a link");
    assert_eq!((figures.rejected.jump, figures.missed), (5, 5));
    assert!(link.said("jntPos of joint 2 jumps by"));
}

/// A damaged answer may order anything: neither motors nor figures take it.
#[test]
fn a_torque_that_no_client_can_mean_is_not_used() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    link.polite(600);
    let row = [6.7e21, -f32::MAX, 76.1];
    let mut torques = row.iter();
    link.run(row.len(), |_, command| {
        command.joint_torque[6] = *torques.next().expect("one each");
        true
    });
    link.run(1, |_, command| {
        command.user.real[..7].fill(-6.7e21);
        true
    });
    assert_eq!(link.robot.control_box().state(), State::Command);
    link.polite(1);
    assert!(link.robot.plant().state().dq.amax() < 1e-3);
    let summary = link.robot.summary();
    let figures = summary.link.as_ref().expect("a link");
    assert_eq!((figures.rejected.torque, figures.missed), (3, 3));
    assert_eq!(figures.rejected.total(), 3);
    assert!(figures.largest_torque_step_nm < 1.0);
    assert!(link.said("addJntTrq of joint 7 is 67"));
    let residual = &summary.residual;
    assert!(
        residual.rms_error_nm.is_some_and(|rms| rms < 200.0),
        "{residual:?}"
    );
}

/// With stiffness jntPos moves the arm, so it may only move as fast as the arm.
#[test]
fn the_speed_of_the_commanded_position_is_limited() {
    let mut link = Loop::new(robot(Ideal));
    let stiff = |command: &mut fri::Command| {
        command.joint_stiffness = [500.0; 7];
        command.joint_damping = [0.7; 7];
    };
    link.run(300, |_, command| {
        stiff(command);
        true
    });
    assert_eq!(link.robot.control_box().state(), State::Command);
    let mut goal = None;
    // 1.1 x 110 deg/s x 2 ms = 4.2 mrad a cycle.
    link.run(100, |msr, command| {
        stiff(command);
        let goal = goal.get_or_insert(msr.total_commanded_position());
        goal[0] += 0.002;
        command.joint_position = *goal;
        true
    });
    assert_eq!(
        link.robot.control_box().state(),
        State::Command,
        "{:?}",
        link.robot.events()
    );
    assert_eq!(link.robot.summary().link.expect("a link").rejected.jump, 0);
    link.run(5, |msr, command| {
        stiff(command);
        command.joint_position = msr.total_commanded_position();
        command.joint_position[0] += 0.03;
        true
    });
    assert!(link.robot.summary().link.expect("a link").rejected.jump > 0);
}

#[test]
fn a_summary_before_anything_happened_is_one() {
    let summary = robot(Realistic).summary();
    assert!(serde_json::to_string(&summary).is_ok());
    assert_eq!(summary.cycles, 0);
}

/// What a measurement says fits together.
#[test]
fn the_measurement_is_consistent() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    link.run(3, |msr, _| {
        assert_eq!(msr.state, InterfaceState::Command);
        assert_eq!((msr.quality, msr.user.int[1]), (fri::Quality::Perfect, 1));
        assert_eq!((msr.period_s, msr.command_period_s), (0.002, 0.002));
        assert_eq!(msr.statistics.answer_rate, 1.0);
        let total = msr.total_commanded_position();
        for i in 0..7 {
            assert!((total[i] - msr.joint_position[i]).abs() < 1e-2);
            assert!((msr.joint_torque[i] - msr.gravity[i]).abs() < 1.0);
            assert_eq!(msr.external_torque[i], 0.0);
            for j in 0..7 {
                assert_eq!(msr.mass_matrix[i][j], msr.mass_matrix[j][i]);
            }
        }
        true
    });
}

/// A push along +q is a positive external torque.
#[test]
fn external_torque_is_positive_along_q() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    let point = cell::scenario::PointSpec::Name("flange".into());
    link.robot.push(point, [0.0, 0.0, 5.0], 1.0);
    link.polite(100);
    link.run(1, |msr, _| {
        for joint in 0..7 {
            let expected = msr.jacobian[2][joint] * 5.0;
            assert!((msr.external_torque[joint] - expected).abs() < 1e-3);
        }
        assert!((msr.external_wrench[2] - 5.0).abs() < 0.1);
        true
    });
    link.robot.release();
    link.polite(60);
    link.run(1, |msr, _| {
        assert_eq!(msr.external_torque, [0.0; 7]);
        true
    });
}
