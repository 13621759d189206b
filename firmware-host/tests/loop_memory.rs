//! The socket loop takes no memory once it runs.

use std::alloc::System;
use std::net::UdpSocket;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Phase, Session};
use cell::names::PlantKind;
use cell::scenario::{Scenario, ScenarioSource};
use firmware_host::recorder::Recorder;
use firmware_host::run::{Endpoint, converse};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{LwrRobot, MEASUREMENT_BYTES, RobotOptions, RobotSetup};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static MEMORY: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn scenario() -> Scenario {
    let mut scenario = Scenario::find("case-1").expect("built in");
    scenario.duration_s = 2.0;
    scenario
}

fn session(scenario: &Scenario) -> Session<Lwr> {
    let config = scenario.session_config(0, scenario.duration_s);
    Session::new(Lwr::new(), config.expect("a good scenario"))
}

/// Every measurement of a run.
fn measurements(scenario: &Scenario) -> Vec<[u8; MEASUREMENT_BYTES]> {
    let mut robot = LwrRobot::new(RobotSetup {
        scenario: scenario.clone(),
        plant: PlantKind::Realistic,
        contacts: true,
        seed: 1,
        plant_options: PlantOptions::default(),
        options: RobotOptions::default(),
    });
    let (mut session, mut source) = (session(scenario), ScenarioSource::new(scenario));
    let mut all = Vec::new();
    let (mut measurement, mut answer) = ([0; MEASUREMENT_BYTES], [0; ANSWER_LEN]);
    while !robot.is_finished() {
        robot.measurement(&mut measurement);
        all.push(measurement);
        let outcome = session.receive(&measurement, &mut source, &mut answer);
        assert_eq!(outcome, Outcome::Answered);
        robot.command(&answer, 0.0);
        robot.advance();
    }
    all
}

#[test]
fn the_loop_takes_no_memory_after_the_start() {
    let scenario = scenario();
    let measurements = measurements(&scenario);
    let cycles = measurements.len();
    assert!(cycles > 1600, "{cycles}");

    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let here = socket.local_addr().expect("an address");
    let robot = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let peer = Some(robot.local_addr().expect("an address"));
    let sender = std::thread::spawn(move || {
        robot.connect(here).expect("loopback");
        let timeout = Some(Duration::from_secs(5));
        robot.set_read_timeout(timeout).expect("a timeout");
        let mut answer = [0; ANSWER_LEN];
        for measurement in &measurements {
            robot.send(measurement).expect("sent");
            robot.recv(&mut answer).expect("an answer");
        }
    });

    let stop = AtomicBool::new(false);
    let tasks = scenario
        .controller_config(0)
        .expect("a good scenario")
        .tasks;
    let mut end = Endpoint {
        socket,
        // Named, so that the first measurement is answered.
        peer,
        wait: Duration::from_secs(5),
        silence: Duration::from_millis(300),
        stop: &stop,
        tasks,
    };
    let (mut session, mut source) = (session(&scenario), ScenarioSource::new(&scenario));
    let mut region = Region::new(MEMORY);
    let (mut seen, mut moving, mut taken) = (0, 0, 0);
    converse(&mut end, &mut session, &mut source, None, |_, cycle| {
        seen += 1;
        moving += usize::from(cycle.phase == Phase::Moving);
        if seen == 10 {
            region.reset();
        }
        if seen == cycles - 1 {
            let change = region.change();
            taken = change.allocations + change.reallocations;
        }
    })
    .expect("a socket that works");
    sender.join().expect("every measurement answered");
    assert!(seen >= cycles - 1 && moving > 900, "{seen} {moving}");
    assert_eq!(taken, 0, "allocations in {cycles} cycles");

    // Whatever is too much for the recorder is counted. It starts here: its thread
    // takes memory of its own, and when is up to the system.
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("record.csv");
    let mut recorder = Recorder::create(&record).expect("a thread");
    let last = *session.last().expect("a cycle");
    for _ in 0..10_000 {
        recorder.push(&last);
    }
    let dropped = recorder.finish().expect("written");
    let lines = std::fs::read_to_string(&record)
        .expect("the record")
        .lines()
        .count();
    assert_eq!(
        lines as u64 + dropped,
        1 + 10_000,
        "every cycle written or counted"
    );
}
