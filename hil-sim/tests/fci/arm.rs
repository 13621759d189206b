//! The arm of the robot, driven without sockets.

use controller_core::Link;
use controller_core::arm::ArmModel;
use controller_core::arm::kinematics::Kinematics;
use controller_core::joint::JointState;
use fci::request::Load;
use fci::{Request, RobotError, RobotMode, State, StatePacket, Version};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{Answer, ControlBox as _, Event, FciBox, FciOptions, FciRobot, RobotSetup};
use hil_sim::summary::Verdict;

use cell::names::PlantKind;
use cell::scenario::{PointSpec, Scenario};

use crate::client::{bytes, command, connect, motion, springs, thresholds};

struct Bench {
    robot: FciRobot,
    version: Version,
    state: State,
    next_id: u32,
}

impl Bench {
    /// Connected, in the ready posture, not moving yet.
    fn new(version: Version, plant: PlantKind, duration_s: f64) -> Self {
        let mut scenario = Scenario::find("two-level-fr3").expect("built in");
        scenario.duration_s = duration_s;
        let options = FciOptions::of(&scenario, version);
        let robot = FciRobot::new(RobotSetup {
            scenario,
            plant,
            contacts: false,
            seed: 1,
            plant_options: PlantOptions::default(),
            options,
        });
        let mut bench = Self {
            robot,
            version,
            state: State::default(),
            next_id: 0,
        };
        bench.ask(&connect(version, 1));
        bench.ask(&thresholds(100.0, 100.0));
        bench.look();
        bench
    }

    fn ask(&mut self, request: &Request) {
        let bytes = bytes(self.version, self.next_id, request);
        self.next_id += 1;
        let mut rest = &bytes[..];
        self.robot.hear_requests(&mut rest).expect("a connection");
        assert!(rest.is_empty());
        let refused = |event: &Event| event.text.contains("refused");
        assert!(!self.robot.events().iter().any(refused));
        while self.robot.control().replies(&mut [0; 1000]) > 0 {}
    }

    fn start(&mut self) {
        self.ask(&motion(self.version));
        self.cycle();
        assert_eq!(self.state.robot_mode, RobotMode::Move);
    }

    fn cycle(&mut self) {
        self.robot.advance();
        self.look();
    }

    /// The next state, as a client reads it.
    fn look(&mut self) {
        let mut datagram = FciBox::EMPTY;
        self.robot.measurement(&mut datagram);
        let packet = StatePacket::new_checked(self.version, datagram).expect("a state");
        self.state = State::parse(&packet);
    }

    /// A cycle with a torque, if a motion runs.
    fn drive(&mut self, torque: [f64; 7]) {
        if self.state.robot_mode == RobotMode::Move {
            let command = command(self.version, &self.state, torque, false);
            let received = self.robot.command(&command, 0.0);
            assert_eq!(received, Answer::Accepted);
        }
        self.cycle();
    }
}

/// Where the core's kinematics have the flange \[m\].
fn flange(q: &[f64; 7]) -> [f64; 3] {
    let model = ArmModel::<f64>::new(&arms::FR3).expect("a table");
    let mut kinematics = Kinematics::new();
    let state = JointState {
        q: (*q).into(),
        dq: [0.0; 7].into(),
    };
    kinematics.update(&model, &state);
    let offset = arms::FR3.flange.shift;
    kinematics.point(Link::L7, &offset.into()).x.into()
}

#[test]
fn without_torque_the_arm_floats_and_says_where_it_is() {
    for version in [Version::V5, Version::V10] {
        let mut bench = Bench::new(version, PlantKind::Ideal, 1.0);
        let q = bench.state.q;
        bench.start();
        for _ in 0..500 {
            bench.drive([0.0; 7]);
        }
        for (now, start) in bench.state.q.iter().zip(q) {
            assert!((now - start).abs() < 1e-9);
        }
        let found = fci::state::position(&bench.state.o_t_ee);
        for (found, expected) in found.into_iter().zip(flange(&bench.state.q)) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
        assert_eq!(bench.robot.cycle(), 500);
        assert_eq!(bench.state.tau_ext_hat_filtered, [0.0; 7]);
    }
}

/// Before the first command nothing moves, however many states go out.
#[test]
fn the_first_command_starts_the_clock() {
    let mut bench = Bench::new(Version::V10, PlantKind::Realistic, 1.0);
    let q = bench.state.q;
    bench.start();
    for _ in 0..1000 {
        bench.cycle();
    }
    assert_eq!((bench.state.q, bench.robot.cycle()), (q, 0));
    bench.drive([0.0; 7]);
    assert_eq!(bench.robot.cycle(), 1);
    assert!(bench.robot.has_begun() && !bench.robot.is_finished());
    for _ in 0..2000 {
        let torque = springs(&bench.state, &q);
        bench.drive(torque);
    }
    assert!(bench.robot.is_finished());
    let fci = bench.robot.summary().fci.expect("its figures");
    assert_eq!((fci.motions, fci.commands, fci.lost), (1, 2001, 0));
    assert_eq!(fci.command_share, Some(1.0));
    assert_eq!(fci.success_rate_min, Some(1.0));
}

/// A load that is set and is not there lifts the arm: the robot holds its weight.
#[test]
fn the_weight_of_the_load_is_that_of_the_setter() {
    let lifted = |m_load| {
        let mut bench = Bench::new(Version::V10, PlantKind::Ideal, 1.0);
        bench.ask(&Request::SetLoad(Load {
            m_load,
            f_x_cload: [0.0, 0.0, 0.05],
            i_load: [0.0; 9],
        }));
        let height = flange(&bench.state.q)[2];
        bench.start();
        for _ in 0..200 {
            bench.drive([0.0; 7]);
        }
        flange(&bench.state.q)[2] - height
    };
    assert!(lifted(0.0).abs() < 1e-9);
    assert!(lifted(0.5) > 1e-3);
}

#[test]
fn an_arm_that_is_too_fast_is_stopped_and_held() {
    let mut bench = Bench::new(Version::V10, PlantKind::Ideal, 5.0);
    bench.start();
    let mut torque = [0.0; 7];
    while bench.state.robot_mode == RobotMode::Move {
        torque[0] = (torque[0] + 0.9_f64).min(30.0);
        bench.drive(torque);
        assert!(bench.robot.cycle() < 1000);
    }
    assert_eq!(bench.state.robot_mode, RobotMode::Reflex);
    // Joint 1 turns the end effector, which may be slower.
    let expected = RobotError::CartesianVelocityViolation;
    assert!(
        bench.state.errors.contains(expected),
        "{}",
        bench.state.errors
    );
    for _ in 0..500 {
        bench.cycle();
    }
    let fastest = bench
        .state
        .dq
        .iter()
        .fold(0.0_f64, |most, dq| most.max(dq.abs()));
    assert!(fastest < 1e-3, "{fastest}");
    // The client may begin again.
    bench.ask(&Request::AutomaticErrorRecovery);
    for _ in 0..60 {
        bench.cycle();
    }
    bench.start();
    let summary = bench.robot.summary();
    assert_eq!(summary.verdict, Verdict::Fail);
    let fci = summary.fci.expect("its figures");
    assert_eq!(fci.errors, [expected.name()]);
    assert_eq!((fci.motions, fci.reflexes), (2, 1));
}

#[test]
fn a_push_above_the_threshold_is_a_reflex() {
    let pushed = |force: f64| {
        let mut bench = Bench::new(Version::V5, PlantKind::Ideal, 5.0);
        bench.ask(&thresholds(50.0, 20.0));
        let posture = bench.state.q;
        bench.start();
        bench.drive([0.0; 7]);
        let flange = PointSpec::Name("flange".to_string());
        bench.robot.push(flange, [0.0, force, 0.0], 1.0);
        for _ in 0..400 {
            let torque = springs(&bench.state, &posture);
            bench.drive(torque);
        }
        bench.state
    };
    let state = pushed(10.0);
    assert_eq!(state.robot_mode, RobotMode::Move, "{}", state.errors);
    // What the robot exerts: against the push.
    assert!(
        (state.o_f_ext_hat_k[1] + 10.0).abs() < 0.1,
        "{:?}",
        state.o_f_ext_hat_k
    );
    let state = pushed(25.0);
    assert_eq!(state.robot_mode, RobotMode::Reflex);
    assert!(state.errors.contains(RobotError::CartesianReflex));
}

/// Drives off is the stop for users.
#[test]
fn the_person_at_the_robot_stops_it() {
    let mut bench = Bench::new(Version::V10, PlantKind::Ideal, 5.0);
    bench.start();
    bench.drive([0.0; 7]);
    bench.robot.switch_drives(false);
    bench.cycle();
    assert_eq!(bench.state.robot_mode, RobotMode::UserStopped);
    bench.robot.switch_drives(true);
    bench.cycle();
    bench.ask(&Request::AutomaticErrorRecovery);
    for _ in 0..60 {
        bench.cycle();
    }
    assert_eq!(bench.state.robot_mode, RobotMode::Idle);
}
