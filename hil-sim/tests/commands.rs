//! The commands as a user runs them: exit codes, files, and what they hold.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use cell::scenario::BUILT_IN;
use serde_json::Value;

fn hil_sim(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .output()
        .expect("the program runs")
}

fn json(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    serde_json::from_str(&text).expect("JSON")
}

/// eq (33): with the printed sign the null space runs away and safety stops the arm.
#[test]
fn the_printed_sign_is_stopped_by_safety() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = hil_sim(
        folder.path(),
        "run two-level --controller as-printed --plant ideal --out o",
    );
    assert_eq!(output.status.code(), Some(3));
    let summary = json(&folder.path().join("o/summary.json"));
    assert_eq!(summary["verdict"], "stopped");
    assert!(
        summary["reason"]
            .as_str()
            .expect("a reason")
            .starts_with("speed of joint")
    );
    assert!(summary["cycles"].as_u64().expect("cycles") < 1000);
}

#[test]
fn a_failed_limit_is_exit_code_one_and_says_which() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = hil_sim(
        folder.path(),
        "run two-level --controller no-observer --out o",
    );
    assert_eq!(output.status.code(), Some(1));
    let summary = json(&folder.path().join("o/summary.json"));
    assert_eq!(summary["verdict"], "fail");
    assert!(
        summary["reason"]
            .as_str()
            .expect("a reason")
            .contains("level1_rms_mm")
    );
}

/// A metric without samples is null and is not judged.
#[test]
fn a_run_too_short_for_its_contacts_is_not_judged_by_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = hil_sim(
        folder.path(),
        "run two-level --plant ideal --duration 2 --out o",
    );
    assert_eq!(output.status.code(), Some(0));
    let summary = json(&folder.path().join("o/summary.json"));
    assert_eq!(summary["verdict"], "not judged");
    assert_eq!(summary["acceptance"][0]["metric"], "level1_plateau_mm");
    assert_eq!(summary["acceptance"][0]["value"], Value::Null);
    assert_eq!(summary["acceptance"][0]["pass"], Value::Null);
    assert_eq!(
        summary["levels"][0]["plateau_mm"].as_array().map(Vec::len),
        Some(4)
    );
}

/// A run that no limit is set for passes, and does not say that it was judged.
#[test]
fn a_run_without_limits_says_so() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = hil_sim(
        folder.path(),
        "run two-level --dead-cycles 3 --contacts off --duration 0.1 --out o",
    );
    assert_eq!(output.status.code(), Some(0));
    let summary = json(&folder.path().join("o/summary.json"));
    assert_eq!(summary["verdict"], "pass");
    assert_eq!(summary["acceptance"].as_array().map(Vec::len), Some(0));
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.contains("no limit"), "{text}");
    let report = fs::read_to_string(folder.path().join("o/report.html")).expect("a report");
    assert!(report.contains("NO LIMIT") && !report.contains("PASS"));
}

/// Nobody has to read what it says.
#[test]
fn a_closed_standard_error_does_not_end_a_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(["serve", "--wait", "0.2", "--remote", "127.0.0.1:9"])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    drop(child.stderr.take());
    assert_eq!(child.wait().expect("the end").code(), Some(4));
}

#[test]
fn printed_scenarios_run_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, _) in BUILT_IN {
        let printed = hil_sim(folder.path(), &format!("scenario {name}"));
        assert_eq!(printed.status.code(), Some(0));
        fs::write(folder.path().join("printed.toml"), printed.stdout).expect("a file");
        let short = "--duration 4";
        hil_sim(folder.path(), &format!("run {name} {short} --out built-in"));
        hil_sim(
            folder.path(),
            &format!("run printed.toml {short} --out from-file"),
        );
        for file in ["trace.csv", "summary.json", "figures/task-error.svg"] {
            let [one, other] = ["built-in", "from-file"]
                .map(|run| fs::read(folder.path().join(run).join(file)).expect("a file"));
            assert!(one == other, "{name}: {file}");
        }
    }
}

/// Without files the same is said, but where they are, and nothing is left.
#[test]
fn a_run_without_files_says_the_same_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for run in [
        "run two-level --duration 1",
        "run two-level --duration 1 --plant ideal --measurement link",
        // Ended by safety, and by a limit.
        "run two-level --controller as-printed --plant ideal",
        "run two-level --controller no-observer --duration 7",
    ] {
        let none = hil_sim(folder.path(), &format!("{run} --out none"));
        let left = fs::read_dir(folder.path()).expect("readable").count();
        assert_eq!(left, 0, "{run}");
        let written = tempfile::tempdir().expect("a temporary folder");
        let with = hil_sim(written.path(), &format!("{run} --out o"));
        assert_eq!(none.status.code(), with.status.code(), "{run}");
        assert_eq!(none.stderr, with.stderr, "{run}");
        let text = String::from_utf8(with.stdout).expect("text");
        let files = "report.html, summary.json, trace.csv and figures are in o";
        let expected = text.replace(files, "No file was written.");
        assert_eq!(String::from_utf8(none.stdout).expect("text"), expected);
    }
}

/// Without arguments: the three-row table, and the product passes.
#[test]
fn no_arguments_compare_three_controllers() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .current_dir(folder.path())
        .output()
        .expect("the program runs");
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).expect("text");
    for controller in ["hierarchical", "no-observer", "acceleration-level"] {
        assert!(text.contains(&format!("\n{controller} ")), "{text}");
    }
    assert!(text.contains("out/two-level"));
    for file in [
        "summary.json",
        "trace.csv",
        "report.html",
        "no-observer/summary.json",
    ] {
        assert!(
            folder.path().join("out/two-level").join(file).exists(),
            "{file}"
        );
    }
}

/// The whole paper: no limit exceeded, the claims that the paper's printed
/// formulas make are refuted, and every rms figure is that of a summary.
#[test]
fn the_paper_report_is_complete_and_its_numbers_are_those_of_the_runs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = hil_sim(folder.path(), "paper --out p");
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stdout)
    );
    let out = folder.path().join("p");
    let html = fs::read_to_string(out.join("report.html")).expect("the report");
    for number in ["04", "06", "07", "09", "10"] {
        let figure = fs::read_to_string(out.join(format!("figures/fig{number}.svg")));
        assert!(figure.expect("a figure").contains("<svg"));
    }
    let verdicts = json(&out.join("verdicts.json"));
    let claims = verdicts.as_array().expect("claims");
    assert!(claims.len() >= 40);
    for claim in claims {
        assert_ne!(claim["verdict"], "out of limit", "{claim}");
        assert!(claim["measured"].is_number(), "{claim}");
    }
    let find = |id: &str| {
        claims
            .iter()
            .find(|claim| claim["id"] == id)
            .unwrap_or_else(|| panic!("no claim {id}"))
    };
    for id in [
        "errata-33-sign",
        "errata-34-coupling-5s-printed",
        "errata-51-drift",
    ] {
        assert_eq!(find(id)["verdict"], "not confirmed", "{id}");
    }
    for (id, level) in [
        ("6.1-circle", 0),
        ("6.2-case-1-level1", 0),
        ("6.2-case-1-level2", 1),
        ("6.2-case-2-level2", 1),
    ] {
        let claim = find(id);
        let run = claim["run"].as_str().expect("a run");
        let summary = json(&out.join("runs").join(run).join("summary.json"));
        assert_eq!(
            claim["measured"], summary["levels"][level]["rms_mm"],
            "{id}"
        );
        assert!(html.contains(run), "{id}");
    }
}
