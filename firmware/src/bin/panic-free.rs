//! Proof that constructor and cycle cannot panic, those of the controller and of the
//! velocity-level resolver, and that codec and both ends of the FCI cannot: on the target the panic handler calls a function that does
//! not exist, so that this image links only if no panic is reachable from one to seven
//! task rows in either precision. There is no allocator either. On the host it runs what
//! it links.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;

use arms::{LWR_IV, LWR_IV_FLANGE};
use controller_core::cycle::record::Recorder;
use controller_core::resolver::{Resolver, ResolverConfig, ResolverState};
use controller_core::task::{AfterStale, Stale};
use controller_core::{
    Axes, Capacity, Change, Controller, Link, LinkPoint, Measurement, Order, Reference, State,
    Target, Task, TaskGains, TaskSet,
};
use fci::client::{Client, Duty, Facts, Start};
use fci::state::{FIELDS, LEN_MAX, StatePacket};
use fci::stream::REQUEST_LEN_MAX;
use fci::{Command, Reply, Request, RobotErrors, Sequence, Stream, Version, command, robot};
use firmware::log::Number;
use firmware::scenario::{self, FixedScenario};

/// A level on a link with so many rows.
const fn level(link: Link, rows: usize) -> Task {
    let point = LinkPoint {
        link,
        ..LWR_IV_FLANGE
    };
    let axes = match rows {
        1 => Axes::X,
        2 => Axes::XY,
        _ => Axes::XYZ,
    };
    Task::position(point, axes, TaskGains::uniform(400.0, 40.0))
}

/// Whether levels on flange, elbow and wrist make a controller with `ROWS` rows whose
/// cycle is clean, everything unknown to the compiler but the number of rows.
fn exercise<T: Number, const ROWS: usize>() -> bool {
    // Three rows on the flange, three on the elbow, the rest on the wrist.
    let levels = [
        level(Link::L7, ROWS),
        level(Link::L3, ROWS.saturating_sub(3)),
        level(Link::L5, ROWS.saturating_sub(6)),
    ];
    let used = levels.get(..ROWS.div_ceil(3)).unwrap_or_default();
    let (Ok(mut config), Ok(tasks)) = (
        scenario::config(FixedScenario::TwoLevel),
        TaskSet::new(black_box(used)),
    ) else {
        return false;
    };
    config.tasks = tasks;
    let Ok(controller) = Controller::<T>::new(black_box(&LWR_IV), black_box(&config)) else {
        return false;
    };
    let q = FixedScenario::TwoLevel.start_deg().map(f64::to_radians);
    let measurement = black_box(Measurement {
        q: q.map(T::from_f64).into(),
        dq: [T::HALF; 7].into(),
        interval_s: T::from_f64(scenario::CYCLE_S),
    });
    let mut reference = Reference::hold(controller.level_count(), measurement.q);
    reference.targets_mut().fill(Target::position([T::HALF; 3]));
    let reference = black_box(reference);
    let mut state = State::new();
    let mut recorder = Recorder::<T, 4>::new();
    let step = controller.step(&mut state, &measurement, &reference);
    recorder.push(&measurement, &step);
    state.set_applied_torque(black_box(&step.torque));
    state.resume_after_gap();
    state.reset();
    black_box((&recorder, &controller.rest_reference(&measurement.q)));
    let resolver = ResolverConfig {
        tasks,
        gain: 10.0,
        cycle_s: scenario::CYCLE_S,
    };
    let Ok(resolver) = Resolver::<T>::new(black_box(&LWR_IV), black_box(&resolver)) else {
        return false;
    };
    let mut state = ResolverState::new(measurement.q);
    let resolution = resolver.step(&mut state, &measurement, &reference);
    state.reset();
    step.status.fault.is_none()
        && controller.level_count() == ROWS.div_ceil(3)
        && resolution.status.fault.is_none()
}

/// Whether tasks and gains change in a controller with all slots and rows, everything unknown to
/// the compiler.
fn exercise_changes<T: Number>() -> bool {
    let tasks = TaskSet::new(black_box(&[level(Link::L7, 3), level(Link::L3, 2)]));
    let room = black_box(Capacity {
        levels: 7,
        rows: 12,
    });
    let (Ok(mut config), Ok(tasks)) = (
        scenario::config(FixedScenario::TwoLevel),
        tasks
            .map(|tasks| tasks.without(black_box(1)))
            .and_then(|tasks| tasks.with_capacity(room)),
    ) else {
        return false;
    };
    config.tasks = tasks;
    let Ok(controller) = Controller::<T>::new(black_box(&LWR_IV), black_box(&config)) else {
        return false;
    };
    let q = FixedScenario::TwoLevel.start_deg().map(f64::to_radians);
    let measurement = black_box(Measurement {
        q: q.map(T::from_f64).into(),
        dq: [T::HALF; 7].into(),
        interval_s: T::from_f64(scenario::CYCLE_S),
    });
    let mut state = State::new();
    let mut reference = Reference::hold(controller.level_count(), measurement.q);
    reference.set_age(black_box(1), black_box(T::ONE));
    let mut stale = level(Link::L5, 2);
    stale.stale = Some(Stale {
        age_s: 0.5,
        then: AfterStale::Release,
    });
    let changes = [
        Change::Add {
            slot: 1,
            task: level(Link::L3, 2),
            place: 0,
        },
        Change::Add {
            slot: 6,
            task: stale,
            place: Change::BELOW_ALL,
        },
        Change::Reorder(Order::new(&[6, 0, 1]).unwrap_or(Order::NONE)),
        Change::Gains {
            slot: 0,
            gains: TaskGains::uniform(100.0, 20.0),
        },
        Change::NullSpace(config.null_space),
        Change::Remove { slot: 0 },
    ];
    let mut clean = true;
    for change in black_box(&changes) {
        let begun = controller.transition(change, black_box(0.5));
        let begun = begun.and_then(|transition| controller.begin(&mut state, &transition));
        clean &= begun.is_ok();
        let step = controller.step(&mut state, &measurement, black_box(&reference));
        clean &= step.status.fault.is_none();
    }
    black_box((
        controller.order(&state),
        controller.rest_reference_of(&state, &measurement.q),
    ));
    state.reset();
    clean
}

/// Everything that the codec of the FCI does with bytes that nobody knows; whether it takes
/// what it has made itself.
fn exercise_codec(version: Version) -> bool {
    let version = black_box(version);
    let state = black_box(fci::State::default());
    let mut room = [0; LEN_MAX];
    let Ok(datagram) = state.emit(version, &mut room) else {
        return false;
    };
    let Ok(packet) = StatePacket::new_checked(version, black_box(datagram)) else {
        return false;
    };
    let numbers = packet.check_finite(black_box(&FIELDS)).is_ok();
    let same = fci::State::parse(&packet) == state && packet.q() == state.q;
    let errors: RobotErrors = packet.errors().iter().collect();
    let mut sequence = Sequence::new();
    let fresh = sequence.receive(packet.message_id()).is_fresh();

    let answer = Command::torque(version, packet.message_id(), black_box([0.5; 7]), false);
    let mut room = [0; command::LEN_MAX];
    let read = Command::parse(version, black_box(answer.emit(version, &mut room)));
    let answered = read.is_ok_and(|read| read.check().is_ok() && read == answer);

    // Both ends of a stream: what is no request may be a reply.
    let mut stream = Stream::new([0; REQUEST_LEN_MAX], black_box(REQUEST_LEN_MAX));
    let mut bytes = black_box(&[2, 0, 0, 0, 7, 0, 0, 0, 12, 0, 0, 0][..]);
    let mut requests = 0;
    while let Ok(Ok(Some(message))) = stream.as_mut().map(|it| it.next(&mut bytes)) {
        let mut room = [0; REQUEST_LEN_MAX];
        match Request::parse(version, &message) {
            Ok(request) if request.check().is_ok() => {
                requests += usize::from(request.emit(version, message.id, &mut room).is_ok());
            }
            _ => {
                let reply = Reply::parse(version, &message);
                black_box(reply.is_ok_and(|it| it.emit(version, message.id, &mut room).is_ok()));
            }
        }
    }
    numbers && same && errors.is_empty() && fresh && answered && requests == 1
}

/// The robot's end of the FCI with bytes, an arm and a person that nobody knows; whether a robot that
/// nobody has connected to holds its arm.
fn exercise_robot(version: Version) -> bool {
    let settings = robot::Settings::new(black_box(version), robot::Limits::FR3);
    let mut robot = robot::Robot::new(black_box(settings), black_box(&b"<robot/>"[..]));
    let arm = black_box(robot::Arm {
        q: [0.5; 7],
        dq: [0.0; 7],
        tau_j: [0.0; 7],
        tau_ext: [0.0; 7],
        wrench: [0.0; 6],
        o_t_f: robot::IDENTITY,
        twist: [0.0; 6],
        theta: [0.5; 7],
        dtheta: [0.0; 7],
    });
    let mut bytes = black_box(&[2, 0, 0, 0, 7, 0, 0, 0, 12, 0, 0, 0][..]);
    while let Ok(Some(handled)) = robot.receive(&mut bytes) {
        black_box(handled);
    }
    let mut room = [0; 64];
    let said = robot.replies(black_box(&mut room));
    let mut room = [0; LEN_MAX];
    let state = robot.state(&arm, &black_box(robot::Operator::ABSENT));
    black_box(state.emit(version, &mut room).is_ok());
    black_box(robot.command(black_box(&room)));
    let held = robot.advance() == robot::Drive::Hold;
    black_box((robot.load(), robot.ended(), robot.waits(), robot.mode()));
    robot.disconnect();
    held && said == 0
}

/// The client's machine of the FCI with bytes and states that nobody knows; whether it says
/// Connect and no state is answered before a motion.
fn exercise_client() -> bool {
    let mut client = Client::new(black_box(true));
    client.connected(black_box(50_000));
    let connect = client.transmit().len();
    client.transmitted(black_box(connect));
    client.receive(black_box(&[0, 0, 0, 0, 9, 0, 0, 0, 12, 0, 0, 0]), &mut ());
    let duty = client.state(black_box(&Facts::default()));
    client.start(black_box(&Start::uniform(20.0, 20.0)));
    if client.wants_new_connection() {
        client.halt();
        client.closed();
        client.silent();
    }
    client.finish();
    let code = client.stopped().map(|stop| stop.exit_code());
    connect == 16 && duty == Duty::Listen && client.strays() == 1 && code == Some(0)
}

/// Both precisions, every number of rows; every version.
#[cfg_attr(target_os = "none", unsafe(no_mangle))]
#[allow(unsafe_code)] // the name of the entry
extern "C" fn exercise_all() -> bool {
    #[cfg(feature = "provoke-panic")]
    assert!(black_box([0.0; 7])[0] < 1.0, "wanted");
    fn precision<T: Number>() -> bool {
        exercise::<T, 1>()
            & exercise::<T, 2>()
            & exercise::<T, 3>()
            & exercise::<T, 4>()
            & exercise::<T, 5>()
            & exercise::<T, 6>()
            & exercise::<T, 7>()
            & exercise_changes::<T>()
    }
    let versions = Version::ALL.map(|version| exercise_codec(version) & exercise_robot(version));
    precision::<f64>() & precision::<f32>() & versions.into_iter().all(|it| it) & exercise_client()
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    if exercise_all() {
        println!("1 to 7 rows, f64 and f32; codec, robot and client of the FCI: built and run");
        0.into()
    } else {
        eprintln!(
            "a controller was refused, its cycle was not clean or the FCI not as it should be"
        );
        1.into()
    }
}

#[cfg(target_os = "none")]
#[panic_handler]
#[allow(unsafe_code)]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_reachable() -> !;
    }
    // SAFETY: never linked.
    unsafe { a_panic_is_reachable() }
}
