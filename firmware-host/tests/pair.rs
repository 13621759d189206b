//! The program against the simulated robot with Franka's interface on sockets of this PC, in
//! lock-step, and the same in one process.

use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use std::process::{Command, Output};
use std::thread::{self, JoinHandle};

use bridge::fci::RobotState;
use bridge::session::CycleReport;
use cell::names::{PlantKind, RobotInterface};
use cell::scenario::Scenario;
use fci::{RobotError, Version};
use firmware_host::recorder::write_rows;
use hil_sim::loopback::{self, FciClient};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{FciOptions, FciRobot, RobotSetup};
use hil_sim::serve::{End, FciService, Operator};
use hil_sim::trace::Trace;

const DURATION_S: f64 = 2.0;

fn scenario() -> Scenario {
    let mut scenario = Scenario::find("two-level-fr3").expect("built in");
    scenario.duration_s = DURATION_S;
    scenario
}

fn robot(plant: PlantKind, seed: u64, version: Version) -> FciRobot {
    let scenario = scenario();
    let options = FciOptions::of(&scenario, version);
    FciRobot::new(RobotSetup {
        scenario,
        plant,
        contacts: true,
        seed,
        plant_options: PlantOptions::default(),
        options,
    })
}

/// What a run leaves.
#[derive(PartialEq)]
struct Left {
    trace: Vec<u8>,
    /// summary.json of the robot.
    summary: String,
    /// Cycles of the session in scenario time, without the robot's counter, which starts with it.
    record: Vec<String>,
}

/// Rows of a record in scenario time.
fn rows(record: &str) -> Vec<String> {
    let (header, rows) = record.split_once('\n').expect("a header");
    let column = |name| header.split(',').position(|column| column == name);
    let (t, phase) = (column("t").expect("t"), column("phase").expect("phase"));
    assert_eq!(column("counter"), Some(0));
    rows.lines()
        .filter(|row| {
            let values: Vec<_> = row.split(',').collect();
            let t_s: f64 = values[t].parse().expect("a time");
            values[phase] == "moving" && (0.0..DURATION_S).contains(&t_s)
        })
        .filter_map(|row| row.split_once(','))
        .map(|(_, rest)| rest.to_string())
        .collect()
}

fn in_process(plant: PlantKind, seed: u64, version: Version) -> Left {
    let scenario = scenario();
    let config = scenario.session_config_for(RobotInterface::Fci, 0, scenario.duration_s);
    let mut client = FciClient::new(config.expect("a good scenario"), &scenario, false);
    let mut robot = robot(plant, seed, version);
    let mut trace = Trace::new(Vec::new(), &scenario).expect("memory");
    let mut cycles: Vec<CycleReport<RobotState>> = Vec::new();
    loopback::run(&mut robot, &mut client, &[], |instant, session| {
        cycles.extend(session.last());
        trace.push(instant)
    })
    .expect("memory");
    let mut record = Vec::new();
    write_rows(&mut record, cycles.into_iter()).expect("memory");
    Left {
        trace: trace.finish(),
        summary: serde_json::to_string_pretty(&robot.summary()).expect("JSON"),
        record: rows(&String::from_utf8(record).expect("text")),
    }
}

/// A robot that listens: its trace and summary, once it has ended.
fn served(address: IpAddr, mut robot: FciRobot, faults: &[&str]) -> JoinHandle<(Vec<u8>, String)> {
    let service = FciService {
        address: SocketAddr::new(address, 1337),
        lockstep: true,
        faults: (faults.iter())
            .map(|spec| spec.parse().expect("a good fault"))
            .collect(),
        wait_s: 60.0,
    };
    let sockets = service.open().expect("an own address");
    thread::spawn(move || {
        let mut trace = Trace::new(Vec::new(), &robot.setup().scenario).expect("memory");
        let end = service.run(&mut robot, &mut Operator::absent(), sockets, |instant| {
            trace.push(instant)
        });
        assert_eq!(end.expect("sockets that work"), End::Finished);
        let summary = serde_json::to_string_pretty(&robot.summary()).expect("JSON");
        (trace.finish(), summary)
    })
}

/// The program with files in a folder: what it said.
fn lead(folder: &Path, address: IpAddr, more: &[&str]) -> (Output, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_firmware-host"))
        .current_dir(folder)
        .args(["run", "two-level-fr3", "--robot", "fci", "--address"])
        .arg(address.to_string())
        .args(["--duration", &DURATION_S.to_string()])
        .args(["--summary", "summary.json", "--record", "record.csv"])
        .args(more)
        .output()
        .expect("the program starts");
    let text = [&output.stdout[..], &output.stderr[..]].concat();
    (output, String::from_utf8(text).expect("text"))
}

fn address(last: u8) -> IpAddr {
    [127, 0, 14, last].into()
}

#[test]
fn in_lock_step_sockets_change_no_bit() {
    for (last, plant, seed, version) in [
        (1, PlantKind::Ideal, 1, Version::V10),
        (2, PlantKind::Realistic, 1, Version::V10),
        (3, PlantKind::Realistic, 2, Version::V10),
        (4, PlantKind::Realistic, 2, Version::V5),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let robot = served(address(last), robot(plant, seed, version), &[]);
        let (output, text) = lead(folder.path(), address(last), &[]);
        assert_eq!(output.status.code(), Some(0), "{text}");
        let (trace, summary) = robot.join().expect("the robot");
        let record = std::fs::read_to_string(folder.path().join("record.csv"));
        let over_sockets = Left {
            trace,
            summary,
            record: rows(&record.expect("a record")),
        };
        let here = in_process(plant, seed, version);
        let what = format!("{plant:?}, seed {seed}, {version:?}");
        assert_eq!(over_sockets.summary, here.summary, "{what}");
        assert!(over_sockets.trace == here.trace, "{what}");
        assert_eq!(here.record.len(), 2000);
        let differs = (over_sockets.record.iter().zip(&here.record)).find(|(one, two)| one != two);
        assert_eq!(differs, None, "{what}");
        assert!(over_sockets == here, "{what}");
    }
}

/// 20 commands in a row are lost: the text, the code, one recovery where that is asked for.
#[test]
fn a_link_that_breaks_is_a_reflex_and_exit_code_three() {
    for (last, more, recovery) in [
        (11, &[][..], serde_json::Value::Null),
        (12, &["--recover"], "success".into()),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let robot = robot(PlantKind::Realistic, 1, Version::V10);
        let robot = served(address(last), robot, &["to-robot:drop=1@1-1.02"]);
        let (output, text) = lead(folder.path(), address(last), more);
        assert_eq!(output.status.code(), Some(3), "{text}");
        let error = RobotError::CommunicationConstraintsViolation.name();
        let said = format!("reflex: {error}; 20 commands in a row were not there in time");
        assert!(text.contains(&said), "{text}");
        let summary = std::fs::read_to_string(folder.path().join("summary.json"));
        let summary: serde_json::Value =
            serde_json::from_str(&summary.expect("a summary")).expect("JSON");
        assert_eq!(summary["fci"]["event"], "20 commands lost");
        assert_eq!(summary["fci"]["recovery"], recovery);
        let (_, seen) = robot.join().expect("the robot");
        let seen: serde_json::Value = serde_json::from_str(&seen).expect("JSON");
        let fci = &seen["fci"];
        assert_eq!((&fci["motions"], &fci["reflexes"]), (&1.into(), &1.into()));
        assert_eq!(fci["lost"], 20);
        assert_eq!(fci["errors"], serde_json::json!([error]));
        // Nothing of another robot's link.
        assert!(seen.get("link").is_none());
    }
}
