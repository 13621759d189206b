//! The command line: one line for everything that cannot be used, and the exit
//! codes.

use std::path::Path;
use std::process::{Command, Output};

fn firmware_host(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_firmware-host"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Arguments, and what the line must say.
const BAD: &[(&[&str], &[&str])] = &[
    (&[], &["command", "run, doctor"]),
    (&["rnu"], &["command", "unknown 'rnu'", "run, doctor"]),
    (&["run", "--foo"], &["unknown argument '--foo'"]),
    (
        &["run", "--scenario", "two-levl"],
        &["did you mean 'two-level'"],
    ),
    (&["run", "--scenario", "no.toml"], &["no.toml", "readable"]),
    (&["run", "--listen", "here"], &["--listen", "here"]),
    (
        &["run", "--listen", "192.0.2.1:49938"],
        &["--listen", "an address of this PC"],
    ),
    (&["run", "--peer", "x"], &["--peer", "x"]),
    (
        &["run", "--duration", "0"],
        &["--duration", "above 0, at most 3600"],
    ),
    (&["run", "--duration", "NaN"], &["--duration", "NaN"]),
    (&["run", "--dead-cycles", "9"], &["--dead-cycles", "0 to 8"]),
    (
        &["run", "--robot-adds", "gravty"],
        &["did you mean 'gravity'"],
    ),
    (
        &["run", "--null-stiffness", "hgh"],
        &["did you mean 'high'"],
    ),
    (
        &["run", "--require-start", "-1"],
        &["--require-start", "above 0"],
    ),
    (&["run", "--wait", "-1"], &["--wait", "above 0"]),
    (
        &["run", "--references", "192.0.2.1:1"],
        &["--references", "an address of this PC"],
    ),
    (
        &[
            "run",
            "--references",
            "127.0.0.1:0",
            "--reference-timeout-ms",
            "inf",
        ],
        &["--reference-timeout-ms", "inf"],
    ),
    (
        &["run", "--record", "/proc/none/r.csv"],
        &["/proc/none/r.csv", "can be written"],
    ),
    (
        &["run", "--summary", "/proc/none/s.json"],
        &["/proc/none/s.json"],
    ),
    (&["doctor", "--cycle-ms", "0"], &["--cycle-ms", "0.1 to 20"]),
];

#[test]
fn what_cannot_be_used_gets_one_line_and_exit_code_two() {
    let mut wrong = Vec::new();
    for (arguments, parts) in BAD {
        let folder = tempfile::tempdir().expect("a folder");
        let output = firmware_host(folder.path(), arguments);
        let text = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert_eq!(text.lines().count(), 1, "{arguments:?}: {text}");
        assert!(text.starts_with("error: "), "{arguments:?}: {text}");
        for part in *parts {
            if !text.contains(part) {
                wrong.push(format!("{arguments:?}: '{}' without '{part}'", text.trim()));
            }
        }
        let left = std::fs::read_dir(folder.path()).expect("the folder");
        let files = left.filter(|entry| !entry.as_ref().is_ok_and(|e| e.path().is_dir()));
        assert_eq!(files.count(), 0, "{arguments:?} left a file");
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn without_a_robot_the_exit_code_is_four() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["run", "--listen", "127.0.0.1:0", "--wait", "0.2"];
    let output = firmware_host(folder.path(), &arguments);
    let text = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(4), "{text}");
    assert!(text.contains("no robot"), "{text}");
}

#[test]
fn help_and_version_are_no_errors() {
    for argument in ["--help", "--version"] {
        let output = firmware_host(Path::new("."), &[argument]);
        assert_eq!(output.status.code(), Some(0));
        assert!(!output.stdout.is_empty() && output.stderr.is_empty());
    }
}
