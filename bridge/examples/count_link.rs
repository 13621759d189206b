//! Codec and session for an instruction counter: `controller-core/benches/instructions.sh` runs this
//! under callgrind, which counts each call of the function in `calls` that is its argument by itself. The
//! order of the calls is printed, case and name, one per line.
//!
//! A session's cycle is that of an arm at rest in the motion, with the whole control cycle of a task
//! of 3 rows in it; in every 50th the robot's model is compared besides.

#![cfg(not(target_os = "none"))]

use std::hint::black_box;

use arms::{FR3, LWR_IV, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use bridge::fci::Fci;
use bridge::lwr::Lwr;
use bridge::protocol::Protocol;
use bridge::session::{Outcome, Phase, Session, SessionConfig};
use bridge::source::ReferenceSource;
use controller_core::arm::{ArmParameters, LinkPoint};
use controller_core::law::null_space::NullDamping;
use controller_core::{Axes, ControllerConfig, NullSpace, Reference, Task, TaskGains, TaskSet};
use fci::client::Duty;
use fci::{RobotMode, State, Version, state};
use fri::{ControlScheme, InterfaceState, Measurement, Quality};

/// What is counted: nothing else may be in here, and none may call another. Results go through
/// `black_box`, or a jump would take the place of the call within, and nothing be counted.
mod calls {
    use std::hint::black_box;

    use bridge::fci::Fci;
    use bridge::lwr::Lwr;
    use bridge::protocol::Protocol;
    use bridge::session::{Outcome, Session};
    use fci::{Command, Error, State, StatePacket, Version, command};
    use fri::{Measurement, MeasurementPacket};

    use super::Rest;

    #[inline(never)]
    pub fn state(version: Version, datagram: &[u8]) -> Result<State, Error> {
        black_box(StatePacket::new_checked(version, datagram).map(|packet| State::parse(&packet)))
    }

    #[inline(never)]
    pub fn command(
        version: Version,
        command: &Command,
        bytes: &mut [u8; command::LEN_MAX],
    ) -> usize {
        black_box(command.emit(version, bytes).len())
    }

    #[inline(never)]
    pub fn measurement(datagram: &[u8]) -> Result<Measurement, fri::Error> {
        black_box(
            MeasurementPacket::new_checked(datagram).map(|packet| Measurement::parse(&packet)),
        )
    }

    #[inline(never)]
    pub fn answer(command: &fri::Command, bytes: &mut [u8; fri::Command::LEN]) {
        command.emit(bytes);
        black_box(bytes);
    }

    #[inline(never)]
    pub fn fci_session(
        session: &mut Session<Fci>,
        datagram: &[u8],
        source: &mut Rest,
        answer: &mut <Fci as Protocol>::Answer,
    ) -> Outcome<Error> {
        black_box(session.receive(datagram, source, answer))
    }

    #[inline(never)]
    pub fn fri_session(
        session: &mut Session<Lwr>,
        datagram: &[u8],
        source: &mut Rest,
        answer: &mut <Lwr as Protocol>::Answer,
    ) -> Outcome<fri::Error> {
        black_box(session.receive(datagram, source, answer))
    }
}

/// Says that a function of `calls` is about to be called, if it is the one that is counted: the
/// program's argument.
fn say(function: &str, case: &str, stage: &str) {
    if std::env::args().nth(1).as_deref() == Some(function) {
        println!("{case} {stage}");
    }
}

/// Calls of a codec.
const CODEC: usize = 16;

/// Cycles of a session that are counted, and those before them: the torque is there by then.
const COUNTED: usize = 100;
const BEFORE: usize = 1_200;

/// Holds where it starts.
pub struct Rest(Reference<f64>);

impl Rest {
    fn new() -> Self {
        Self(Reference::hold(0, [0.0; 7]))
    }
}

impl ReferenceSource for Rest {
    fn start(&mut self, origin: &Reference<f64>) {
        self.0.clone_from(origin);
    }

    fn sample(&mut self, _: f64) -> Option<Reference<f64>> {
        Some(self.0.clone())
    }
}

fn session<P: Protocol>(
    protocol: P,
    arm: &ArmParameters,
    flange: LinkPoint,
    stiffness: [f64; 7],
    cycle_s: f64,
) -> Session<P> {
    let task = Task::position(flange, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
    let controller = ControllerConfig {
        tasks: TaskSet::new(&[task]).expect("a task that can be"),
        null_space: NullSpace {
            damping: NullDamping::Inertia(10.0),
            ..NullSpace::diagonal(stiffness, [1.0; 7])
        },
        observer_gain: [50.0; 7],
        cycle_s,
        dead_cycles: 0,
    };
    Session::new(protocol, SessionConfig::new(arm, controller, flange, 1e6))
}

/// What a cycle is.
type Receive<P> = fn(
    &mut Session<P>,
    &[u8],
    &mut Rest,
    &mut <P as Protocol>::Answer,
) -> Outcome<<P as Protocol>::Error>;

/// Runs cycles of a session in motion: the last ones by `counted`, whose name it prints.
fn cycles<P: Protocol>(
    [function, name]: [&str; 2],
    session: &mut Session<P>,
    mut datagram: impl FnMut(usize, &mut Session<P>) -> Vec<u8>,
    counted: Receive<P>,
) {
    let mut rest = Rest::new();
    for cycle in 0..BEFORE + COUNTED {
        let bytes = datagram(cycle, session);
        let mut answer = P::EMPTY;
        let outcome = if cycle < BEFORE {
            session.receive(&bytes, &mut rest, &mut answer)
        } else {
            // Every 50th cycle, the first among them, compares the robot's model.
            let audited = cycle % 50 == 0;
            say(
                function,
                name,
                if audited {
                    "session_audited"
                } else {
                    "session"
                },
            );
            counted(
                black_box(session),
                black_box(&bytes),
                &mut rest,
                &mut answer,
            )
        };
        assert!(cycle == 0 || outcome == Outcome::Answered, "{outcome:?}");
    }
    assert_eq!(
        session.phase(),
        Phase::Moving,
        "{name}: {:?}",
        session.fault()
    );
}

fn fci(version: Version) {
    let name = format!("link-fci-{}", version.number());
    let mut robot = State {
        message_id: 1_000_000,
        robot_mode: RobotMode::Move,
        q: [0.0, -45.0, 0.0, -135.0, 0.0, 90.0, 45.0].map(f64::to_radians),
        ..State::default()
    };
    let emitted = |state: &State| {
        let mut room = [0; state::LEN_MAX];
        let bytes = state.emit(version, &mut room).expect("modes of all");
        bytes.to_vec()
    };
    for call in 0..CODEC {
        robot.q[call % 7] += 1e-3;
        let bytes = emitted(&robot);
        say("state", &name, "state");
        let read = calls::state(version, black_box(&bytes));
        assert!(black_box(read).is_ok());
        let command = fci::Command::torque(version, call as u64, robot.q, false);
        say("command", &name, "command");
        let mut room = [0; fci::command::LEN_MAX];
        let written = calls::command(version, black_box(&command), black_box(&mut room));
        assert_eq!(written, version.command_len());
    }
    let (protocol, flange) = (Fci::new(version), FR3.flange_point());
    let mut session = session(protocol, &FR3, flange, [10.0; 7], 0.001);
    let datagram = |cycle, session: &mut Session<Fci>| {
        let duty = if cycle == 0 {
            Duty::Listen
        } else {
            Duty::Answer
        };
        session.protocol_mut().attend(duty);
        robot.message_id += 1;
        emitted(&robot)
    };
    cycles(
        ["fci_session", &name],
        &mut session,
        datagram,
        calls::fci_session,
    );
}

fn fri() {
    let mut robot = Measurement {
        state: InterfaceState::Command,
        quality: Quality::Perfect,
        period_s: 0.002,
        command_period_s: 0.002,
        joint_position: [0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0],
        ..Measurement::default()
    };
    robot.drives.power = 0x7F;
    robot.drives.control = ControlScheme::JointImpedance;
    let emitted = |robot: &Measurement| {
        let mut room = [0; Measurement::LEN];
        robot.emit(&mut room);
        room.to_vec()
    };
    for call in 0..CODEC {
        robot.joint_position[call % 7] += 1e-3;
        let bytes = emitted(&robot);
        say("measurement", "link-fri", "measurement");
        assert!(black_box(calls::measurement(black_box(&bytes))).is_ok());
        let command = fri::Command {
            joint_torque: robot.joint_position,
            ..fri::Command::default()
        };
        say("answer", "link-fri", "command");
        let mut room = [0; fri::Command::LEN];
        calls::answer(black_box(&command), black_box(&mut room));
    }
    let mut session = session(Lwr::new(), &LWR_IV, LWR_IV_FLANGE, LWR_IV_STIFFNESS, 0.002);
    // It mirrors what it was sent.
    let datagram = |_, _: &mut Session<Lwr>| {
        robot.header.counter = robot.header.counter.wrapping_add(1);
        robot.header.reflected = robot.header.counter.wrapping_sub(1);
        emitted(&robot)
    };
    cycles(
        ["fri_session", "link-fri"],
        &mut session,
        datagram,
        calls::fri_session,
    );
}

fn main() {
    fri();
    fci(Version::V5);
    fci(Version::V10);
}
