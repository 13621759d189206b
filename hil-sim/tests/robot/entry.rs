//! The way into command state, and what bars it.

use cell::names::PlantKind::{Ideal, Realistic};
use hil_sim::robot::{Answer, Krl, LwrRobot, RobotOptions, State};

use crate::client::{Client, Loop, measurement, robot, send, setup};

#[test]
fn a_stranger_gets_into_command_state() {
    for plant in [Ideal, Realistic] {
        for seed in 1..=10 {
            let mut setup = setup(plant, RobotOptions::default());
            setup.seed = seed;
            let mut link = Loop::new(LwrRobot::new(setup));
            // A hundred rated cycles and 0.2 s; the state is said by the next.
            link.polite(199);
            assert_eq!(link.robot.control_box().state(), State::Monitor);
            link.polite(1);
            assert_eq!(
                link.robot.control_box().state(),
                State::Command,
                "{:?}",
                link.robot.events()
            );
            assert_eq!(link.robot.time_s(), None);
            let msr = measurement(&mut link.robot);
            assert_eq!(msr.drives.power, 0x7F);
            assert_eq!(msr.state, fri::InterfaceState::Command);
            link.polite(499);
            assert_eq!(link.robot.time_s(), None);
            link.polite(1);
            assert_eq!(link.robot.time_s(), Some(0.0));
        }
    }
}

/// Who mirrors the measured position from the beginning is a sag of the springs
/// away from the commanded one.
#[test]
fn mirroring_the_measured_position_is_close_enough() {
    for seed in 1..=10 {
        let mut setup = setup(Realistic, RobotOptions::default());
        setup.seed = seed;
        let mut link = Loop::new(LwrRobot::new(setup));
        link.run(300, |msr, command| {
            command.joint_position = msr.joint_position;
            true
        });
        assert_eq!(
            link.robot.control_box().state(),
            State::Command,
            "{seed}: {:?}",
            link.robot.events()
        );
    }
}

#[test]
fn every_check_bars_the_way_with_its_message() {
    type Edit = fn(u32, &mut fri::Command);
    let cases: [(Edit, &str); 3] = [
        (
            |_, command| command.joint_position[2] += 0.006,
            "jntPos of joint 3 is 6.0 mrad from the commanded position; allowed: 5.0",
        ),
        (
            |_, command| command.joint_torque[3] = -1.25,
            "addJntTrq of joint 4 is -1.25 Nm; allowed: 1.00",
        ),
        (
            |n, command| {
                command.flags.0 = if (n / 50).is_multiple_of(2) {
                    0x35
                } else {
                    0x15
                }
            },
            "cmdFlags changed while waiting",
        ),
    ];
    for (edit, message) in cases {
        let mut link = Loop::new(robot(Ideal));
        let mut n = 0;
        link.run(600, |_, command| {
            n += 1;
            edit(n, command);
            true
        });
        assert_eq!(link.robot.control_box().state(), State::Monitor);
        assert!(link.said(message), "{:?}", link.robot.events());
        // Once, not every time.
        assert_eq!(link.robot.events().len(), 1);
        link.enter();
    }
}

#[test]
fn drives_off_bar_the_way_and_end_command_state() {
    let mut link = Loop::new(robot(Ideal));
    link.robot.switch_drives(false);
    link.polite(400);
    assert_eq!(link.robot.control_box().state(), State::Monitor);
    assert!(link.said("drives are off"));
    assert_eq!(measurement(&mut link.robot).drives.power, 0);
    link.robot.switch_drives(true);
    link.enter();
    link.robot.switch_drives(false);
    link.polite(1);
    assert_eq!(link.robot.control_box().state(), State::Monitor);
    assert!(link.said("monitor state: drives off"));
}

#[test]
fn a_poor_link_never_gets_there() {
    let mut link = Loop::new(robot(Ideal));
    let mut n = 0;
    link.run(2000, |_, _| {
        n += 1;
        n % 10 != 0
    });
    assert_eq!(link.robot.control_box().state(), State::Monitor);
    assert!(link.robot.events().is_empty());
}

#[test]
fn the_handshake_waits_for_the_client() {
    let options = RobotOptions {
        krl: Krl::Handshake,
        ..RobotOptions::default()
    };
    let mut link = Loop::new(LwrRobot::new(setup(Ideal, options)));
    let krc = |link: &mut Loop| measurement(&mut link.robot).user.int[1];
    let ask = |strategy: i32, wish: i32| {
        move |_: &fri::Measurement, command: &mut fri::Command| {
            command.user.int[0] = strategy;
            command.user.int[1] = wish;
            true
        }
    };
    link.polite(400);
    assert_eq!(
        (link.robot.control_box().state(), krc(&mut link)),
        (State::Monitor, 10)
    );
    link.run(400, ask(20, 1));
    assert_eq!(link.robot.control_box().state(), State::Monitor);
    assert!(link.said("strategy 20 (Cartesian impedance) is not supported"));
    link.run(150, ask(30, 1));
    assert_eq!(
        (link.robot.control_box().state(), krc(&mut link)),
        (State::Command, 1)
    );
    assert_eq!(
        measurement(&mut link.robot).drives.control,
        fri::ControlScheme::JointImpedance
    );
    link.run(1, ask(30, 0));
    assert_eq!(
        (link.robot.control_box().state(), krc(&mut link)),
        (State::Monitor, 0)
    );
    link.run(150, ask(10, 1));
    assert_eq!(
        (link.robot.control_box().state(), krc(&mut link)),
        (State::Command, 1)
    );
    assert_eq!(
        measurement(&mut link.robot).drives.control,
        fri::ControlScheme::Position
    );
    let summary = link.robot.summary().link.expect("a link");
    assert_eq!((summary.fallbacks, summary.recoveries), (0, 1));
}

/// Counters: any start, wrong ones without effect.
#[test]
fn answers_out_of_order_have_no_effect() {
    let mut robot = robot(Ideal);
    let mut client = Client::new();
    let first = measurement(&mut robot);
    let mut stranger = client.answer(&first);
    stranger.header.reflected = 7;
    assert_eq!(send(&mut robot, &stranger), Answer::Rejected);
    assert!(robot.advance().is_none() && !robot.has_begun());

    let one = client.answer(&first);
    assert_eq!(send(&mut robot, &one), Answer::Accepted);
    assert_eq!(send(&mut robot, &one), Answer::Repeated);
    robot.advance();
    let second = measurement(&mut robot);
    let two = client.answer(&second);
    robot.advance();
    let third = measurement(&mut robot);
    let three = client.answer(&third);
    assert_eq!(send(&mut robot, &three), Answer::Accepted);
    assert_eq!(send(&mut robot, &two), Answer::Old);
    for bytes in [&[][..], &[0; 376], &[0; 377]] {
        assert_eq!(robot.command(bytes, 0.0), Answer::Rejected);
    }
    // A number that is none, where it counts and where it does not.
    let mut four = client.answer(&third);
    four.joint_torque[0] = f32::NAN;
    assert_eq!(send(&mut robot, &four), Answer::Rejected);
    robot.advance();
    let fourth = measurement(&mut robot);
    let mut four = client.answer(&fourth);
    four.wrench[0] = f32::NAN;
    four.user.real[0] = f32::INFINITY;
    assert_eq!(send(&mut robot, &four), Answer::Accepted);
    let link = robot.summary().link.expect("a link");
    assert_eq!((link.answers, link.repeated, link.old), (3, 1, 1));
    // Two was late, and the one that was no number is missing in the count.
    assert_eq!(link.lost, 2);
    assert_eq!(link.rejected.total(), 5);
}
