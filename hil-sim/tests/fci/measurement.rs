//! `hil-sim run --measurement`: whose link it is.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("measurement")
        .join(name)
}

fn run(arguments: &str, name: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(format!("run {arguments} --out").split(' '))
        .arg(folder(name))
        .output()
        .expect("started")
}

/// Trace and summary of half a second.
fn files(scenario: &str, measurement: &str) -> (Vec<u8>, Value) {
    let name = format!("{scenario}-{measurement}");
    let arguments = format!("{scenario} --measurement {measurement} --duration 0.5");
    let output = run(&arguments, &name);
    let text = String::from_utf8_lossy(&output.stderr).to_string();
    assert_eq!(output.status.code(), Some(0), "{name}: {text}");
    let read = |file: &str| fs::read(folder(&name).join(file)).expect("written");
    let summary = serde_json::from_slice(&read("summary.json")).expect("JSON");
    (read("trace.csv"), summary)
}

/// The LWR and arms without an interface of their own: the old name and the new one are the same.
#[test]
fn other_arms_are_led_by_fri() {
    for scenario in ["two-level", "two-level-openarm"] {
        let [fri, link] = ["fri", "link"].map(|measurement| files(scenario, measurement));
        assert!(fri == link, "{scenario}");
        assert!(fri.1["link"]["answers"].is_u64() && fri.1.get("fci").is_none());
    }
}

/// `fri` is the controller of an LWR with the arm of the FR3, `link` that arm's own.
#[test]
fn an_fr3_has_its_own_link() {
    let (over_fri, summary) = files("two-level-fr3", "fri");
    assert!(summary["link"]["quality_cycles"].is_object() && summary.get("fci").is_none());
    let (over_fci, summary) = files("two-level-fr3", "link");
    assert!(over_fri != over_fci);
    assert!(summary.get("link").is_none());
    let fci = &summary["fci"];
    assert_eq!((&fci["version"], &fci["motions"]), (&10.into(), &1.into()));
    assert_eq!((&fci["lost"], &fci["reflexes"]), (&0.into(), &0.into()));
    // The report has the link of the same name.
    let report = fs::read_to_string(folder("two-level-fr3-link").join("report.html"));
    assert!(report.expect("a report").contains("Aborted by a reflex"));
}

#[test]
fn the_cycle_is_that_of_the_interface() {
    let output = run("two-level-fr3 --measurement link --cycle-ms 2", "cycle");
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stderr).to_string();
    let expected =
        "error: cycle: 2 ms; allowed: 1 ms, the only one that the FCI has: --cycle-ms 1\n";
    assert_eq!(text, expected);
}
