//! Whose the output folder is, and what stands in it however a run ends.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

fn start(folder: &Path, arguments: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut names: Vec<_> = entries
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .into_string()
                .expect("text")
        })
        .collect();
    names.sort();
    names
}

/// Waits until a run has begun to write to `folder`.
fn begun(folder: &Path) {
    let start = Instant::now();
    let is_draft = |name: &String| name.ends_with(".partial");
    while !names(folder).iter().any(is_draft) {
        assert!(start.elapsed() < Duration::from_secs(20), "no draft came");
        sleep(Duration::from_millis(5));
    }
}

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args(["-s", name, &id]).status();
    assert!(sent.expect("kill runs").success());
}

fn end(child: Child) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = child.wait_with_output().expect("the program ends");
    (status.code(), String::from_utf8(stderr).expect("text"))
}

fn summary(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("summary.json")).expect("a summary");
    serde_json::from_str(&text).expect("JSON")
}

/// The commands that write, all to the folder `o`.
const LONG: [&str; 3] = [
    "run two-level --duration 3600 --seed 1 --out o",
    "run two-level --duration 3600 --measurement fri --out o",
    "paper --out o",
];

#[test]
fn a_folder_in_use_is_refused_at_the_start() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("o");
    let first = start(folder.path(), LONG[0]);
    begun(&out);
    let before = names(&out);
    for second in [
        "run two-level --seed 2 --out o",
        "run two-level --seed 2 --out ./o/../o",
        "serve --out o --wait 5",
        "paper --out o",
    ] {
        let (code, stderr) = end(start(folder.path(), second));
        assert_eq!(code, Some(2), "{second}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{second}: {stderr}");
        assert!(stderr.contains("output folder: ") && stderr.contains("no other run"));
        assert_eq!(names(&out), before, "{second}");
    }
    signal(&first, "INT");
    assert_eq!(end(first).0, Some(3));
    assert_eq!(summary(&out)["seed"], 1);
}

#[test]
fn the_comparison_has_its_three_folders_from_the_start() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let other = "out/two-level/acceleration-level";
    let first = start(
        folder.path(),
        &format!("{} --out {other}", "run two-level --duration 3600"),
    );
    begun(&folder.path().join(other));
    let (code, stderr) = end(start(folder.path(), ""));
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains(other), "{stderr}");
    signal(&first, "TERM");
    assert_eq!(end(first).0, Some(3));
}

#[test]
fn a_signal_stops_a_run_and_what_there_is_is_written() {
    for (command, name) in [(LONG[0], "INT"), (LONG[0], "HUP"), (LONG[1], "TERM")] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = folder.path().join("o");
        let run = start(folder.path(), command);
        begun(&out);
        sleep(Duration::from_millis(300));
        signal(&run, name);
        let (code, stderr) = end(run);
        assert_eq!(code, Some(3), "{name}: {stderr}");
        assert!(
            stderr.contains("note: trace.csv will have about 2.2 GB"),
            "{stderr}"
        );
        let all = ["figures", "report.html", "summary.json", "trace.csv"];
        assert_eq!(names(&out), all, "{name}");
        let summary = summary(&out);
        assert_eq!(summary["verdict"], "stopped");
        assert_eq!(summary["reason"], "interrupted");
        let trace = fs::read_to_string(out.join("trace.csv")).expect("a trace");
        let columns = |row: &str| row.split(',').count();
        let header = trace.lines().next().map(columns);
        assert!(trace.ends_with('\n') && trace.lines().all(|row| Some(columns(row)) == header));
        let rows = trace.lines().count() as u64 - 1;
        assert_eq!(Some(rows), summary["cycles"].as_u64(), "{name}");
    }
}

#[test]
fn an_interrupted_paper_writes_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("o");
    let paper = start(folder.path(), LONG[2]);
    while !out.exists() {
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(200));
    signal(&paper, "TERM");
    let (code, stderr) = end(paper);
    assert_eq!(code, Some(3), "{stderr}");
    assert!(stderr.contains("interrupted"), "{stderr}");
    assert!(names(&out).is_empty());
}
