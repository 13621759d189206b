//! Robot and bridge over UDP, in lock-step and in real time.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use bridge::lwr::Lwr;
use bridge::session::Session;
use cell::names::PlantKind;
use cell::realtime::Realtime;
use cell::scenario::{Scenario, ScenarioSource};
use firmware_host::run::{Endpoint, converse};
use firmware_host::summary::{Summary, ending};
use hil_sim::loopback::{self, BridgeClient};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{LinkFigures, LwrRobot, RobotOptions, RobotSetup};
use hil_sim::serve::{Client, End, Operator, Service, Udp};
use hil_sim::trace::Trace;

fn scenario(duration_s: f64) -> Scenario {
    let mut scenario = Scenario::find("two-level").expect("built in");
    scenario.duration_s = duration_s;
    scenario
}

fn robot(scenario: &Scenario, seed: u64) -> LwrRobot {
    LwrRobot::new(RobotSetup {
        scenario: scenario.clone(),
        plant: PlantKind::Realistic,
        contacts: true,
        seed,
        plant_options: PlantOptions::default(),
        options: RobotOptions::default(),
    })
}

/// The trace of a run in one process.
fn in_process(scenario: &Scenario, seed: u64) -> Vec<u8> {
    let mut trace = Trace::new(Vec::new(), scenario).expect("memory");
    let config = scenario.session_config(0, scenario.duration_s);
    let mut robot = robot(scenario, seed);
    let config = config.expect("a good scenario");
    let mut client = BridgeClient::new(Lwr::new(), config, scenario);
    loopback::run(&mut robot, &mut client, &[], |instant, _| {
        trace.push(instant)
    })
    .expect("memory");
    trace.finish()
}

/// The same over UDP: trace, robot's figures, and the bridge's summary.
fn over_udp(scenario: &Scenario, seed: u64, lockstep: bool) -> (Vec<u8>, LinkFigures, Summary) {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let here: SocketAddr = socket.local_addr().expect("an address");
    let served = scenario.clone();
    let server = thread::spawn(move || {
        let service = Service {
            client: Client::Udp {
                remote: here,
                local_port: 0,
            },
            lockstep,
            faults: Vec::new(),
            wait_s: 20.0,
        };
        let mut robot = robot(&served, seed);
        let mut client = Udp::open(here, 0).expect("loopback");
        let mut trace = Trace::new(Vec::new(), &served).expect("memory");
        let end = service.run(
            &mut robot,
            &mut Operator::absent(),
            &mut client,
            |instant| trace.push(instant),
        );
        assert_eq!(end.expect("a socket that works"), End::Finished);
        let link = robot.summary().link.expect("the robot's side");
        (trace.finish(), link)
    });
    let stop = AtomicBool::new(false);
    let config = scenario.session_config(0, scenario.duration_s);
    let config = config.expect("a good scenario");
    let mut end = Endpoint {
        socket,
        peer: None,
        wait: Duration::from_secs(20),
        silence: Duration::from_secs(2),
        stop: &stop,
        tasks: config.controller.tasks,
    };
    let mut session = Session::new(Lwr::new(), config);
    let mut source = ScenarioSource::new(scenario);
    let counts = converse(&mut end, &mut session, &mut source, None, |_, _| {});
    let names = ["flange".to_string()];
    let summary = counts.expect("a socket that works").summary(
        &session,
        ending(&session),
        &scenario.name,
        &names,
        &Realtime::default(),
    );
    let (trace, link) = server.join().expect("the robot");
    (trace, link, summary)
}

#[test]
fn in_lock_step_udp_changes_no_bit() {
    let scenario = scenario(4.0);
    for seed in [1, 2] {
        let (trace, link, summary) = over_udp(&scenario, seed, true);
        assert!(trace == in_process(&scenario, seed), "seed {seed}");
        assert_eq!((link.missed, link.fallbacks), (0, 0));
        assert_eq!((summary.exit_code, summary.link.lost), (0, 0));
    }
}

/// The table of the arm as a file beside the scenario: the same bits over the link.
#[test]
fn an_arm_file_is_the_same_arm() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = cell::arm::text::text(&arms::LWR_IV, "");
    std::fs::write(folder.path().join("lwr.toml"), arm).expect("a file");
    let text = Scenario::built_in_text("two-level").expect("built in");
    let path = folder.path().join("scenario.toml");
    std::fs::write(&path, text.replacen("\"lwr_iv\"", "\"lwr.toml\"", 1)).expect("a file");
    let mut of_file = Scenario::find(path.to_str().expect("text")).expect("a scenario");
    of_file.duration_s = 2.0;
    assert!(over_udp(&of_file, 1, true).0 == in_process(&scenario(2.0), 1));
}

/// Real time on a PC that does other things as well: only that it works.
#[test]
fn in_real_time_it_gets_into_command_state_and_tracks() {
    let (_, link, summary) = over_udp(&scenario(2.0), 1, false);
    assert_eq!(summary.exit_code, 0, "{}", summary.reason);
    assert!(
        link.state_cycles.command > 0 && link.answers > 1000,
        "{link:?}"
    );
    let max = summary.levels[0].max;
    assert!(max.is_some_and(|max| max < 50.0), "{:?}", summary.levels);
}
