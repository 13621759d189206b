//! The conversation with a Franka arm, in both layouts of its state: an FR3 that moves by its
//! equation of motion under what it is sent, and says so by FCI.

use std::f64::consts::FRAC_PI_2;

use arms::FR3;
use bridge::audit::Agreement;
use bridge::fci::{Answer, Fci};
use bridge::protocol::Protocol;
use bridge::session::{Outcome, Phase, Session, SessionConfig, StopReason};
use bridge::source::ReferenceSource;
use controller_core::arm::ArmModel;
use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::kinematics::Kinematics;
use controller_core::joint::{JointState, JointVector};
use controller_core::law::null_space::NullDamping;
use controller_core::nalgebra::{Matrix4, Vector3};
use controller_core::task::trajectory::quintic;
use controller_core::{
    Axes, ControllerConfig, NullSpace, Reference, Target, Task, TaskGains, TaskSet,
};
use fci::client::Duty;
use fci::{Command, RobotMode, State, Version, state};

const VERSIONS: [Version; 2] = [Version::V5, Version::V10];
const START_DEG: [f64; 7] = [0.0, -45.0, 0.0, -135.0, 0.0, 90.0, 45.0];
const CYCLE_S: f64 = 0.001;
/// Cycles from the first command to time 0.
const SETTLE: usize = 1000;
/// Length of the motion \[s\].
const DURATION_S: f64 = 1.5;
const WAY_M: f64 = 0.1;

/// Up by 10 cm in a second, from rest to rest.
struct Up(Reference<f64>);

impl ReferenceSource for Up {
    fn start(&mut self, origin: &Reference<f64>) {
        self.0.clone_from(origin);
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        let mut reference = self.0.clone();
        let [share, rate, change] = quintic(t_s);
        let Target::Position { x, dx, ddx } = &mut reference.targets_mut()[0] else {
            panic!("the flange has a position");
        };
        x.z += WAY_M * share;
        dx.z = WAY_M * rate;
        ddx.z = WAY_M * change;
        Some(reference)
    }
}

struct Robot {
    version: Version,
    model: ArmModel<f64>,
    arm: JointState<f64>,
    state: State,
    duty: Duty,
    session: Session<Fci>,
    source: Up,
    /// Largest step of a torque between commands that it used \[Nm\].
    step_nm: f64,
    /// Whether the next command is lost on its way.
    loses: bool,
    last: Option<Command>,
}

impl Robot {
    fn new(version: Version) -> Self {
        let flange = FR3.flange_point();
        let task = Task::position(flange, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
        let controller = ControllerConfig {
            tasks: TaskSet::new(&[task]).expect("a task that can be"),
            null_space: NullSpace {
                damping: NullDamping::Inertia(10.0),
                ..NullSpace::diagonal([10.0; 7], [1.0; 7])
            },
            observer_gain: [50.0; 7],
            cycle_s: CYCLE_S,
            dead_cycles: 0,
        };
        let config = SessionConfig {
            doubted_max: 2,
            ..SessionConfig::new(&FR3, controller, flange, DURATION_S)
        };
        Self {
            version,
            model: ArmModel::new(&FR3).expect("the built-in arm"),
            arm: JointState {
                q: START_DEG.map(f64::to_radians).into(),
                dq: JointVector::zeros(),
            },
            state: State {
                message_id: 1_000_000,
                robot_mode: RobotMode::Move,
                ..State::default()
            },
            duty: Duty::Listen,
            session: Session::new(Fci::new(version), config),
            source: Up(Reference::hold(0, [0.0; 7])),
            step_nm: 0.0,
            loses: false,
            last: None,
        }
    }

    fn dynamics(&self) -> Dynamics<f64> {
        let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
        kinematics.update(&self.model, &self.arm);
        dynamics.update(&self.model, &kinematics, &self.arm);
        dynamics
    }

    fn report(&mut self) {
        let used = JointVector::from(self.state.tau_j_d);
        self.state.message_id += 1;
        self.state.q = self.arm.q.into();
        self.state.dq = self.arm.dq.into();
        self.state.tau_j = (used + self.dynamics().gravity).into();
        self.state.f_t_ee = columns(&Matrix4::identity());
        self.state.o_t_ee = columns(&flange(&self.state.q));
    }

    /// The state as it is: what becomes of it, and the command.
    fn send(&mut self) -> (Outcome<fci::Error>, Option<Command>) {
        let mut bytes = [0; state::LEN_MAX];
        let datagram = self
            .state
            .emit(self.version, &mut bytes)
            .expect("modes of all");
        let mut answer = Answer::EMPTY;
        self.session.protocol_mut().attend(self.duty);
        let outcome = self
            .session
            .receive(datagram, &mut self.source, &mut answer);
        if outcome != Outcome::Answered {
            assert_eq!(answer.as_ref(), [0_u8; 0], "nothing written");
            return (outcome, None);
        }
        let command = Command::parse(self.version, answer.as_ref()).expect("a good command");
        command.check().expect("numbers");
        assert_eq!(command.message_id, self.state.message_id);
        assert_eq!(command.is_last(), self.duty == Duty::Finish);
        (outcome, Some(command))
    }

    /// One cycle: the newest command that has arrived acts until the next.
    fn cycle(&mut self) -> Outcome<fci::Error> {
        self.report();
        let (outcome, command) = self.send();
        self.last = command;
        if let Some(command) = command.filter(|_| !self.loses) {
            let change = JointVector::from(command.tau_j_d) - JointVector::from(self.state.tau_j_d);
            self.step_nm = self.step_nm.max(change.amax());
            self.state.tau_j_d = command.tau_j_d;
        }
        self.loses = false;
        self.move_on();
        outcome
    }

    /// M ddq + C dq = tau: the robot has compensated gravity.
    fn move_on(&mut self) {
        const STEPS: u32 = 4;
        let step_s = CYCLE_S / f64::from(STEPS);
        if self.duty == Duty::Listen {
            return;
        }
        for _ in 0..STEPS {
            let dynamics = self.dynamics();
            let torque = JointVector::from(self.state.tau_j_d) - dynamics.coriolis;
            let acceleration = dynamics
                .mass_matrix
                .cholesky()
                .expect("mass")
                .solve(&torque);
            self.arm.dq += acceleration * step_s;
            self.arm.q += self.arm.dq * step_s;
        }
    }

    fn cycles(&mut self, count: usize) {
        for _ in 0..count {
            self.cycle();
        }
    }

    /// From the first states to the last cycle before time 0.
    fn settle(&mut self) {
        self.cycles(20);
        self.duty = Duty::Answer;
        self.cycles(SETTLE);
        assert_eq!(
            self.session.phase(),
            Phase::Starting,
            "{:?}",
            self.session.fault()
        );
    }

    fn sent(&self) -> JointVector<f64> {
        self.session.last().expect("a cycle").sent
    }
}

/// Pose of the flange by the vendor's table of modified Denavit-Hartenberg parameters.
fn flange(q: &[f64; 7]) -> Matrix4<f64> {
    const A: [f64; 7] = [0.0, 0.0, 0.0, 0.0825, -0.0825, 0.0, 0.088];
    const D: [f64; 7] = [0.333, 0.0, 0.316, 0.0, 0.384, 0.0, 0.0];
    const TWIST: [f64; 7] = [0.0, -1.0, 1.0, 1.0, -1.0, 1.0, 1.0];
    let mut pose = Matrix4::<f64>::identity();
    for joint in 0..7 {
        let (st, ct) = q[joint].sin_cos();
        let (sa, ca) = (TWIST[joint] * FRAC_PI_2).sin_cos();
        let (a, d) = (A[joint], D[joint]);
        #[rustfmt::skip]
        let link = Matrix4::new(
            ct, -st, 0.0, a,
            st * ca, ct * ca, -sa, -sa * d,
            st * sa, ct * sa, ca, ca * d,
            0.0, 0.0, 0.0, 1.0,
        );
        pose *= link;
    }
    pose * Matrix4::<f64>::new_translation(&Vector3::new(0.0, 0.0, 0.107))
}

fn columns(pose: &Matrix4<f64>) -> [f64; 16] {
    std::array::from_fn(|i| pose[(i % 4, i / 4)])
}

#[test]
fn outside_a_motion_states_are_heard_and_get_no_answer() {
    for version in VERSIONS {
        let mut robot = Robot::new(version);
        for _ in 0..50 {
            assert_eq!(robot.cycle(), Outcome::Heard);
        }
        assert_eq!(robot.session.phase(), Phase::Ready);
        assert_eq!(robot.session.cycle_s(), CYCLE_S);
        assert_eq!(robot.send().0, Outcome::Stale, "the same state again");
        let other = match version {
            Version::V10 => Version::V5,
            _ => Version::V10,
        };
        let mut bytes = [0; state::LEN_MAX];
        let datagram = robot.state.emit(other, &mut bytes).expect("modes of all");
        let mut answer = <Fci as Protocol>::EMPTY;
        let outcome = (robot.session).receive(datagram, &mut robot.source, &mut answer);
        assert!(matches!(outcome, Outcome::Rejected(_)), "{outcome:?}");
    }
}

#[test]
fn the_motion_is_followed_by_measured_speed_and_its_own_coriolis_torque() {
    for version in VERSIONS {
        let mut robot = Robot::new(version);
        robot.settle();
        let from = flange(&robot.arm.q.into());
        let mut coriolis_nm = 0.0_f64;
        while robot.session.phase() != Phase::Stopping {
            robot.cycle();
            let report = robot.session.last().expect("a cycle");
            let step = report.step.expect("the controller runs");
            // The whole law but gravity, nothing of it taken back.
            assert!((report.sent - (step.torque - step.gravity)).amax() < 1e-12);
            coriolis_nm = coriolis_nm.max(step.coriolis.amax());
            let [share, ..] = quintic(report.t_s);
            let now = flange(&report.joints.q.into());
            let mut off = now - from;
            off[(2, 3)] -= WAY_M * share;
            let off_m = off.column(3).amax();
            assert!(off_m < 5e-5, "{version:?} {}: {off_m}", report.t_s);
        }
        assert!(
            coriolis_nm > 0.01,
            "{coriolis_nm}: a motion that has none shows nothing"
        );
        assert_eq!(robot.session.stop_reason(), Some(StopReason::Done));
        assert!(robot.step_nm <= 1.0 && robot.session.protocol().limited_cycles() == 0);
    }
}

/// No stiffness takes the arm over: torque holds it until the connection says that the robot
/// has ended the motion.
#[test]
fn the_end_is_a_hold_and_then_the_finish_flag() {
    let load = JointVector::from([0.0, -1.0, 0.0, 0.5, 0.0, 0.0, 0.0]);
    for version in VERSIONS {
        let mut robot = Robot::new(version);
        robot.settle();
        robot.session.stop();
        let mut left = 2000;
        while robot.session.phase() != Phase::Finished && left > 0 {
            robot.cycle();
            left -= 1;
        }
        assert!(left > 0, "it ends");
        // A push that has come meanwhile is met for as long as the motion lasts.
        for _ in 0..1000 {
            assert_eq!(robot.cycle(), Outcome::Answered);
            let dynamics = robot.dynamics();
            let push = dynamics.mass_matrix.cholesky().expect("mass").solve(&load);
            robot.arm.dq += push * CYCLE_S;
        }
        assert!((robot.sent() + load).amax() < 0.1, "{}", robot.sent());
        robot.duty = Duty::Finish;
        assert_eq!(robot.cycle(), Outcome::Answered);
        assert!(robot.last.is_some_and(|command| command.is_last()));
        assert!((robot.sent() + load).amax() < 0.1);
        robot.duty = Duty::Listen;
        assert_eq!(robot.cycle(), Outcome::Heard);
        assert_eq!(robot.session.phase(), Phase::Finished);
    }
}

#[test]
fn no_step_is_larger_than_the_robot_bears() {
    for version in VERSIONS {
        let mut robot = Robot::new(version);
        robot.settle();
        // The reading of speed of two joints jumps: D times that is some Nm.
        let noise = [0.0, 0.3, 0.0, -0.3, 0.0, 0.0, 0.0];
        let mut flagged = 0;
        for cycle in 0..200_u32 {
            let arm = robot.arm;
            if cycle % 10 < 5 {
                robot.arm.dq += JointVector::from(noise);
            }
            robot.report();
            robot.arm = arm;
            // A third of the commands are lost: the step counts from what the robot has.
            let used = JointVector::from(robot.state.tau_j_d);
            let (_, command) = robot.send();
            let command = command.expect("an answer");
            let change = JointVector::from(command.tau_j_d) - used;
            assert!(change.amax() <= 1.0, "{version:?} {cycle}: {change}");
            let report = robot.session.last().expect("a cycle");
            let step = report.step.expect("the controller runs");
            let wanted = step.torque - step.gravity - used;
            for joint in 0..7 {
                let limited = report.limited.contains(joint);
                assert_eq!(
                    limited,
                    wanted[joint].abs() > 0.999,
                    "{cycle} {joint}: {wanted}"
                );
            }
            flagged += u64::from(report.limited.any());
            if cycle % 3 != 0 {
                robot.state.tau_j_d = command.tau_j_d;
            }
            robot.move_on();
        }
        assert!(flagged > 10, "{flagged}: nothing was limited");
        assert_eq!(robot.session.protocol().limited_cycles(), flagged);
    }
}

/// The observer gets what acted: where commands are lost the last one that arrived, and in
/// version 10 our own numbers, not those rounded to binary32.
#[test]
fn the_torque_that_acted_is_the_one_that_the_robot_used() {
    for version in VERSIONS {
        let mut robot = Robot::new(version);
        robot.settle();
        let mut largest = 0.0_f64;
        for cycle in 0..400 {
            robot.loses = cycle % 4 == 1;
            robot.cycle();
            // Nothing acts but the motors: a residual is an error of what is known to act.
            largest = largest.max(robot.session.state().data().residual().amax());
        }
        assert!(largest < 2e-3, "{version:?}: {largest} Nm");
    }
}

#[test]
fn lost_states_hold_the_arm_and_twenty_in_a_row_end_the_motion() {
    for (lost, phase, reason) in [
        (5, Phase::Moving, None),
        (6, Phase::Holding, None),
        (19, Phase::Holding, None),
        (20, Phase::Stopping, Some(StopReason::Link)),
    ] {
        let mut robot = Robot::new(Version::V10);
        robot.settle();
        robot.cycles(100);
        assert_eq!(robot.session.phase(), Phase::Moving);
        robot.state.message_id += lost;
        robot.cycle();
        let session = &robot.session;
        assert_eq!(
            (session.phase(), session.stop_reason()),
            (phase, reason),
            "{lost}"
        );
        assert_eq!(u64::from(session.last().expect("a cycle").lost), lost);
    }
}

/// A robot that has none of our newest commands says so by the torque that it uses.
#[test]
fn commands_that_do_not_arrive_hold_the_arm() {
    let mut robot = Robot::new(Version::V10);
    robot.settle();
    robot.cycles(300);
    let mut phases = Vec::new();
    for _ in 0..10 {
        robot.loses = true;
        robot.cycle();
        phases.push(robot.session.phase());
    }
    assert_eq!(phases[..6], [Phase::Moving; 6]);
    assert_eq!(phases[8..], [Phase::Holding; 2]);
    robot.cycles(60);
    assert_eq!(robot.session.phase(), Phase::Moving, "it is heard again");
}

#[test]
fn the_audit_sees_a_wrong_end_effector_and_a_wrong_load() {
    for version in VERSIONS {
        let audit = |change: fn(&mut State)| {
            let mut robot = Robot::new(version);
            robot.report();
            change(&mut robot.state);
            assert_eq!(robot.send().0, Outcome::Heard);
            *robot.session.audit()
        };
        let right = audit(|_| ());
        assert!(right.passes() && right.samples == 1, "{right:?}");
        assert_eq!(right.pose, Some(Agreement::Agrees));
        assert_eq!(right.holding, Some(Agreement::Agrees));
        assert!(
            right.pose_error < 1e-6 && right.holding_nm < 1e-4,
            "{right:?}"
        );
        assert_eq!(right.gravity, Agreement::NotSent);

        // The hand: it sits 0.1034 m ahead of the flange, turned by -45 degrees.
        let hand = audit(|state| {
            let turn = Matrix4::<f64>::new_rotation(Vector3::z() * -FRAC_PI_2 / 2.0);
            let hand = Matrix4::<f64>::new_translation(&Vector3::new(0.0, 0.0, 0.1034)) * turn;
            state.f_t_ee = columns(&hand);
            state.o_t_ee = columns(&(flange(&state.q) * hand));
        });
        assert!(hand.passes() && hand.pose_error < 1e-6, "{hand:?}");
        let other = audit(|state| state.f_t_ee[14] = 0.1034);
        assert_eq!(other.pose, Some(Agreement::Differs));
        assert!((other.pose_error - 0.1034).abs() < 1e-6);

        let load = audit(|state| state.tau_j[1] -= 5.0);
        assert_eq!(load.holding, Some(Agreement::Differs));
        assert_eq!(load.holding_joint, 2);
        assert!((load.holding_nm - 5.0).abs() < 1e-4);
        let moving = audit(|state| state.dq[0] = 0.1);
        assert_eq!(
            moving.holding, None,
            "in motion the torque is not gravity's alone"
        );
        assert!(!other.passes() && !load.passes());
    }
}
