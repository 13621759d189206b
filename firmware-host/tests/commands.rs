//! The command line: one line for everything that cannot be used, and the exit
//! codes.

use std::net::UdpSocket;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

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
    (
        &["run", "--listen", "here"],
        &["--listen", "here", "such as 127.0.0.1:49938"],
    ),
    (&["run", "--listen", ""], &["--listen", "ADDRESS:PORT"]),
    (
        &["run", "--listen", "192.0.2.1:49938"],
        &["--listen", "an address of this PC"],
    ),
    (&["run", "--peer", "x"], &["--peer", "x", "ADDRESS:PORT"]),
    (&["run", "--peer", "0.0.0.0:1"], &["--peer", "0.0.0.0:1"]),
    (&["run", "--cpu", "x"], &["--cpu", "'x'", "whole numbers"]),
    (&["run", "--cpu", "-1"], &["--cpu", "'-1'", "whole numbers"]),
    (&["run", "--dry=1"], &["--dry", "'1'", "no value"]),
    (
        &[
            "run",
            "--listen",
            "127.0.0.1:0",
            "--summary",
            "a",
            "--record",
            "a",
        ],
        &["--record: a", "another file than that of --summary"],
    ),
    (
        &[
            "run",
            "--listen",
            "127.0.0.1:0",
            "--summary",
            "a",
            "--record",
            "./a",
        ],
        &["--record: ./a", "another file than that of --summary"],
    ),
    (
        &[
            "run",
            "--listen",
            "127.0.0.1:0",
            "--record",
            "a",
            "--flight-record",
            "./a",
        ],
        &["--flight-record: ./a", "another file than that of --record"],
    ),
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
        &["run", "--references-from", "127.0.0.1:5600"],
        &["--references"],
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
        &["run", "--reference-timeout-ms", "0"],
        &["--reference-timeout-ms", "above 0"],
    ),
    (
        &[
            "run",
            "--listen",
            "127.0.0.1:0",
            "--record",
            "/proc/none/r.csv",
        ],
        &["/proc/none/r.csv", "can be written"],
    ),
    (
        &[
            "run",
            "--listen",
            "127.0.0.1:0",
            "--summary",
            "/proc/none/s.json",
        ],
        &["/proc/none/s.json"],
    ),
    (&["doctor", "--cycle-ms", "0"], &["--cycle-ms", "0.1 to 20"]),
    (
        &["doctor", "--robot", "fri"],
        &["robot", "unknown 'fri'", "did you mean 'fci'"],
    ),
    (
        &["run", "--robot", "lrw"],
        &["unknown 'lrw'", "did you mean 'lwr'"],
    ),
    (
        &["run", "--robot", "fci"],
        &["--address: none", "the address of the robot"],
    ),
    (
        &["run", "--robot", "fci", "--address", "127.0.0.1:1337"],
        &["--address", "without a port"],
    ),
    (
        &[
            "run",
            "--robot",
            "fci",
            "--address",
            "127.0.0.1",
            "two-levl-fr3",
        ],
        &["did you mean 'two-level-fr3'"],
    ),
    (
        &["run", "two-level", "--scenario", "two-level"],
        &["--scenario"],
    ),
    (
        &["run", "--robot", "fci", "--listen", "127.0.0.1:0"],
        &["--listen: 127.0.0.1:0", "only with --robot lwr"],
    ),
    (
        &["run", "--robot", "fci", "--robot-adds", "gravity"],
        &["--robot-adds: gravity", "only with --robot lwr"],
    ),
    (
        &["run", "--address", "127.0.0.1"],
        &["--address: 127.0.0.1", "only with --robot fci"],
    ),
    (
        &["run", "--recover"],
        &["--recover", "only with --robot fci"],
    ),
    (
        &["run", "--robot", "fci", "--collision-torque", "0"],
        &["--collision-torque", "above 0, at most 1000"],
    ),
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

/// A record of before stays as it is when there is nothing to record.
#[test]
fn a_port_in_use_is_named_and_no_file_is_touched() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("record.csv");
    std::fs::write(&record, "of yesterday").expect("a file");
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address").to_string();
    for (listen, code) in [(address.as_str(), 2), ("127.0.0.1:0", 4)] {
        let arguments = [
            "run",
            "--listen",
            listen,
            "--wait",
            "0.2",
            "--record",
            "record.csv",
        ];
        let output = firmware_host(folder.path(), &arguments);
        let text = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.contains(listen), "{text}");
        assert_eq!(
            std::fs::read_to_string(&record).expect("the record"),
            "of yesterday"
        );
    }
}

/// What came instead of a robot: how much, from whom, and what it should have been.
#[test]
fn datagrams_of_another_protocol_are_told() {
    let address = {
        let free = UdpSocket::bind("127.0.0.1:0").expect("a port");
        free.local_addr().expect("an address").to_string()
    };
    let stranger = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let from = stranger.local_addr().expect("an address");
    let folder = tempfile::tempdir().expect("a folder");
    let child = Command::new(env!("CARGO_BIN_EXE_firmware-host"))
        .current_dir(folder.path())
        .args(["run", "--listen", &address, "--wait", "1"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    for _ in 0..150 {
        // Before the program there is nobody at that port.
        let _ = stranger.send_to(&[7; 300], &address);
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().expect("the end");
    let text = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(4), "{text}");
    let expected =
        format!("datagrams were refused, the last from {from}: length: 300 bytes; allowed: 916");
    assert!(text.contains(&expected), "{text}");
}

/// Strangers that go on sending are no robot, and do not keep the program alive.
#[test]
fn strangers_do_not_make_it_wait() {
    let address = {
        let free = UdpSocket::bind("127.0.0.1:0").expect("a port");
        free.local_addr().expect("an address").to_string()
    };
    let stop = Arc::<AtomicBool>::default();
    let (flag, to) = (Arc::clone(&stop), address.clone());
    let stranger = std::thread::spawn(move || {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
        while !flag.load(Ordering::Relaxed) {
            // Before and after the program there is nobody at that port.
            let _ = socket.send_to(b"hello", &to);
            std::thread::sleep(Duration::from_millis(1));
        }
    });
    let folder = tempfile::tempdir().expect("a folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_firmware-host"))
        .current_dir(folder.path())
        .args(["run", "--listen", &address, "--wait", "0.3"])
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let deadline = Instant::now() + Duration::from_secs(20);
    let mut status = None;
    while status.is_none() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(20));
        status = child.try_wait().expect("a child");
    }
    stop.store(true, Ordering::Relaxed);
    stranger.join().expect("the stranger");
    let _ = child.kill();
    child.wait().expect("the end");
    assert_eq!(status.and_then(|status| status.code()), Some(4));
}

/// Nobody has to read what it says.
#[test]
fn a_closed_standard_error_does_not_end_it_early() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_firmware-host"))
        .current_dir(folder.path())
        .args(["run", "--listen", "127.0.0.1:0", "--wait", "0.2"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stderr.take());
    let status = child.wait().expect("the program ends");
    assert_eq!(status.code(), Some(4));
}

#[test]
fn help_and_version_are_no_errors() {
    for argument in ["--help", "--version"] {
        let output = firmware_host(Path::new("."), &[argument]);
        assert_eq!(output.status.code(), Some(0));
        assert!(!output.stdout.is_empty() && output.stderr.is_empty());
    }
}

/// What a planner must send is said where the option is.
#[test]
fn help_says_what_a_reference_is() {
    let output = firmware_host(Path::new("."), &["run", "--help"]);
    let text = String::from_utf8(output.stdout).expect("text");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "x y z, velocity, acceleration (9 numbers",
        "w x y z, angular velocity, angular acceleration (10 numbers",
    ] {
        assert!(text.contains(part), "{text}");
    }
}
