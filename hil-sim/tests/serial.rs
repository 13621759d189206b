//! The robot on a serial line: a pseudo terminal with the bridge at its other end.

use std::thread;
use std::time::{Duration, Instant};

use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Phase, Session};
use cell::names::PlantKind;
use cell::scenario::{Scenario, ScenarioSource};
use hil_sim::loopback::{self, BridgeClient};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{LwrRobot, RobotOptions, RobotSetup};
use hil_sim::serve::{Client, End, Operator, Serial, Service, Transport};
use hil_sim::trace::Trace;
use serial2::SerialPort;

fn scenario() -> Scenario {
    let mut scenario = Scenario::find("two-level").expect("built in");
    scenario.duration_s = 1.0;
    scenario
}

fn robot(scenario: &Scenario) -> LwrRobot {
    LwrRobot::new(RobotSetup {
        scenario: scenario.clone(),
        plant: PlantKind::Realistic,
        contacts: true,
        seed: 1,
        plant_options: PlantOptions::default(),
        options: RobotOptions::default(),
    })
}

/// The bridge on its end of the line. Returns the last phase and how many frames
/// were damaged.
fn converse(port: SerialPort, scenario: &Scenario) -> (Phase, u64) {
    let config = scenario.session_config(0, scenario.duration_s);
    let mut session = Session::new(Lwr::new(), config.expect("a good scenario"));
    let mut source = ScenarioSource::new(scenario);
    let mut line = Serial::on(port);
    let mut answer = [0; ANSWER_LEN];
    while session.phase() != Phase::Finished {
        let deadline = Instant::now() + Duration::from_secs(5);
        let Some(measurement) = line.receive(deadline).expect("a line that works") else {
            break;
        };
        let measurement = measurement.to_vec();
        if session.receive(&measurement, &mut source, &mut answer) == Outcome::Answered {
            line.send(&answer).expect("a line that works");
        }
    }
    (session.phase(), line.damaged())
}

#[test]
fn over_a_serial_line_every_bit_is_that_of_the_loop_in_one_process() {
    let scenario = scenario();
    let (here, there) = SerialPort::pair().expect("a pseudo terminal");
    let other = scenario.clone();
    let client = thread::spawn(move || converse(there, &other));
    let service = Service {
        client: Client::Serial("pseudo terminal".into()),
        lockstep: true,
        faults: Vec::new(),
        wait_s: 20.0,
    };
    let mut trace = Trace::new(Vec::new(), &scenario).expect("memory");
    let mut line = Serial::on(here);
    let mut served = robot(&scenario);
    let end = service.run(&mut served, &mut Operator::absent(), &mut line, |instant| {
        trace.push(instant)
    });
    assert_eq!(end.expect("a line that works"), End::Finished);
    let (phase, damaged) = client.join().expect("the bridge");
    assert_eq!((phase, damaged), (Phase::Finished, 0));
    assert_eq!(line.damaged(), 0);

    let mut expected = Trace::new(Vec::new(), &scenario).expect("memory");
    let config = scenario.session_config(0, scenario.duration_s);
    let mut client = BridgeClient::new(Lwr::new(), config.expect("a good scenario"), &scenario);
    loopback::run(&mut robot(&scenario), &mut client, &[], |instant, _| {
        expected.push(instant)
    })
    .expect("memory");
    assert!(trace.finish() == expected.finish());
}
