//! From joining to running: an arm that moves under what it is sent and under a torque that
//! nobody told the controller of. Nothing of it may show at time 0.

use arms::{LWR_IV, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Phase, Session, SessionConfig};
use bridge::source::ReferenceSource;
use controller_core::arm::ArmModel;
use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::kinematics::Kinematics;
use controller_core::joint::{JointState, JointVector};
use controller_core::law::null_space::NullDamping;
use controller_core::task::trajectory::quintic;
use controller_core::{
    Axes, ControllerConfig, NullSpace, Reference, Target, Task, TaskGains, TaskSet,
};
use fri::{Command, CommandPacket, ControlScheme, InterfaceState, Measurement, Quality};

const START: [f64; 7] = [0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0];
const CYCLE_S: f64 = 0.002;
/// K_I \[1/s\].
const RATE: f64 = 20.0;
/// What acts besides the motors \[Nm\], as of a load that is not in the model.
const UNKNOWN: [f64; 7] = [0.3, -2.0, 0.2, 1.0, -0.01, 0.02, 0.0];
/// Cycles from command state to time 0.
const SETTLE: usize = 500;

/// A straight motion of 5 cm from time 0 on, from rest to rest in a second.
struct Straight(Reference<f64>);

impl Straight {
    const WAY_M: f64 = 0.05;
}

impl ReferenceSource for Straight {
    fn start(&mut self, origin: &Reference<f64>) {
        self.0.clone_from(origin);
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        let mut reference = self.0.clone();
        let [share, rate, change] = quintic(t_s);
        let Target::Position { x, dx, ddx } = &mut reference.targets_mut()[0] else {
            panic!("the flange has a position");
        };
        x.z += Self::WAY_M * share;
        dx.z = Self::WAY_M * rate;
        ddx.z = Self::WAY_M * change;
        Some(reference)
    }
}

/// An arm by its equation of motion; gravity is compensated exactly.
struct Robot {
    model: ArmModel<f64>,
    arm: JointState<f64>,
    /// Torques on their way, the next one last.
    way: Vec<JointVector<f64>>,
    measurement: Measurement,
    session: Session<Lwr>,
    source: Straight,
}

impl Robot {
    /// Whose torques act `dead_cycles` after they arrive.
    fn new(dead_cycles: u8) -> Self {
        let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
        let controller = ControllerConfig {
            tasks: TaskSet::new(&[flange]).expect("a task that can be"),
            null_space: NullSpace {
                damping: NullDamping::Inertia(10.0),
                ..NullSpace::diagonal(LWR_IV_STIFFNESS, [1.0; 7])
            },
            observer_gain: [RATE; 7],
            cycle_s: CYCLE_S,
            dead_cycles,
        };
        let config = SessionConfig::new(&LWR_IV, controller, LWR_IV_FLANGE, 10.0);
        let mut measurement = Measurement {
            state: InterfaceState::Monitor,
            quality: Quality::Perfect,
            period_s: CYCLE_S as f32,
            command_period_s: CYCLE_S as f32,
            ..Measurement::default()
        };
        measurement.drives.power = 0x7F;
        measurement.drives.control = ControlScheme::JointImpedance;
        Self {
            model: ArmModel::new(&LWR_IV).expect("the built-in arm"),
            arm: JointState {
                q: START.into(),
                dq: JointVector::zeros(),
            },
            way: vec![JointVector::zeros(); dead_cycles.into()],
            measurement,
            session: Session::new(Lwr::new(), config),
            source: Straight(Reference::hold(0, [0.0; 7])),
        }
    }

    /// One cycle: what is sent acts until the next.
    fn cycle(&mut self) {
        let header = &mut self.measurement.header;
        header.counter = header.counter.wrapping_add(1);
        let q: [f64; 7] = self.arm.q.into();
        self.measurement.joint_position = q.map(|q| q as f32);
        self.measurement.commanded_position = self.measurement.joint_position;
        let (mut bytes, mut answer) = ([0; Measurement::LEN], [0; ANSWER_LEN]);
        self.measurement.emit(&mut bytes);
        let outcome = self.session.receive(&bytes, &mut self.source, &mut answer);
        assert_eq!(outcome, Outcome::Answered);
        let command = Command::parse(&CommandPacket::new_checked(answer).expect("a good answer"));
        self.measurement.header.reflected = command.header.counter;
        self.way
            .insert(0, command.joint_torque.map(f64::from).into());
        let torque = self.way.pop().expect("what was put in") + JointVector::from(UNKNOWN);
        if self.measurement.state == InterfaceState::Command {
            self.move_on(&torque);
        }
    }

    /// A cycle of M ddq + C dq = `torque` \[Nm\], in steps whose error is far below what is
    /// looked for.
    fn move_on(&mut self, torque: &JointVector<f64>) {
        const STEPS: u32 = 8;
        let step_s = CYCLE_S / f64::from(STEPS);
        let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
        for _ in 0..STEPS {
            kinematics.update(&self.model, &self.arm);
            dynamics.update(&self.model, &kinematics, &self.arm);
            let acceleration = (dynamics.mass_matrix.cholesky())
                .expect("a mass matrix")
                .solve(&(torque - dynamics.coriolis));
            self.arm.dq += acceleration * step_s;
            self.arm.q += self.arm.dq * step_s;
        }
    }

    /// Up to the last cycle before time 0.
    fn settle(&mut self) {
        for _ in 0..10 {
            self.cycle();
        }
        self.measurement.state = InterfaceState::Command;
        for _ in 0..SETTLE {
            self.cycle();
        }
        assert_eq!(self.phase(), Phase::Starting, "{:?}", self.session.fault());
    }

    fn phase(&self) -> Phase {
        self.session.phase()
    }

    fn residual(&self) -> JointVector<f64> {
        *self.session.state().data().residual()
    }

    /// What is sent \[Nm\].
    fn sent(&self) -> JointVector<f64> {
        self.session.last().expect("a cycle").sent
    }

    /// Position \[m\] and velocity \[m/s\] that the flange follows.
    fn followed(&self) -> [[f64; 3]; 2] {
        let controller = self.session.controller().expect("a first datagram");
        let reference = controller.followed_reference(self.session.state());
        match reference.targets()[0] {
            Target::Position { x, dx, .. } => [x.into(), dx.into()],
            other => panic!("{other:?}"),
        }
    }
}

/// Largest difference of two vectors.
fn apart<const N: usize>(one: [f64; N], two: [f64; N]) -> f64 {
    let pairs = one.iter().zip(&two);
    pairs.fold(0.0, |most, (one, two)| (one - two).abs().max(most))
}

#[test]
fn at_time_zero_the_residual_is_what_acts_and_goes_on() {
    for dead_cycles in [0, 2] {
        let mut robot = Robot::new(dead_cycles);
        robot.settle();
        // 20 time constants have passed. What is left is the noise of binary32 positions and,
        // with the motion, M times what the acceleration changes in the lag of the estimated
        // speed: 3 m/s3 of the flange for 3 ms.
        let (noise_nm, step_nm) = (0.02, 0.003);
        let mut last = robot.residual();
        assert!((last - JointVector::from(UNKNOWN)).amax() < noise_nm);
        for cycle in 0..50 {
            robot.cycle();
            assert_eq!(robot.phase(), Phase::Moving, "{dead_cycles} {cycle}");
            let now = robot.residual();
            assert!((now - last).amax() < step_nm, "{dead_cycles} {cycle}");
            assert!((now - JointVector::from(UNKNOWN)).amax() < noise_nm);
            last = now;
        }
    }
}

/// While the torque grows the observer knows the share that was sent: it is as near to what
/// acts as its lag permits, and does not take the rest for a push.
#[test]
fn the_observer_counts_the_torque_that_acts() {
    let mut robot = Robot::new(0);
    for _ in 0..10 {
        robot.cycle();
    }
    robot.measurement.state = InterfaceState::Command;
    for cycle in 0..SETTLE {
        robot.cycle();
        let share = 1.0 - (-RATE * CYCLE_S * cycle as f64).exp();
        let expected = JointVector::from(UNKNOWN) * share;
        let apart_nm = (robot.residual() - expected).amax();
        // The estimated speed is 2.8 ms late, that over 1/K_I times the largest torque.
        assert!(apart_nm < 2.8e-3 * RATE * 2.0, "{cycle}: {apart_nm}");
    }
}

#[test]
fn at_time_zero_the_torque_makes_no_step() {
    for dead_cycles in [0, 2] {
        let mut robot = Robot::new(dead_cycles);
        robot.settle();
        let mut last = robot.sent();
        for cycle in 0..50 {
            robot.cycle();
            let step_nm = (robot.sent() - last).amax();
            // Of the motion: its acceleration, which starts with 3 m/s3, times a mass of 4 kg.
            assert!(step_nm < 0.03, "{dead_cycles} {cycle}: {step_nm} Nm");
            last = robot.sent();
        }
    }
}

#[test]
fn at_time_zero_the_reference_goes_on_from_where_it_held() {
    let mut robot = Robot::new(0);
    robot.settle();
    let held = robot.followed();
    let start = robot.source.0.clone();
    for cycle in 0..50 {
        robot.cycle();
        let [x, dx] = robot.followed();
        let t_s = CYCLE_S * f64::from(cycle);
        let [share, rate, _] = quintic(t_s).map(|value| Straight::WAY_M * value);
        // To the last bits: nothing is joined.
        assert!(apart(x, [held[0][0], held[0][1], held[0][2] + share]) < 1e-12);
        assert!(apart(dx, [0.0, 0.0, rate]) < 1e-12);
        let step = robot.session.last().and_then(|cycle| cycle.step);
        assert!(!step.expect("a step").status.joining.any(), "{cycle}");
    }
    assert_eq!(robot.source.0, start, "started once");
}
