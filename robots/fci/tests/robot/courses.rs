//! Motions: how they begin, run and end.

use fci::robot::{Drive, Motions, Operator, Received, Refused};
use fci::status::{MoveStatus, RecoveryStatus, StopMoveStatus};
use fci::{
    Command, Controller, ControllerMode, Generator, MotionGeneratorMode, Move, Request, RobotError,
    RobotErrors, RobotMode, Version,
};

use crate::bench::{Bench, moved, recovered, settings, stopped, wanted};

#[test]
fn a_motion_of_torque_from_move_to_its_second_reply() {
    for version in Version::ALL {
        let mut bench = Bench::new(version);
        let request = Request::Move(Move::torque(version));
        let handled = bench.ask(&request);
        assert_eq!((handled.request, handled.refused), (Some(request), None));
        // The reply goes out before a state shows the motion.
        bench.unanswered();
        bench.check_still(RobotMode::Idle);
        let (id, started) = (handled.id, moved(MoveStatus::MotionStarted));
        assert_eq!(bench.drain(), [(id, started)]);
        // The client reads states first: nothing is lost, nobody waits, the torque is 0.
        for _ in 0..100 {
            assert!(!bench.robot.waits());
            bench.unanswered();
            bench.check_moving();
            assert_eq!(bench.state.control_command_success_rate, 0.0);
        }
        assert_eq!(bench.unanswered(), Drive::Torque([0.0; 7]));
        for k in 1..=150 {
            let torque = [0.125 * f64::from(k % 8); 7];
            assert_eq!(bench.robot.waits(), k > 1);
            assert_eq!(bench.answered(torque), Drive::Torque(torque));
            // What acted is in the next state.
            assert_eq!(bench.state.tau_j_d, torque);
            assert_eq!(bench.state.control_command_success_rate, 1.0);
            // Desired positions stay those of the start.
            assert_eq!(bench.state.q_d, bench.state.q);
        }
        let id_of_state = bench.state.message_id;
        let last = Command::torque(version, id_of_state, [0.0; 7], true);
        assert_eq!(bench.command(&last), Received::Last);
        assert_eq!(bench.command(&last), Received::NoMotion);
        assert_eq!(bench.drain(), [(id, moved(MoveStatus::Success))]);
        assert_eq!(bench.unanswered(), Drive::Hold);
        bench.check_still(RobotMode::Idle);
        let ended = bench.robot.ended().expect("a motion");
        assert_eq!(ended.status, MoveStatus::Success);
        assert_eq!((ended.commands, ended.lost), (151, 0));
        assert_eq!(bench.robot.ended(), None);
        // Another one follows on the same connection.
        bench.moving();
    }
}

#[test]
fn a_stop_preempts_the_motion_before_it_is_confirmed() {
    for version in [Version::V5, Version::V10] {
        let (mut bench, id) = Bench::running(version);
        let stop = bench.ask(&Request::StopMove);
        assert_eq!(stop.refused, None);
        let expected = [
            (id, moved(MoveStatus::Preempted)),
            (stop.id, stopped(StopMoveStatus::Success)),
        ];
        assert_eq!(bench.drain(), expected);
        assert_eq!(bench.unanswered(), Drive::Hold);
        bench.check_still(RobotMode::Idle);
        assert_eq!(bench.state.reflex_reason, RobotErrors::NONE);

        let stop = bench.ask(&Request::StopMove);
        assert_eq!(stop.refused, Some(Refused::NoMotion));
        assert_eq!(
            bench.drain(),
            [(stop.id, stopped(StopMoveStatus::NotPossible))]
        );
    }
}

/// Also one that no state has shown.
#[test]
fn a_motion_is_stopped_before_it_is_shown() {
    let mut bench = Bench::new(Version::V10);
    let id = bench.ask(&Request::Move(Move::torque(Version::V10))).id;
    let stop = bench.ask(&Request::StopMove).id;
    let expected = [
        (id, moved(MoveStatus::MotionStarted)),
        (id, moved(MoveStatus::Preempted)),
        (stop, stopped(StopMoveStatus::Success)),
    ];
    assert_eq!(bench.drain(), expected);
    bench.unanswered();
    bench.check_still(RobotMode::Idle);
}

#[test]
fn missing_commands_repeat_the_last_and_the_twentieth_is_a_reflex() {
    for version in [Version::V5, Version::V10] {
        let (mut bench, id) = Bench::running(version);
        let torque = [0.75; 7];
        bench.answered(torque);
        for missing in 1..20 {
            assert_eq!(bench.unanswered(), Drive::Torque(torque));
            bench.check_moving();
            let rate = 2.0 / f64::from(2 + missing);
            assert!((bench.state.control_command_success_rate - rate).abs() < 1e-7);
        }
        assert_eq!(bench.unanswered(), Drive::Hold);
        bench.check_still(RobotMode::Reflex);
        let error = RobotErrors::NONE.with(RobotError::CommunicationConstraintsViolation);
        assert_eq!(bench.state.errors, error);
        assert_eq!(bench.state.reflex_reason, error);
        assert_eq!(bench.drain(), [(id, moved(MoveStatus::ReflexAborted))]);
        let ended = bench.robot.ended().expect("a motion");
        assert_eq!((ended.reason, ended.commands, ended.lost), (error, 2, 20));
    }
}

#[test]
fn nineteen_missing_commands_are_borne_again_and_again() {
    let (mut bench, _) = Bench::running(Version::V10);
    for _ in 0..10 {
        for _ in 0..19 {
            bench.unanswered();
        }
        bench.answered([0.0; 7]);
        bench.check_moving();
    }
    assert_eq!(bench.robot.counters().lost, 190);
    assert_eq!(bench.robot.counters().commands, 11);
}

#[test]
fn only_one_command_to_the_last_state_counts() {
    let (mut bench, _) = Bench::running(Version::V10);
    let now = bench.state.message_id;
    let to = |id, torque| Command::torque(Version::V10, id, [torque; 7], false);
    assert_eq!(bench.command(&to(now - 1, 0.5)), Received::Late);
    assert_eq!(bench.command(&to(now + 1, 0.5)), Received::Late);
    assert_eq!(bench.command(&to(now, 0.25)), Received::Accepted);
    assert_eq!(bench.command(&to(now, 0.5)), Received::Repeated);
    assert_eq!(bench.robot.advance(), Drive::Torque([0.25; 7]));
    let counters = bench.robot.counters();
    assert_eq!((counters.late, counters.repeated), (2, 1));
}

#[test]
fn after_a_reflex_only_a_recovery_leads_back() {
    for version in [Version::V5, Version::V10] {
        let (mut bench, _) = Bench::running(version);
        bench.command(&bench.torque([5.0; 7]));
        bench.unanswered();
        bench.check_still(RobotMode::Reflex);
        bench.drain();
        let refused = bench.ask(&Request::Move(Move::torque(version)));
        assert_eq!(refused.refused, Some(Refused::Mode(RobotMode::Reflex)));
        let expected = (refused.id, moved(MoveStatus::NotPossible));
        assert_eq!(bench.drain(), [expected]);

        let recovery = bench.ask(&Request::AutomaticErrorRecovery).id;
        bench.unanswered();
        bench.check_still(RobotMode::AutomaticErrorRecovery);
        let mode = Refused::Mode(RobotMode::AutomaticErrorRecovery);
        for request in [
            Request::Move(Move::torque(version)),
            Request::AutomaticErrorRecovery,
            Request::SetJointImpedance([1.0; 7]),
        ] {
            assert_eq!(bench.ask(&request).refused, Some(mode));
        }
        assert_eq!(bench.drain().len(), 3);
        let mut cycles = 0;
        let replies = loop {
            let replies = bench.drain();
            if !replies.is_empty() {
                break replies;
            }
            bench.unanswered();
            cycles += 1;
        };
        let success = recovered(RecoveryStatus::Success);
        assert_eq!(replies, [(recovery, success)]);
        assert_eq!(cycles, 50);
        bench.check_still(RobotMode::Idle);
        assert_eq!(bench.state.errors, RobotErrors::NONE);
        // Why the last motion was aborted is told until the next one.
        let torque = RobotErrors::NONE.with(RobotError::ControllerTorqueDiscontinuity);
        assert_eq!(bench.state.reflex_reason, torque);
        bench.moving();
        assert_eq!(bench.state.reflex_reason, RobotErrors::NONE);
    }
}

#[test]
fn a_recovery_without_a_reason_is_done_at_once_and_none_in_a_motion() {
    let (mut bench, _) = Bench::running(Version::V10);
    let handled = bench.ask(&Request::AutomaticErrorRecovery);
    assert_eq!(handled.refused, Some(Refused::InMotion));
    let expected = recovered(RecoveryStatus::NotPossible);
    assert_eq!(bench.drain(), [(handled.id, expected)]);
    bench.check_moving();

    let mut bench = Bench::new(Version::V5);
    let handled = bench.ask(&Request::AutomaticErrorRecovery);
    let expected = recovered(RecoveryStatus::Success);
    assert_eq!(bench.drain(), [(handled.id, expected)]);
}

#[test]
fn the_person_at_the_robot_ends_a_motion() {
    for version in [Version::V5, Version::V10] {
        for device in [false, true] {
            let (mut bench, id) = Bench::running(version);
            bench.operator = Operator {
                user_stop: !device,
                released: device,
                ..Operator::ABSENT
            };
            bench.unanswered();
            bench.check_still(RobotMode::UserStopped);
            assert_eq!(bench.state.errors, RobotErrors::NONE);
            assert_eq!(bench.drain(), [(id, moved(MoveStatus::EmergencyAborted))]);
            assert_eq!(bench.unanswered(), Drive::Hold);

            // Neither a motion nor a recovery meanwhile.
            let mode = Some(Refused::Mode(RobotMode::UserStopped));
            let handled = bench.ask(&Request::Move(Move::torque(version)));
            assert_eq!(handled.refused, mode);
            let handled = bench.ask(&Request::AutomaticErrorRecovery);
            assert_eq!(handled.refused, mode);
            let replies = bench.drain();
            let expected = recovered(RecoveryStatus::EmergencyAborted);
            assert_eq!(replies[1], (handled.id, expected));

            // It is over, but the motion had been aborted.
            bench.operator = Operator::ABSENT;
            bench.unanswered();
            bench.check_still(RobotMode::UserStopped);
            let replies = bench.recover();
            assert_eq!(replies[0].1, recovered(RecoveryStatus::Success));
            bench.check_still(RobotMode::Idle);
            bench.moving();
        }
    }
}

#[test]
fn without_a_motion_the_stop_leaves_nothing_behind() {
    let mut bench = Bench::new(Version::V10);
    bench.operator.user_stop = true;
    bench.unanswered();
    bench.check_still(RobotMode::UserStopped);
    bench.operator.user_stop = false;
    bench.unanswered();
    bench.check_still(RobotMode::Idle);
    bench.moving();
}

#[test]
fn a_stop_during_a_recovery_ends_that() {
    let (mut bench, _) = Bench::running(Version::V10);
    bench.command(&bench.torque([5.0; 7]));
    bench.unanswered();
    bench.drain();
    let id = bench.ask(&Request::AutomaticErrorRecovery).id;
    bench.unanswered();
    bench.operator.user_stop = true;
    bench.unanswered();
    let expected = recovered(RecoveryStatus::EmergencyAborted);
    assert_eq!(bench.drain(), [(id, expected)]);
    bench.check_still(RobotMode::UserStopped);
    bench.operator.user_stop = false;
    bench.unanswered();
    bench.check_still(RobotMode::Reflex);
    let errors = bench.state.errors;
    assert!(errors.contains(RobotError::ControllerTorqueDiscontinuity));
}

#[test]
fn brakes_and_hands() {
    let (mut bench, id) = Bench::running(Version::V10);
    bench.operator.ready = false;
    bench.unanswered();
    bench.check_still(RobotMode::Other);
    assert_eq!(bench.drain(), [(id, moved(MoveStatus::Aborted))]);
    for (operator, mode) in [
        (bench.operator, RobotMode::Other),
        (
            Operator {
                guiding: true,
                ..Operator::ABSENT
            },
            RobotMode::Guiding,
        ),
    ] {
        bench.operator = operator;
        bench.unanswered();
        bench.check_still(mode);
        let handled = bench.ask(&Request::Move(Move::torque(Version::V10)));
        assert_eq!(handled.refused, Some(Refused::Mode(mode)));
        bench.drain();
    }
    bench.operator = Operator::ABSENT;
    bench.unanswered();
    bench.check_still(RobotMode::Idle);
}

#[test]
fn other_motions_are_refused_by_name() {
    let bench = || Bench::new(Version::V10);
    for (controller, generator, text) in [
        (
            Controller::JointImpedance,
            Generator::JointPosition,
            "controller joint impedance with motion generator joint position",
        ),
        (
            Controller::CartesianImpedance,
            Generator::CartesianVelocity,
            "controller cartesian impedance with motion generator cartesian velocity",
        ),
        (
            Controller::External,
            Generator::CartesianPosition,
            "controller external with motion generator cartesian position",
        ),
    ] {
        let mut bench = bench();
        let handled = bench.ask(&wanted(controller, generator));
        let refused = handled.refused.expect("refused").to_string();
        assert!(refused.starts_with(text), "{refused}");
        assert!(refused.contains("allowed: external with none or joint velocity"));
        let expected = moved(MoveStatus::NotPossible);
        assert_eq!(bench.drain(), [(handled.id, expected)]);
        bench.unanswered();
        bench.check_still(RobotMode::Idle);
    }
    for generator in [Generator::None, Generator::JointVelocity] {
        let handled = bench().ask(&wanted(Controller::External, generator));
        assert_eq!(handled.refused, None);
    }
    let mut motion = Move::torque(Version::V10);
    motion.use_async_motion_generator = true;
    let handled = bench().ask(&Request::Move(motion));
    assert_eq!(handled.refused, Some(Refused::Asynchronous));
}

#[test]
fn a_second_move_and_wrong_numbers_are_refused() {
    let (mut bench, _) = Bench::running(Version::V10);
    let handled = bench.ask(&Request::Move(Move::torque(Version::V10)));
    assert_eq!(handled.refused, Some(Refused::InMotion));
    let expected = moved(MoveStatus::NotPossible);
    assert_eq!(bench.drain(), [(handled.id, expected)]);
    bench.check_moving();

    let mut bench = Bench::new(Version::V10);
    let mut motion = Move::torque(Version::V10);
    motion.maximum_path_deviation[1] = f64::NAN;
    let mut bytes = bench.bytes(&Request::Move(motion));
    let handled = bench.feed(&bytes).expect("a connection").expect("whole");
    assert!(matches!(handled.refused, Some(Refused::Argument(_))));
    // A code that means nothing.
    bytes[12] = 3;
    let handled = bench.feed(&bytes).expect("a connection").expect("whole");
    assert_eq!(handled.request, None);
    let expected = moved(MoveStatus::InvalidArgument);
    assert!(
        bench
            .drain()
            .into_iter()
            .all(|(_, reply)| reply == expected)
    );
}

/// Of a robot that has its own controllers, the commands go to them.
#[test]
fn all_motions_of_a_robot_that_has_them() {
    let mut settings = settings(Version::V10);
    settings.motions = Motions::All;
    for (generator, mode) in [
        (Generator::JointPosition, MotionGeneratorMode::JointPosition),
        (Generator::JointVelocity, MotionGeneratorMode::JointVelocity),
        (
            Generator::CartesianPosition,
            MotionGeneratorMode::CartesianPosition,
        ),
        (
            Generator::CartesianVelocity,
            MotionGeneratorMode::CartesianVelocity,
        ),
    ] {
        let mut bench = Bench::with(settings.clone());
        let handled = bench.ask(&wanted(Controller::JointImpedance, generator));
        assert_eq!(handled.refused, None);
        bench.drain();
        bench.unanswered();
        assert_eq!(bench.state.motion_generator_mode, mode);
        assert_eq!(bench.state.controller_mode, ControllerMode::JointImpedance);
        let mut command = Command {
            message_id: bench.state.message_id,
            q_c: [0.25; 7],
            dq_c: [0.5; 7],
            o_dp_ee_c: [0.75; 6],
            ..Command::default()
        };
        assert_eq!(bench.command(&command), Received::Accepted);
        assert_eq!(bench.unanswered(), Drive::Follow(command));
        let desired = match generator {
            Generator::JointPosition => bench.state.q_d[0] == 0.25,
            Generator::JointVelocity => bench.state.dq_d[0] == 0.5,
            Generator::CartesianPosition => bench.state.o_t_ee_d == [0.0; 16],
            _ => bench.state.o_dp_ee_d[0] == 0.75,
        };
        assert!(desired);
        command.message_id = bench.state.message_id;
        command.motion_generation_finished = true;
        assert_eq!(bench.command(&command), Received::Last);
    }
}
