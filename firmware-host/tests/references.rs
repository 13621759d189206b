//! References that are not the scenario's: streamed orientations reach the arm, streams
//! with wrong levels do not, and a target of another kind ends the run as a fault.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Phase, Session};
use bridge::source::ReferenceSource;
use cell::names::PlantKind;
use cell::realtime::Realtime;
use cell::scenario::{EquippedArm, ReferenceSpec, Scenario, TaskSpec};
use controller_core::fault::FaultKind;
use controller_core::joint::Vector3;
use controller_core::task::orientation::{self, Quaternion};
use controller_core::task::trajectory::Rotation;
use controller_core::{Controller, Reference, Target, TaskSet};
use firmware_host::changes;
use firmware_host::peer::IN_A_ROW;
use firmware_host::recorder;
use firmware_host::run::{Endpoint, converse};
use firmware_host::stream::{Setpoint, Stream};
use firmware_host::summary::ending;
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{LwrRobot, MEASUREMENT_BYTES, RobotOptions, RobotSetup};

/// Longer than any of these runs.
const NEVER: Duration = Duration::from_secs(600);

/// When a stream is joined that flows from the start: 0.3 s and two cycles.
const JOINED_S: f64 = 0.304;

/// Position of the flange, and below it its orientation.
fn scenario() -> Scenario {
    let mut scenario = Scenario::find("two-level").expect("built in");
    scenario.duration_s = 2.0;
    let mut level = scenario.levels[0].clone();
    level.task = TaskSpec::Orientation;
    level.reference = ReferenceSpec::Hold {};
    scenario.levels.push(level);
    scenario
}

fn tasks(scenario: &Scenario) -> TaskSet {
    let config = scenario.controller_config(0);
    config.expect("a good scenario").tasks
}

fn session(scenario: &Scenario) -> Session<Lwr> {
    let config = scenario.session_config(0, scenario.duration_s);
    Session::new(Lwr::new(), config.expect("a good scenario"))
}

fn robot(scenario: &Scenario) -> LwrRobot {
    LwrRobot::new(RobotSetup {
        scenario: scenario.clone(),
        plant: PlantKind::Ideal,
        contacts: false,
        seed: 1,
        plant_options: PlantOptions::default(),
        options: RobotOptions::default(),
    })
}

/// Robot and session in one process until the motion is over; `each` sees every cycle of
/// it, before the robot moves on.
fn run(
    scenario: &Scenario,
    source: &mut impl ReferenceSource,
    mut each: impl FnMut(f64, &Session<Lwr>, &LwrRobot),
) {
    let (mut robot, mut session) = (robot(scenario), session(scenario));
    let (mut measurement, mut answer) = ([0; MEASUREMENT_BYTES], [0; ANSWER_LEN]);
    while !robot.is_finished() {
        robot.measurement(&mut measurement);
        let outcome = session.receive(&measurement, source, &mut answer);
        assert_eq!(outcome, Outcome::Answered);
        let cycle = session.last().expect("a cycle");
        if cycle.phase == Phase::Moving {
            each(cycle.t_s, &session, &robot);
        }
        robot.command(&answer, 0.0);
        robot.advance();
    }
    assert_eq!(session.phase(), Phase::Moving);
    assert_eq!(session.stop_reason(), None);
}

fn quaternion(target: &Target<f64>) -> &Quaternion<f64> {
    match target {
        Target::Orientation { q, .. } => q,
        other => panic!("{other:?}"),
    }
}

fn words(numbers: &[f64]) -> String {
    let words: Vec<_> = numbers.iter().map(f64::to_string).collect();
    words.join(" ")
}

/// A planner in the same process: the flange holds and its frame turns to and fro.
struct Planner {
    stream: Stream,
    sender: SyncSender<Setpoint>,
    tasks: TaskSet,
    arm: EquippedArm,
    origin: Reference<f64>,
}

impl Planner {
    fn new(scenario: &Scenario) -> Self {
        let (sender, queue) = sync_channel(1);
        let tasks = tasks(scenario);
        Self {
            stream: Stream::from_channel(queue, NEVER),
            sender,
            tasks,
            arm: scenario.arm(),
            origin: Reference::hold(2, [0.0; 7]),
        }
    }
}

/// 0.1 rad about an axis that is none of the base's.
fn turned(origin: &Quaternion<f64>, t_s: f64) -> Target<f64> {
    let swing = Rotation::Swing {
        axis: Vector3::from([0.6, 0.0, 0.8]),
        amplitude_rad: 0.1,
        period_s: 2.0,
        growth_s: 1.0,
    };
    swing.sample(origin, t_s)
}

impl ReferenceSource for Planner {
    fn start(&mut self, origin: &Reference<f64>) {
        self.origin.clone_from(origin);
        self.stream.start(origin);
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        let [Target::Position { x, .. }, frame] = self.origin.targets() else {
            panic!("{:?}", self.origin);
        };
        let Target::Orientation { q, w, dw } = turned(quaternion(frame), t_s) else {
            panic!("an orientation");
        };
        // A quaternion need not be of norm 1.
        let parts = [x.as_slice(), &[0.0; 6], (q * -1.5).as_slice()].concat();
        let text = words(&[&parts, w.as_slice(), dw.as_slice()].concat());
        let setpoint = Setpoint::parse(&text, &self.tasks, &self.arm).expect("two levels");
        self.sender.send(setpoint).expect("room for one");
        self.stream.sample(t_s)
    }
}

/// What the levels and the posture follow.
fn followed(session: &Session<Lwr>) -> Reference<f64> {
    let controller = session.controller().expect("a first datagram");
    controller.followed_reference(session.state())
}

#[test]
fn the_arm_follows_a_streamed_orientation() {
    let scenario = scenario();
    let mut planner = Planner::new(&scenario);
    let (mut cycles, mut start) = (0, None);
    let mut widest = 0.0_f64;
    run(&scenario, &mut planner, |t_s, session, robot| {
        let reference = followed(session);
        let q = *quaternion(&reference.targets()[1]);
        let start = start.get_or_insert(q);
        if t_s < JOINED_S {
            return;
        }
        let Target::Orientation {
            q: wanted,
            w,
            dw: acceleration,
        } = turned(start, t_s)
        else {
            panic!("an orientation");
        };
        let Target::Orientation { w: v, dw: a, .. } = reference.targets()[1] else {
            panic!("an orientation");
        };
        // Numbers go through text without loss; the norm is divided out.
        assert!(orientation::chord(&wanted, &q).amax() < 1e-14, "{t_s}");
        assert_eq!((v, a), (w, acceleration), "{t_s}");
        let controller = session.controller().expect("a cycle is known");
        let actual = controller.rest_reference(&robot.plant().state().q);
        let error = orientation::chord(&wanted, quaternion(&actual.targets()[1])).norm();
        // Without friction and contacts only the lateness of the estimated speed is left:
        // 2.8 ms of 1.5 rad/s2 times K_d / K_p of 0.1 s, 0.4 mrad.
        assert!(error < 1e-3, "{t_s}: {error}");
        widest = widest.max(orientation::chord(&wanted, start).norm());
        cycles += 1;
    });
    assert!(cycles > 700 && widest > 0.09, "{cycles} {widest}");
}

/// A planner that speaks before the motion begins, of another place than where the arm is.
struct Early(Planner);

const AWAY_M: f64 = 0.05;

impl Early {
    fn speak(&self) {
        let Self(planner) = self;
        let place = place(&planner.origin) + Vector3::from([0.0, AWAY_M, 0.0]);
        let text = words(place.as_slice()) + &" 0".repeat(6);
        let setpoint = Setpoint::parse(&text, &planner.tasks, &planner.arm).expect("one level");
        planner.sender.send(setpoint).expect("room for one");
    }
}

impl ReferenceSource for Early {
    fn start(&mut self, origin: &Reference<f64>) {
        self.0.start(origin);
        self.speak();
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        let sampled = self.0.stream.sample(t_s);
        self.speak();
        sampled
    }
}

/// Where level 1 should be.
fn place(reference: &Reference<f64>) -> Vector3<f64> {
    match reference.targets() {
        [Target::Position { x, .. }, ..] => *x,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_stream_that_flows_before_the_motion_is_joined_without_a_jump() {
    let scenario = scenario();
    let mut early = Early(Planner::new(&scenario));
    let mut path = Vec::new();
    run(&scenario, &mut early, |_, session, _| {
        path.push(place(&followed(session)));
    });
    let start = place(&early.0.origin);
    path.insert(0, start);
    // The way is joined in 0.3 s, with 15/8 of its mean speed at most: 0.625 mm in a cycle.
    let steps = path.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    let longest = steps.fold(0.0, f64::max);
    assert!(longest < 0.626e-3, "{longest}");
    let way = path.last().expect("cycles") - start;
    // A difference of numbers below 1 m.
    assert!((way.norm() - AWAY_M).abs() < 1e-15, "{way}");
}

/// Nine numbers for each level, as if the orientation were a position: the arm stays where
/// it is, the first level too, until a reference comes that is one.
#[test]
fn a_stream_of_nine_numbers_per_level_is_not_followed() {
    let scenario = scenario();
    let address = {
        let free = UdpSocket::bind("127.0.0.1:0").expect("a port");
        free.local_addr().expect("an address")
    };
    let tasks = tasks(&scenario);
    let mut stream =
        Stream::listen(address, None, &tasks, &scenario.arm(), NEVER, None).expect("a free port");
    let planner = UdpSocket::bind("127.0.0.1:0").expect("a port");
    planner.connect(address).expect("loopback");
    let wrong = "-0.5 0 0.5 0 0 0 0 0 0 ".repeat(2);
    for _ in 0..20 {
        planner.send(wrong.as_bytes()).expect("sent");
    }
    let deadline = Instant::now() + Duration::from_secs(20);
    while stream.figures().unusable < 20 {
        assert!(Instant::now() < deadline, "{:?}", stream.figures());
        thread::sleep(Duration::from_millis(1));
    }
    let mut first = None;
    run(&scenario, &mut stream, |_, session, _| {
        let reference = followed(session);
        let first = first.get_or_insert_with(|| reference.clone());
        assert_eq!(reference, *first);
    });
    assert!(first.is_some());

    let right = "-0.5 0 0.5 0 0 0 0 0 0 1 0 0 0 0 0 0 0 0 0";
    planner.send(right.as_bytes()).expect("sent");
    let mut sampled = None;
    while sampled.is_none() {
        assert!(Instant::now() < deadline, "no reference");
        thread::sleep(Duration::from_millis(1));
        sampled = stream.sample(0.0);
    }
    let expected = [
        Target::position([-0.5, 0.0, 0.5]),
        Target::orientation([1.0, 0.0, 0.0, 0.0]),
    ];
    assert_eq!(sampled.expect("a reference").targets(), expected);
    assert_eq!((stream.figures().unusable, stream.figures().taken), (20, 1));
}

/// Follows nothing for 0.5 s, then wants an orientation of level 1, which has none.
struct Confused {
    origin: Option<Reference<f64>>,
}

impl ReferenceSource for Confused {
    fn start(&mut self, origin: &Reference<f64>) {
        self.origin = Some(origin.clone());
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        let mut reference = self.origin.clone()?;
        if t_s > 0.5 {
            reference.targets_mut()[0] = Target::orientation([1.0, 0.0, 0.0, 0.0]);
        }
        Some(reference)
    }
}

/// The robot's end, in lock-step, until nobody answers any more.
fn serve(scenario: &Scenario, to: SocketAddr) {
    let mut robot = robot(scenario);
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    socket.connect(to).expect("loopback");
    let patience = Some(Duration::from_secs(5));
    socket.set_read_timeout(patience).expect("a timeout");
    let (mut measurement, mut answer) = ([0; MEASUREMENT_BYTES], [0; ANSWER_LEN]);
    // These go without an answer: the third in a row proves a robot.
    for _ in 1..IN_A_ROW {
        robot.measurement(&mut measurement);
        socket.send(&measurement).expect("sent");
    }
    while !robot.is_finished() {
        robot.measurement(&mut measurement);
        if socket.send(&measurement).is_err() || socket.recv(&mut answer).is_err() {
            return;
        }
        robot.command(&answer, 0.0);
        robot.advance();
    }
}

#[test]
fn a_target_of_another_kind_is_a_fault_that_the_summary_names() {
    let scenario = scenario();
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let here = socket.local_addr().expect("an address");
    let served = scenario.clone();
    let server = thread::spawn(move || serve(&served, here));
    let (stop, tasks) = (AtomicBool::new(false), tasks(&scenario));
    let mut end = Endpoint {
        socket,
        peer: None,
        wait: Duration::from_secs(20),
        silence: Duration::from_secs(2),
        stop: &stop,
        tasks,
    };
    let mut session = session(&scenario);
    let mut source = Confused { origin: None };
    let mut cycles = Vec::new();
    let counts = converse(&mut end, &mut session, &mut source, None, |_, cycle| {
        cycles.push(*cycle);
    });
    let names: Vec<_> = scenario.levels.iter().map(|level| level.label()).collect();
    let counts = counts.expect("a socket that works");
    let summary = counts.summary(
        &session,
        ending(&session),
        &scenario.name,
        &names,
        &Realtime::default(),
    );
    // The port closes, and with it the robot's end.
    drop(end);
    server.join().expect("the robot");

    let name = FaultKind::WrongTarget.name();
    let text = "kind of target of level 1 is an orientation; allowed hold or a position";
    assert_eq!(summary.reason, format!("{name}: {text}"));
    assert_eq!(summary.exit_code, 3);
    let json = serde_json::to_string(&summary).expect("a summary");
    assert!(json.contains(&format!("\"reason\":\"{name}: ")), "{json}");
    // It was not followed: both levels rested where they were.
    for level in &summary.levels {
        assert!(level.max.is_some_and(|max| max < 1.0), "{level:?}");
    }
    let mut record = Vec::new();
    recorder::write_rows(&mut record, cycles.into_iter()).expect("memory");
    let record = String::from_utf8(record).expect("text");
    let rows: Vec<_> = record.lines().skip(1).collect();
    let fault = format!(",{},0,0", FaultKind::WrongTarget.number());
    let faults = rows.iter().filter(|row| row.ends_with(&fault)).count();
    let clear = rows.iter().filter(|row| row.ends_with(",0,0,0")).count();
    assert!(faults > 0 && clear > 250, "{faults} {clear}");
    assert_eq!(faults + clear, rows.len());
}

/// A change beside references: the loop begins it, what is none is counted.
#[test]
fn a_datagram_with_words_changes_gains() {
    let scenario = scenario();
    let config = scenario.session_config(0, 1.0).expect("a valid scenario");
    let controller = Controller::new(&config.arm, &config.controller).expect("valid");
    let (lines, changes) = changes::channel(&scenario, &controller);
    let address = {
        let free = UdpSocket::bind("127.0.0.1:0").expect("a port");
        free.local_addr().expect("an address")
    };
    let tasks = tasks(&scenario);
    let stream = Stream::listen(address, None, &tasks, &scenario.arm(), NEVER, Some(lines))
        .expect("a free port");
    let planner = UdpSocket::bind("127.0.0.1:0").expect("a port");
    planner.connect(address).expect("loopback");
    for line in ["gains 1 100 20 in 0.2", "gains 1 -1 20", "grow 1"] {
        planner.send(line.as_bytes()).expect("sent");
    }
    let deadline = Instant::now() + Duration::from_secs(20);
    let mut begun = 0;
    while (begun, stream.figures().unusable) != (1, 2) && Instant::now() < deadline {
        changes.begin(&mut |_| {
            begun += 1;
            Ok(())
        });
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!((begun, stream.figures().unusable), (1, 2));
}
