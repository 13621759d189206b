//! The conversation, against a robot that stands still and says what the test wants.

use arms::{LWR_IV, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use bridge::audit::Agreement;
use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Phase, RobotAdds, Session, SessionConfig, StopReason};
use bridge::source::ReferenceSource;
use controller_core::arm::ArmModel;
use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::kinematics::Kinematics;
use controller_core::fault::FaultKind;
use controller_core::joint::{JointState, JointVector};
use controller_core::law::null_space::NullDamping;
use controller_core::{
    Axes, ControllerConfig, Link, NullSpace, Reference, Target, Task, TaskGains, TaskSet,
};
use fri::{Command, CommandPacket, ControlScheme, Flags, InterfaceState, Measurement, Quality};

const START: [f64; 7] = [0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0];

fn config(duration_s: f64) -> SessionConfig {
    let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
    config_of(&[flange], duration_s)
}

/// With the orientation of the last link below the position of the flange.
fn two_kinds() -> SessionConfig {
    let gains = TaskGains::uniform(400.0, 40.0);
    let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, gains);
    let facing = Task::orientation(Link::L7.frame(), Axes::XYZ, gains);
    config_of(&[flange, facing], 60.0)
}

fn config_of(tasks: &[Task], duration_s: f64) -> SessionConfig {
    let controller = ControllerConfig {
        tasks: TaskSet::new(tasks).expect("tasks that can be"),
        null_space: NullSpace {
            damping: NullDamping::Inertia(10.0),
            ..NullSpace::diagonal(LWR_IV_STIFFNESS, [1.0; 7])
        },
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
    SessionConfig {
        doubted_max: 2,
        ..SessionConfig::new(&LWR_IV, controller, LWR_IV_FLANGE, duration_s)
    }
}

/// What a test wants, from the place of rest on.
struct Wanted(Reference<f64>);

impl ReferenceSource for Wanted {
    fn start(&mut self, origin: &Reference<f64>) {
        self.0.clone_from(origin);
    }

    fn sample(&mut self, _: f64) -> Option<Reference<f64>> {
        Some(self.0.clone())
    }
}

/// A robot that does not move.
/// What the levels and the posture follow.
fn followed(session: &Session<Lwr>) -> Reference<f64> {
    let controller = session.controller().expect("a first datagram");
    controller.followed_reference(session.state())
}

struct Robot {
    measurement: Measurement,
    session: Session<Lwr>,
    source: Wanted,
}

impl Robot {
    fn new(session: Session<Lwr>) -> Self {
        let model = ArmModel::<f64>::new(&LWR_IV).expect("the built-in arm");
        let q = JointVector::from(START.map(|q| f64::from(q as f32)));
        let state = JointState {
            q,
            dq: JointVector::zeros(),
        };
        let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
        kinematics.update(&model, &state);
        dynamics.update(&model, &kinematics, &state);
        let gravity: [f64; 7] = dynamics.gravity.into();
        let mut measurement = Measurement {
            state: InterfaceState::Monitor,
            quality: Quality::Perfect,
            period_s: 0.002,
            command_period_s: 0.002,
            joint_position: START.map(|q| q as f32),
            commanded_position: START.map(|q| q as f32 - 0.001),
            fri_offset: [0.002; 7],
            gravity: gravity.map(|g| g as f32),
            ..Measurement::default()
        };
        measurement.drives.power = 0x7F;
        measurement.drives.control = ControlScheme::JointImpedance;
        measurement.header.counter = 65_500;
        for (row, values) in measurement.mass_matrix.iter_mut().enumerate() {
            for (column, value) in values.iter_mut().enumerate() {
                *value = dynamics.mass_matrix[(row, column)] as f32;
            }
        }
        Self {
            measurement,
            session,
            source: Wanted(Reference::hold(0, [0.0; 7])),
        }
    }

    /// One cycle: the answer, if there is one.
    fn cycle(&mut self) -> Option<Command> {
        self.measurement.header.counter = self.measurement.header.counter.wrapping_add(1);
        self.send().1
    }

    /// The same datagram again.
    fn send(&mut self) -> (Outcome<fri::Error>, Option<Command>) {
        let (mut bytes, mut answer) = ([0; Measurement::LEN], [0; ANSWER_LEN]);
        self.measurement.emit(&mut bytes);
        let outcome = self.session.receive(&bytes, &mut self.source, &mut answer);
        if outcome != Outcome::Answered {
            assert_eq!(answer, [0; ANSWER_LEN], "nothing written");
            return (outcome, None);
        }
        let packet = CommandPacket::new_checked(answer).expect("a good answer");
        let command = Command::parse(&packet);
        assert_eq!(command.header.reflected, self.measurement.header.counter);
        assert_eq!(command.flags, Flags::JOINT_IMPEDANCE, "constant");
        self.measurement.header.reflected = command.header.counter;
        (outcome, Some(command))
    }

    fn cycles(&mut self, count: usize) -> Command {
        let mut last = None;
        for _ in 0..count {
            last = self.cycle();
        }
        last.expect("an answer")
    }

    fn enter(&mut self) {
        self.cycles(10);
        self.measurement.state = InterfaceState::Command;
    }
}

#[test]
fn before_command_state_it_mirrors_what_the_robot_commands() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(1.0)));
    assert_eq!(robot.session.phase(), Phase::Waiting);
    for _ in 0..200 {
        let answer = robot.cycle().expect("an answer");
        let expected = robot.measurement.total_commanded_position();
        assert_eq!(answer.joint_position, expected);
        assert_eq!(answer.joint_torque, [0.0; 7]);
        assert_eq!([answer.user.int[0], answer.user.int[1]], [30, 1]);
    }
    assert_eq!(robot.session.phase(), Phase::Ready);
    // Command state without drives, or with another scheme, is no command state.
    robot.measurement.state = InterfaceState::Command;
    robot.measurement.drives.power = 0;
    assert_eq!(robot.cycles(5).joint_torque, [0.0; 7]);
    robot.measurement.drives.power = 0x7F;
    robot.measurement.drives.control = ControlScheme::Position;
    assert_eq!(robot.cycles(5).joint_torque, [0.0; 7]);
    assert_eq!(robot.session.phase(), Phase::Ready);
}

#[test]
fn the_torque_grows_from_zero_and_contains_no_gravity() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(10.0)));
    robot.enter();
    let mut before = [0.0f32; 7];
    for cycle in 0..2000 {
        // The robot stands still whatever it is sent: its joints seem to be held
        // against the wanted motion, which begins with a step of 5 mm.
        if cycle == 600 {
            let Target::Position { x, .. } = &mut robot.source.0.targets_mut()[0] else {
                panic!("the flange has a position");
            };
            x.z += 0.005;
        }
        let answer = robot.cycle().expect("an answer");
        assert_eq!(answer.joint_position, robot.measurement.joint_position);
        assert_eq!(answer.joint_stiffness, [0.0; 7]);
        assert_eq!(answer.joint_damping, [0.0; 7]);
        if cycle == 0 {
            assert_eq!(answer.joint_torque, [0.0; 7], "starts with nothing");
        }
        if cycle < 600 {
            // At rest at the reference tau - g is zero, but for the binary32 of q.
            assert!(answer.joint_torque.iter().all(|torque| torque.abs() < 0.01));
        }
        before = answer.joint_torque;
    }
    assert!(before.iter().any(|torque| torque.abs() > 1.0), "{before:?}");
    let cycle = robot.session.last().expect("a cycle");
    assert_eq!(cycle.phase, Phase::Moving);
    // Time 0 is 1 s after the first cycle in command state.
    assert!(
        (cycle.t_s - (1999.0 * 0.002 - 1.0)).abs() < 1e-12,
        "{}",
        cycle.t_s
    );
    let step = cycle.step.expect("a step");
    let sent: JointVector<f64> = step.torque - step.gravity;
    for (sent, wire) in sent.iter().zip(before) {
        assert_eq!(*sent as f32, wire);
    }
    assert_eq!(robot.session.audit().gravity, Agreement::Agrees);
    assert_eq!(robot.session.audit().mass, Agreement::Agrees);
    assert_eq!(robot.session.audit().jacobian, Agreement::NotSent);
}

#[test]
fn coriolis_torque_is_left_out_where_the_robot_adds_it() {
    let mut settings = config(10.0);
    settings.robot_adds = RobotAdds::GravityAndCoriolis;
    let mut robot = Robot::new(Session::new(Lwr::new(), settings));
    robot.enter();
    robot.cycles(600);
    for cycle in 0..50 {
        let wiggle = (cycle as f32 * 0.3).sin() * 0.01;
        robot.measurement.joint_position = START.map(|q| q as f32 + wiggle);
        robot.cycle();
    }
    let cycle = robot.session.last().expect("a cycle");
    let step = cycle.step.expect("a step");
    assert!(step.coriolis.amax() > 1e-3);
    let expected = step.torque - step.gravity - step.coriolis;
    assert!((cycle.sent - expected).amax() < 1e-4);
}

#[test]
fn repeated_overtaken_and_bad_datagrams_get_no_answer() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(10.0)));
    robot.enter();
    robot.cycles(700);
    assert_eq!(robot.send().0, Outcome::Stale, "repeated");
    let newest = robot.measurement.header.counter;
    robot.measurement.header.counter = newest.wrapping_sub(3);
    assert_eq!(robot.send().0, Outcome::Stale, "overtaken");
    robot.measurement.header.counter = newest.wrapping_add(1);
    robot.measurement.joint_position[3] = f32::NAN;
    assert!(matches!(
        robot.send().0,
        Outcome::Rejected(fri::Error::NotFinite { .. })
    ));
    robot.measurement.joint_position[3] = START[3] as f32;
    assert_eq!(robot.send().0, Outcome::Answered);
}

#[test]
fn a_jump_of_the_counter_is_believed_only_when_it_stays() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(10.0)));
    robot.cycles(20);
    let counter = robot.measurement.header.counter;
    // A damaged counter: one datagram goes without an answer, the next has one.
    robot.measurement.header.counter = counter.wrapping_add(20_000);
    assert_eq!(robot.send().0, Outcome::Stale);
    robot.measurement.header.counter = counter;
    assert!(robot.cycle().is_some());
    // A robot that has started again.
    robot.measurement.header.counter = counter.wrapping_sub(5000);
    let unanswered = (0..20).filter(|_| robot.cycle().is_none()).count();
    assert_eq!(unanswered, 10);
}

/// Well-formed, and nothing that an arm can do: as if that measurement had been lost.
#[test]
fn one_position_that_cannot_be_is_a_lost_cycle() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(60.0)));
    robot.enter();
    robot.cycles(1000);
    let here = robot.measurement.joint_position;
    for wrong in [0.5, -1e30] {
        robot.measurement.joint_position[3] += wrong;
        robot.measurement.header.counter += 1;
        assert_eq!(robot.send().0, Outcome::Doubted);
        robot.measurement.joint_position = here;
        robot.cycles(1);
        let cycle = robot.session.last().expect("a cycle");
        assert_eq!((cycle.phase, cycle.lost), (Phase::Moving, 1));
        robot.cycles(60);
    }
    assert!(robot.session.fault().is_none());
    assert!(robot.session.last().expect("a cycle").joints.dq.amax() < 1e-9);
}

#[test]
fn one_counter_far_ahead_is_a_lost_cycle_and_a_gap_that_stays_holds_the_arm() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(60.0)));
    robot.enter();
    robot.cycles(1000);
    let counter = robot.measurement.header.counter;
    robot.measurement.header.counter = counter.wrapping_add(990);
    assert_eq!(robot.send().0, Outcome::Stale);
    robot.measurement.header.counter = counter.wrapping_add(1);
    robot.cycles(100);
    assert_eq!(robot.session.phase(), Phase::Moving);
    let counter = robot.measurement.header.counter;
    robot.measurement.header.counter = counter.wrapping_add(300);
    assert!(robot.cycle().is_none());
    assert!(robot.cycle().is_some());
    let cycle = robot.session.last().expect("a cycle");
    assert_eq!((cycle.phase, cycle.lost), (Phase::Holding, 301));
}

/// A motion whose time ran out while nothing was heard is not done.
#[test]
fn the_motion_is_over_only_on_a_sound_link() {
    for (trouble, reason) in [(400, StopReason::Link), (900, StopReason::Done)] {
        let mut robot = Robot::new(Session::new(Lwr::new(), config(1.0)));
        robot.enter();
        robot.cycles(1000 - trouble);
        robot.measurement.header.counter += 6;
        while robot.session.stop_reason().is_none() {
            robot.cycle();
        }
        assert_eq!(robot.session.stop_reason(), Some(reason), "{trouble}");
    }
    // Not even in command state when it should have ended.
    let mut robot = Robot::new(Session::new(Lwr::new(), config(1.0)));
    robot.enter();
    robot.cycles(700);
    robot.measurement.state = InterfaceState::Monitor;
    robot.cycles(400);
    assert_eq!(robot.session.stop_reason(), Some(StopReason::Link));
}

#[test]
fn a_gap_holds_the_arm_and_the_motion_is_joined_again() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(60.0)));
    robot.enter();
    robot.cycles(1000);
    assert_eq!(robot.session.phase(), Phase::Moving);
    // Six lost: held in the very cycle that shows it.
    robot.measurement.header.counter = robot.measurement.header.counter.wrapping_add(6);
    robot.cycle();
    let held = *robot.session.last().expect("a cycle");
    assert_eq!((held.phase, held.lost), (Phase::Holding, 6));
    let mut cycles = 1;
    while robot.session.phase() == Phase::Holding {
        robot.cycle();
        cycles += 1;
        assert!(cycles < 60);
    }
    assert_eq!(robot.session.phase(), Phase::Moving);
    // 100 ms without a measurement, more than the core believes as an interval.
    robot.measurement.header.counter = robot.measurement.header.counter.wrapping_add(50);
    let answer = robot.cycle().expect("an answer");
    assert_eq!(robot.session.phase(), Phase::Holding);
    assert!(robot.session.fault().is_none());
    assert!(answer.joint_torque.iter().all(|torque| torque.abs() < 5.0));
}

#[test]
fn commands_that_are_not_heard_hold_the_arm_and_end_the_session() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(60.0)));
    robot.enter();
    robot.cycles(1000);
    let heard = robot.measurement.header.reflected;
    let mut cycles = 0;
    while robot.session.phase() != Phase::Finished {
        robot.cycle();
        robot.measurement.header.reflected = heard;
        cycles += 1;
        match robot.session.phase() {
            Phase::Moving => assert!(cycles <= 7, "{cycles}"),
            Phase::Holding => assert!(cycles <= 1010, "{cycles}"),
            _ => {}
        }
        assert!(cycles < 2000);
    }
    assert_eq!(robot.session.stop_reason(), Some(StopReason::Link));
}

#[test]
fn at_the_end_the_robot_gets_its_stiffness_back() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(0.5)));
    robot.enter();
    let mut stiffness = 0.0f32;
    let mut cycles = 0;
    let mut hold = None;
    while robot.session.phase() != Phase::Finished {
        let answer = robot.cycle().expect("an answer");
        let [now, ..] = answer.joint_stiffness;
        assert!(now >= stiffness && now - stiffness < 15.0, "{now}");
        if now > 0.0 {
            let hold = *hold.get_or_insert(answer.joint_position);
            assert_eq!(answer.joint_position, hold, "a fixed place");
            assert_eq!(answer.user.int[1], 0, "stop wish");
        }
        stiffness = now;
        cycles += 1;
        assert!(cycles < 2000);
    }
    assert_eq!(stiffness, 1000.0);
    assert_eq!(robot.session.stop_reason(), Some(StopReason::Done));
    // 1 s settling, 0.5 s motion, 0.2 s braking, 0.3 s handing over.
    assert_eq!(cycles, 1001, "{cycles}");
}

#[test]
fn a_fault_of_the_controller_gives_the_arm_to_the_robot() {
    let mut robot = Robot::new(Session::new(Lwr::new(), config(60.0)));
    robot.enter();
    robot.cycles(1000);
    // Joint 7 at 0.5 rad in a cycle: no arm does that. Twice it is a damaged datagram.
    robot.measurement.joint_position[6] += 0.5;
    assert!(robot.cycle().is_none() && robot.cycle().is_none());
    let answer = robot.cycle().expect("an answer");
    assert_eq!(answer.joint_torque, [0.0; 7]);
    let answer = robot.cycles(300);
    assert_eq!(answer.joint_stiffness, [1000.0; 7]);
    assert_eq!(robot.session.stop_reason(), Some(StopReason::Fault));
    let fault = robot.session.fault().expect("a fault").to_string();
    assert!(fault.contains("speed [rad/s] of joint 7"), "{fault}");
}

/// Each reference that the controller cannot mean ends the session in the cycle in which
/// it arrives: gravity torque alone, that is nothing on the wire, then the robot's own
/// stiffness. With the arm at rest at the reference or joining it, all the same.
#[test]
fn a_target_of_another_kind_is_a_fault_and_never_followed() {
    let far = Target::position([0.0, 0.0, 1.0]);
    let facing = Target::orientation([0.0, 1.0, 0.0, 0.0]);
    let cases: [(&[Target<f64>], FaultKind, &str); 6] = [
        (
            &[facing, facing],
            FaultKind::WrongTarget,
            "level 1 is an orientation; allowed hold or a position",
        ),
        (
            &[far, far],
            FaultKind::WrongTarget,
            "level 2 is a position; allowed hold or an orientation",
        ),
        (&[Target::Hold, far], FaultKind::WrongTarget, "level 2"),
        (
            &[far, Target::orientation([0.3, 0.0, 0.0, 0.0])],
            FaultKind::Implausible,
            "squared quaternion norm of level 2",
        ),
        (
            &[far],
            FaultKind::Implausible,
            "number of targets is 1; allowed 2 to 2",
        ),
        (
            &[Target::position([f64::NAN; 3]), facing],
            FaultKind::Implausible,
            "distance [m] from the shoulder of the target of level 1",
        ),
    ];
    for (targets, kind, part) in cases {
        // 600: following for 0.2 s. 900: held before, and joining with it.
        for (cycles, held) in [(600, false), (900, true)] {
            let mut robot = Robot::new(Session::new(Lwr::new(), two_kinds()));
            robot.enter();
            robot.cycles(cycles);
            if held {
                robot.measurement.header.counter = robot.measurement.header.counter.wrapping_add(6);
                while robot.cycle().is_some() && robot.session.phase() == Phase::Holding {}
                robot.cycles(5);
            }
            assert_eq!(robot.session.phase(), Phase::Moving, "{part}");
            let before = followed(&robot.session).targets()[0];
            robot.source.0 = Reference::from_targets(targets, START).expect("not more than levels");
            let answer = robot.cycle().expect("an answer");
            assert_eq!(answer.joint_torque, [0.0; 7], "{part}");
            let fault = robot.session.fault().expect(part);
            assert_eq!(fault.kind, kind, "{part}");
            assert!(fault.to_string().contains(part), "{fault}");
            let finite = kind == FaultKind::WrongTarget;
            assert!(
                !finite || followed(&robot.session).targets()[0] == before,
                "{part}"
            );
            let answer = robot.cycles(300);
            assert_eq!(answer.joint_torque, [0.0; 7], "{part}");
            assert_eq!(answer.joint_stiffness, [1000.0; 7], "{part}");
            assert_eq!(answer.joint_position, robot.measurement.joint_position);
            assert_eq!(robot.session.stop_reason(), Some(StopReason::Fault));
        }
    }
}

#[test]
fn a_level_that_holds_stays_where_it_came_to_rest() {
    let mut robot = Robot::new(Session::new(Lwr::new(), two_kinds()));
    robot.enter();
    robot.cycles(600);
    let before = followed(&robot.session);
    let [place, facing] = *before.targets() else {
        panic!("two levels");
    };
    robot.source.0 = Reference::hold(2, START);
    robot.cycles(300);
    assert_eq!(robot.session.phase(), Phase::Moving);
    assert!(robot.session.fault().is_none());
    assert_eq!(followed(&robot.session).targets(), [place, facing]);
}

#[test]
fn dry_it_computes_and_moves_nothing() {
    let mut settings = config(1.0);
    settings.dry = true;
    settings.duration_s = 60.0;
    let mut robot = Robot::new(Session::new(Lwr::new(), settings));
    robot.enter();
    for _ in 0..2000 {
        let answer = robot.cycle().expect("an answer");
        assert_eq!(answer.joint_torque, [0.0; 7]);
        assert_eq!(answer.user.int[1], 0, "no wish to start");
        // In command state all the same: the robot's own stiffness holds the arm.
        assert_eq!(answer.joint_stiffness, [1000.0; 7]);
        assert_eq!(answer.joint_damping, [0.7; 7]);
    }
    let cycle = robot.session.last().expect("a cycle");
    let step = cycle.step.expect("torques as they would be");
    assert!((step.torque - step.gravity).amax() < 0.01);
}
