//! `hil-sim serve` as a program, against a client of a few lines on a socket.

use std::fs;
use std::io::Write as _;
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Command as Process, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Session};
use cell::scenario::{Scenario, ScenarioSource};
use fri::{Command, Flags, InterfaceState, Measurement, MeasurementPacket};
use serde_json::Value;

/// A client on its own port that answers until it is dropped.
struct Client {
    port: u16,
    stop: Arc<AtomicBool>,
    thread: Option<thread::JoinHandle<u64>>,
}

impl Client {
    /// Answers `most` measurements.
    fn start(most: u64) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
        socket
            .set_read_timeout(Some(Duration::from_millis(20)))
            .expect("a timeout");
        let port = socket.local_addr().expect("an address").port();
        let stop = Arc::<AtomicBool>::default();
        let flag = Arc::clone(&stop);
        let thread = thread::spawn(move || {
            let (mut bytes, mut answers) = ([0; 2000], 0);
            while !flag.load(Ordering::Relaxed) {
                let Ok((length, robot)) = socket.recv_from(&mut bytes) else {
                    continue;
                };
                let Ok(packet) = MeasurementPacket::new_checked(&bytes[..length]) else {
                    continue;
                };
                if answers == most {
                    continue;
                }
                answers += 1;
                let out = answer(&Measurement::parse(&packet), answers);
                socket.send_to(&out, robot).expect("sent");
            }
            answers
        });
        Self {
            port,
            stop,
            thread: Some(thread),
        }
    }

    fn end(mut self) -> u64 {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().expect("running").join().expect("ended")
    }
}

/// Mirrors positions; a mild damping is all that it wants from the robot.
fn answer(msr: &Measurement, number: u64) -> [u8; Command::LEN] {
    let mut command = Command {
        flags: Flags::JOINT_IMPEDANCE,
        ..Command::default()
    };
    command.header.counter = (number + 40_000) as u16;
    command.header.reflected = msr.header.counter;
    command.user.real[0] = 0.25;
    command.joint_stiffness = [100.0; 7];
    command.joint_damping = [0.7; 7];
    command.joint_position = match msr.state {
        InterfaceState::Command => msr.joint_position,
        _ => msr.total_commanded_position(),
    };
    let mut bytes = [0; Command::LEN];
    command.emit(&mut bytes);
    bytes
}

fn serve(folder: &Path, port: u16, arguments: &str, input: &str) -> Output {
    let mut child = Process::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(["serve", "--port", &port.to_string()])
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("piped");
    stdin.write_all(input.as_bytes()).expect("read");
    drop(stdin);
    child.wait_with_output().expect("the program ends")
}

fn summary(folder: &Path, out: &str) -> Value {
    let text = fs::read_to_string(folder.join(out).join("summary.json")).expect("a summary");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn lockstep_gives_the_same_bytes_with_faults() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let faults = "--fault to-client:drop=0.01 --fault to-robot:jitter=1.5 \
                  --fault both:duplicate=0.002 --fault to-robot:burst=0.0005x4";
    for out in ["a", "b"] {
        let client = Client::start(u64::MAX);
        let arguments = format!("--lockstep --duration 2 --out {out} {faults}");
        let output = serve(folder.path(), client.port, &arguments, "");
        let text = String::from_utf8_lossy(&output.stderr).to_string();
        assert!(output.status.code().is_some_and(|code| code <= 1), "{text}");
        assert!(String::from_utf8_lossy(&output.stdout).contains("link: "));
        client.end();
    }
    for file in ["trace.csv", "summary.json", "report.html"] {
        let read = |out: &str| fs::read(folder.path().join(out).join(file)).expect("a file");
        if file == "report.html" {
            assert!(!read("a").is_empty());
            continue;
        }
        assert!(read("a") == read("b"), "{file}");
    }
    let link = summary(folder.path(), "a")["link"].clone();
    assert!(link.get("own_lateness").is_none(), "virtual time: {link}");
    assert!(link["missed"].as_u64() > Some(5), "{link}");
    assert_eq!(summary(folder.path(), "a")["cycles"], 1000);
    // r of the trace is what the client reports.
    let trace = fs::read_to_string(folder.path().join("a/trace.csv")).expect("a trace");
    let mut lines = trace.lines();
    let header: Vec<_> = lines.next().expect("a header").split(',').collect();
    let r1 = header.iter().position(|name| *name == "r1").expect("r1");
    let value: f64 = lines
        .next()
        .and_then(|line| line.split(',').nth(r1))
        .and_then(|value| value.parse().ok())
        .expect("a number");
    assert_eq!(value, 0.25);
}

/// The bridge behind a socket: its answers and nothing else.
fn bridge(socket: &UdpSocket, duration_s: f64, stop: &AtomicBool) {
    let mut scenario = Scenario::find("two-level").expect("built in");
    scenario.duration_s = duration_s;
    let config = scenario.session_config(0, duration_s).expect("a session");
    let mut source = ScenarioSource::new(&scenario);
    let mut session = Session::new(Lwr::new(), config);
    let (mut bytes, mut answer) = ([0; 2000], [0; ANSWER_LEN]);
    while !stop.load(Ordering::Relaxed) {
        let Ok((length, robot)) = socket.recv_from(&mut bytes) else {
            continue;
        };
        let outcome = session.receive(&bytes[..length], &mut source, &mut answer);
        if matches!(outcome, Outcome::Answered) {
            socket.send_to(&answer, robot).expect("sent");
        }
    }
}

/// A client's socket that does not wait for long, and its port.
fn client() -> (UdpSocket, u16) {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let timeout = Duration::from_millis(20);
    socket.set_read_timeout(Some(timeout)).expect("a timeout");
    let port = socket.local_addr().expect("an address").port();
    (socket, port)
}

/// Over a socket or from hand to hand: the same motion to the last bit.
#[test]
fn lockstep_over_a_socket_is_the_run_in_one_process() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = Process::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args("run two-level --measurement fri --duration 5 --out run".split(' '))
        .current_dir(folder.path())
        .output()
        .expect("the program runs");
    let text = String::from_utf8_lossy(&run.stderr).to_string();
    assert_eq!(run.status.code(), Some(0), "{text}");
    let (socket, port) = client();
    let stop = AtomicBool::new(false);
    let output = thread::scope(|scope| {
        scope.spawn(|| bridge(&socket, 5.0, &stop));
        let output = serve(folder.path(), port, "--lockstep --duration 5 --out udp", "");
        stop.store(true, Ordering::Relaxed);
        output
    });
    let text = String::from_utf8_lossy(&output.stderr).to_string();
    assert_eq!(output.status.code(), Some(0), "{text}");
    let read = |out: &str| fs::read(folder.path().join(out).join("trace.csv")).expect("a trace");
    assert!(read("run") == read("udp"));
}

#[test]
fn a_client_that_goes_away_does_not_keep_the_robot() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let client = Client::start(1000);
    let output = serve(
        folder.path(),
        client.port,
        "--lockstep --duration 3 --out o",
        "",
    );
    let text = String::from_utf8_lossy(&output.stderr).to_string();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert_eq!(client.end(), 1000);
    let summary = summary(folder.path(), "o");
    assert_eq!(summary["cycles"], 1500);
    assert_eq!(summary["link"]["fallbacks"], 1);
    assert!(
        summary["reason"]
            .as_str()
            .is_some_and(|reason| reason.contains("not in command state at the end"))
    );
}

#[test]
fn paced_by_the_wall_clock_it_gets_to_the_end() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let client = Client::start(u64::MAX);
    // A busy machine is no reason to fail: long cycles, lenient rating.
    let arguments = "--cycle-ms 5 --duration 1 --plant ideal --contacts off --bad-rate 0.1 \
                     --ok-rate 0.2 --misses 50 --wait 20 --out o";
    let output = serve(
        folder.path(),
        client.port,
        arguments,
        "push elbow 0 5 0 0.5\nhold\n",
    );
    let text = String::from_utf8_lossy(&output.stderr).to_string();
    assert!(output.status.code().is_some_and(|code| code <= 1), "{text}");
    assert!(text.contains("'hold': allowed: push"), "{text}");
    assert!(client.end() > 200);
    let summary = summary(folder.path(), "o");
    assert_eq!(summary["cycles"], 200);
    // The robot's own lateness is a row of its own; who timed the answers is said.
    let own = &summary["link"]["own_lateness"];
    assert_eq!(own["bound_ms"], 0.5);
    assert!(own["max_ms"].as_f64() >= own["p999_ms"].as_f64(), "{own}");
    let stamp = if cfg!(target_os = "linux") {
        "kernel"
    } else {
        "program"
    };
    assert_eq!(own["stamp"], stamp);
    let text = String::from_utf8_lossy(&output.stdout).to_string();
    assert!(text.contains("robot's own lateness: "), "{text}");
}

#[test]
fn without_client_the_exit_code_is_four() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for mode in ["", "--lockstep"] {
        let port = UdpSocket::bind("127.0.0.1:0")
            .and_then(|socket| socket.local_addr())
            .expect("a port")
            .port();
        let arguments = format!("{mode} --wait 0.3 --out o");
        let output = serve(folder.path(), port, &arguments, "");
        assert_eq!(output.status.code(), Some(4));
        let text = String::from_utf8_lossy(&output.stderr).to_string();
        assert!(text.contains("no answer from 127.0.0.1"), "{text}");
        assert!(!folder.path().join("o/summary.json").exists());
    }
}

/// A program of another protocol at the client's port is named by what it sends.
#[test]
fn datagrams_that_are_no_answers_are_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (socket, port) = client();
    let stop = AtomicBool::new(false);
    let output = thread::scope(|scope| {
        scope.spawn(|| {
            let mut bytes = [0; 2000];
            while !stop.load(Ordering::Relaxed) {
                if let Ok((_, robot)) = socket.recv_from(&mut bytes) {
                    socket.send_to(&[7; 100], robot).expect("sent");
                }
            }
        });
        let output = serve(folder.path(), port, "--wait 0.3 --out o", "");
        stop.store(true, Ordering::Relaxed);
        output
    });
    assert_eq!(output.status.code(), Some(4));
    let text = String::from_utf8_lossy(&output.stderr).to_string();
    assert!(
        text.contains(
            "datagrams from there were refused, the last: length: 100 bytes; allowed: 376"
        ),
        "{text}"
    );
}

#[test]
fn quit_ends_the_run_with_its_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let client = Client::start(u64::MAX);
    let output = serve(folder.path(), client.port, "--lockstep --out o", "quit\n");
    assert_eq!(output.status.code(), Some(3));
    client.end();
    assert_eq!(summary(folder.path(), "o")["reason"], "quit");
}
