//! What the arm does: no torque step that the link causes, and the schemes.

use cell::names::PlantKind::{self, Ideal, Realistic};
use controller_core::joint::JointVector;
use hil_sim::robot::{LwrRobot, RobotAdds, RobotOptions, State};

use crate::client::{Loop, robot, setup};

/// The largest step of a joint's torque that the link may cause in a cycle \[Nm\].
const STEP_MAX: f64 = 5.0;

/// Brings the arm to motion by a torque that grows and falls smoothly.
fn moving(plant: PlantKind) -> Loop {
    let mut link = Loop::new(robot(plant));
    link.enter();
    let mut n = 0.0;
    let most = match plant {
        Ideal => [3.0, 2.0, 1.0, 0.7, 0.015, 0.01, 0.0],
        Realistic => [9.0, 6.0, 4.0, 3.0, 0.5, 0.3, 0.05],
    };
    link.run(150, |_, command| {
        n += 1.0;
        let size = 0.5 - 0.5 * f32::cos(n * std::f32::consts::TAU / 200.0);
        command.joint_torque = most.map(|t: f32| t * size);
        true
    });
    link
}

#[test]
fn fallback_while_moving_has_no_torque_step_and_ends_at_rest() {
    for plant in [Ideal, Realistic] {
        let mut link = moving(plant);
        let speed = link.robot.plant().state().dq.amax();
        assert!(speed > 0.5 && speed < 2.0, "{plant:?}: {speed}");
        link.step = 0.0;
        link.run(11, |_, _| false);
        let summary = link.robot.summary();
        assert_eq!(
            link.robot.control_box().state(),
            State::Monitor,
            "{:?} {speed}",
            summary.reason
        );
        link.run(1000, |_, _| false);
        assert!(link.step < STEP_MAX, "{plant:?}: {}", link.step);
        let figures = link.robot.summary().link.expect("a link");
        assert!(figures.largest_torque_step_nm < STEP_MAX);
        assert!(link.robot.plant().state().dq.amax() < 5e-3);
    }
}

#[test]
fn command_state_begins_and_ends_without_a_torque_step() {
    for plant in [Ideal, Realistic] {
        let mut link = Loop::new(robot(plant));
        link.enter();
        link.polite(500);
        // Torque that holds a load, taken away by changed flags.
        link.run(200, |_, command| {
            command.joint_torque[0] = 8.0;
            command.joint_position = [0.0; 7];
            true
        });
        link.client.flags = 0x31;
        link.polite(300);
        assert!(link.step < STEP_MAX, "{plant:?}: {}", link.step);
    }
}

#[test]
fn the_position_scheme_follows_a_ramp() {
    for plant in [Ideal, Realistic] {
        let options = RobotOptions {
            scheme: fri::ControlScheme::Position,
            ..RobotOptions::default()
        };
        let mut link = Loop::new(LwrRobot::new(setup(plant, options)));
        link.client.flags = 1;
        link.polite(300);
        assert_eq!(link.robot.control_box().state(), State::Command);
        let (mut goal, mut n) = (None, 0);
        let speed = 0.2_f32;
        let mut ramp = |msr: &fri::Measurement, command: &mut fri::Command| {
            let goal = goal.get_or_insert(msr.total_commanded_position());
            for joint in goal.iter_mut() {
                *joint += speed * 0.002 * (n.min(50) as f32 / 50.0);
            }
            n += 1;
            command.joint_position = *goal;
            true
        };
        link.run(500, &mut ramp);
        let state = *link.robot.plant().state();
        assert!(
            (state.dq - JointVector::repeat(0.2)).amax() < 0.02,
            "{}",
            state.dq
        );
        // Behind by 2 sqrt(M / k) times the speed, and by the weight not known.
        let mut off = JointVector::zeros();
        link.run(1, |msr, command| {
            ramp(msr, command);
            off = JointVector::from_fn(|i, _| {
                f64::from(command.joint_position[i] - msr.joint_position[i])
            });
            true
        });
        assert!(off.amax() < 0.01, "{off}");
        // A gap is bridged on the same line, and a longer one ends softly.
        link.step = 0.0;
        link.run(8, |msr, command| {
            ramp(msr, command);
            false
        });
        let gone_on = link.robot.plant().state().dq - state.dq;
        assert!(gone_on.amax() < 0.02, "{gone_on}");
        link.run(20, &mut ramp);
        assert_eq!(link.robot.summary().link.expect("a link").rejected.jump, 0);
        link.run(700, |_, _| false);
        assert_eq!(link.robot.control_box().state(), State::Monitor);
        assert!(link.step < STEP_MAX, "{plant:?}: {}", link.step);
        assert!(link.robot.plant().state().dq.amax() < 5e-3);
    }
}

/// the equation of motion: with torque zero the arm hangs where its gravity is compensated.
#[test]
fn torque_zero_floats_on_the_ideal_arm() {
    let mut link = Loop::new(robot(Ideal));
    link.enter();
    let before = link.robot.plant().state().q;
    link.polite(2000);
    // Encoders in binary32 and nothing that damps.
    assert!((link.robot.plant().state().q - before).amax() < 2e-3);
}

/// The law of joint impedance: a load deflects the arm by load over stiffness.
#[test]
fn stiffness_of_the_answer_is_that_of_the_arm() {
    let mut link = Loop::new(robot(Ideal));
    let (mut goal, mut torque) = (None, 0.0);
    let mut run = |link: &mut Loop, cycles, torque: f32| {
        link.run(cycles, |msr, command| {
            command.joint_stiffness = [400.0; 7];
            command.joint_damping = [0.7; 7];
            command.joint_position = *goal.get_or_insert(msr.total_commanded_position());
            command.joint_torque[0] = torque;
            true
        });
    };
    run(&mut link, 500, torque);
    assert_eq!(link.robot.control_box().state(), State::Command);
    let before = link.robot.plant().state().q;
    torque = 4.0;
    run(&mut link, 2000, torque);
    let deflection = link.robot.plant().state().q - before;
    assert!((deflection[0] - 0.01).abs() < 1e-4, "{deflection}");
}

#[test]
fn dead_cycles_delay_the_added_torque_alone() {
    let speeds = |dead_cycles: usize| {
        let mut setup = setup(Ideal, RobotOptions::default());
        setup.plant_options.dead_cycles = dead_cycles;
        let mut link = Loop::new(LwrRobot::new(setup));
        link.enter();
        link.polite(100);
        let mut speeds = Vec::new();
        for _ in 0..6 {
            link.run(1, |_, command| {
                command.joint_torque[0] = 5.0;
                true
            });
            speeds.push(link.robot.plant().state().dq[0]);
        }
        speeds
    };
    let (none, two) = (speeds(0), speeds(2));
    for n in 0..4 {
        assert!((two[n + 2] - none[n]).abs() < 1e-4 + 1e-2 * none[n].abs());
    }
    assert!(two[1].abs() < 1e-4 && none[1] > 1e-3);
}

#[test]
fn the_robot_adds_coriolis_torque_on_demand() {
    // Without damping and friction C dq does no work, so that leaving it to the
    // robot changes the motion.
    let end = |adds| {
        let options = RobotOptions {
            adds,
            ..RobotOptions::default()
        };
        let mut link = Loop::new(LwrRobot::new(setup(Ideal, options)));
        link.enter();
        link.run(300, |_, command| {
            command.joint_torque = [5.0, 3.0, 2.0, 3.0, 0.3, 0.2, 0.02];
            true
        });
        link.robot.plant().state().q
    };
    let difference = end(RobotAdds::Gravity) - end(RobotAdds::GravityCoriolis);
    assert!(difference.amax() > 1e-3);
}
