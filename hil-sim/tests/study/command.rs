//! `hil-sim study limits` as a user runs it.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn hil_sim(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .output()
        .expect("the program runs")
}

#[test]
fn tables_and_figures_of_every_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = hil_sim(
        folder.path(),
        "study limits --set wrist --runs 3 --jobs 2 --output o.json",
    );
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(text.starts_with("limits: lwr_iv, ideal plant, controller in f64\n\nwrist: 3 runs\n"));
    assert!(text.ends_with("\n3 of 3 limits met\n"), "{text}");
    let json = std::fs::read_to_string(folder.path().join("o.json")).expect("a file");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    let set = &json["sets"][0];
    assert_eq!(set["set"], "wrist");
    for law in ["exact", "within_limits"] {
        assert_eq!(set[law].as_array().expect("runs").len(), 3);
    }
    assert_eq!(set["within_limits"][2]["run"], "wrist-002");
    assert_eq!(set["acceptance"][0]["met"], true);
}

#[test]
fn what_cannot_be_used_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (arguments, line) in [
        (
            "--set wrists",
            "error: set: unknown 'wrists', did you mean 'wrist'?",
        ),
        (
            "--law old",
            "error: law: unknown 'old'; allowed: exact, within-limits, both",
        ),
        ("--precision f16", "error: precision: unknown 'f16'"),
        ("--plant real", "error: plant: unknown 'real'"),
        ("--arm lwr", "error: robot: unknown 'lwr'"),
        (
            "--runs 0",
            "error: --runs: '0'; allowed: whole numbers 1 to 10000",
        ),
        (
            "--from nowhere",
            "error: --from: nowhere; allowed: a folder with pass-000.csv.gz",
        ),
        ("--arm fr3 --set wrist", "error: set: unknown 'wrist'"),
    ] {
        let output = hil_sim(folder.path(), &format!("study limits {arguments}"));
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        let text = String::from_utf8(output.stderr).expect("UTF-8");
        assert!(
            text.starts_with(line) && text.lines().count() == 1,
            "{text}"
        );
    }
}
