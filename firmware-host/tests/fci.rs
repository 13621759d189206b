//! The program against the robot's end of the crate `fci` on sockets of this PC: the course of a
//! motion, and what ends it, with exit code and text. The arm stands still whatever is commanded.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::process::{Command, Output};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fci::robot::{Arm, IDENTITY, Limits, Operator, Robot, Settings};
use fci::{RobotMode, Version, command, state};

/// The usual posture, in the ranges of both arms: the start of two-level-fr3.
const READY_DEG: [f64; 7] = [0.0, -45.0, 0.0, -135.0, 0.0, 90.0, 45.0];

/// What a robot does besides, behind so many commands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Act {
    Nothing,
    /// Closes the connection.
    Close,
    /// Sends no states any more, and no replies.
    Silence,
    /// The person at the robot stops it.
    UserStop,
}

/// What a robot has seen.
#[derive(Debug, Default)]
struct Seen {
    commands: u64,
    motions: u64,
    load_kg: f64,
    mode: RobotMode,
}

/// Serves until the program has gone.
fn robot(address: IpAddr, version: Version, act: Act) -> JoinHandle<Seen> {
    let listener = TcpListener::bind((address, 1337)).expect("a port of an own address");
    thread::spawn(move || {
        let limits = match version {
            Version::V5 => Limits::PANDA,
            _ => Limits::FR3,
        };
        let mut robot = Robot::new(Settings::new(version, limits), &b""[..]);
        loop {
            let (tcp, from) = listener.accept().expect("the program connects");
            serve(&mut robot, tcp, from.ip(), address, act);
            let refused = robot.client().is_none();
            robot.disconnect();
            if !refused {
                let counters = robot.counters();
                return Seen {
                    commands: counters.commands,
                    motions: counters.motions,
                    load_kg: robot.load().m_load,
                    mode: robot.mode(),
                };
            }
        }
    })
}

/// One connection.
fn serve(robot: &mut Robot<&[u8]>, mut tcp: TcpStream, client: IpAddr, own: IpAddr, act: Act) {
    let udp = UdpSocket::bind((own, 0)).expect("a port");
    udp.set_nonblocking(true).expect("a socket");
    tcp.set_nonblocking(true).expect("a socket");
    let q = READY_DEG.map(f64::to_radians);
    let arm = Arm {
        q,
        dq: [0.0; 7],
        tau_j: [0.0; 7],
        tau_ext: [0.0; 7],
        wrench: [0.0; 6],
        o_t_f: IDENTITY,
        twist: [0.0; 6],
        theta: q,
        dtheta: [0.0; 7],
    };
    let mut operator = Operator::ABSENT;
    let mut next = Instant::now();
    loop {
        let mut room = [0; 1024];
        match tcp.read(&mut room) {
            Ok(0) => return,
            Ok(count) => {
                let mut bytes = &room[..count];
                while let Some(_handled) = robot.receive(&mut bytes).expect("a request") {
                    send(robot, &mut tcp);
                }
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(_) => return,
        }
        let mut room = [0; command::LEN_MAX + 1];
        while let Ok(count) = udp.recv(&mut room) {
            robot.command(&room[..count]);
        }
        let due = robot.counters().commands >= 300;
        match act {
            Act::Close if due => return,
            Act::Silence if due => {
                thread::sleep(Duration::from_millis(1));
                continue;
            }
            Act::UserStop if due => operator.user_stop = true,
            _ => {}
        }
        send(robot, &mut tcp);
        let version = robot.version();
        let mut room = [0; state::LEN_MAX];
        let datagram = robot.state(&arm, &operator).emit(version, &mut room);
        let datagram = datagram.expect("a state");
        if let Some(connect) = robot.client() {
            let _ = udp.send_to(datagram, SocketAddr::new(client, connect.udp_port));
        }
        // The answer acts in this cycle: it is waited for, as long as the loaded PC of a test
        // may take.
        let begin = Instant::now();
        while robot.waits() && begin.elapsed() < Duration::from_millis(200) {
            let mut room = [0; command::LEN_MAX + 1];
            match udp.recv(&mut room) {
                Ok(count) => drop(robot.command(&room[..count])),
                Err(_) => thread::sleep(Duration::from_micros(50)),
            }
        }
        robot.advance();
        next += Duration::from_millis(1);
        thread::sleep(next.saturating_duration_since(Instant::now()));
    }
}

/// Replies that are due. A program that has gone hears nothing.
fn send(robot: &mut Robot<&[u8]>, tcp: &mut TcpStream) {
    let mut room = [0; 512];
    loop {
        let count = robot.replies(&mut room);
        if count == 0 || tcp.write_all(&room[..count]).is_err() {
            return;
        }
    }
}

fn run(folder: &Path, address: IpAddr, more: &[&str]) -> (Output, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_firmware-host"))
        .current_dir(folder)
        .args(["run", "--robot", "fci", "--address", &address.to_string()])
        .args(["--duration", "0.5", "--summary", "summary.json"])
        .args(more)
        .output()
        .expect("the program starts");
    let text = [&output.stdout[..], &output.stderr[..]].concat();
    (output, String::from_utf8(text).expect("text"))
}

fn address(last: u8) -> IpAddr {
    [127, 0, 13, last].into()
}

#[test]
fn a_motion_by_versions_ten_and_five() {
    for (last, version) in [(1, Version::V10), (2, Version::V5)] {
        let folder = tempfile::tempdir().expect("a folder");
        let robot = robot(address(last), version, Act::Nothing);
        let (output, text) = run(folder.path(), address(last), &[]);
        assert_eq!(output.status.code(), Some(0), "{text}");
        let number = version.number();
        assert!(
            text.contains(&format!("connected, version {number}")),
            "{text}"
        );
        assert!(text.contains("the motion is over"), "{text}");
        let seen = robot.join().expect("the robot");
        assert_eq!((seen.motions, seen.mode), (1, RobotMode::Idle));
        // A second to settle, half a second of motion, half a second to rest and hold.
        assert!((1500..4000).contains(&seen.commands), "{seen:?}");
        let summary = std::fs::read_to_string(folder.path().join("summary.json"));
        let summary: serde_json::Value =
            serde_json::from_str(&summary.expect("a summary")).expect("JSON");
        assert_eq!(summary["fci"]["version"], number);
        assert_eq!(summary["fci"]["event"], "finished");
        assert_eq!(summary["cycle_ms"], 1.0);
    }
}

#[test]
fn a_dry_run_asks_for_no_motion() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = robot(address(3), Version::V10, Act::Nothing);
    let (output, text) = run(folder.path(), address(3), &["--dry"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(
        text.contains("dry: the last torque would have been"),
        "{text}"
    );
    let seen = robot.join().expect("the robot");
    assert_eq!((seen.motions, seen.commands), (0, 0));
}

#[test]
fn what_ends_a_motion_has_its_code_and_text() {
    for (last, act, part) in [
        (4, Act::Close, "the robot closed the connection"),
        (5, Act::Silence, "nothing came from the robot for 1 s"),
        (6, Act::UserStop, "user stop"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let robot = robot(address(last), Version::V10, act);
        let (output, text) = run(folder.path(), address(last), &[]);
        assert_eq!(output.status.code(), Some(3), "{act:?}: {text}");
        assert!(text.contains(part), "{act:?}: {text}");
        assert!(folder.path().join("out/flight-record.csv").exists());
        robot.join().expect("the robot");
    }
}

#[test]
fn no_robot_and_a_robot_of_another_version_are_exit_code_four() {
    let folder = tempfile::tempdir().expect("a folder");
    let (output, text) = run(folder.path(), address(7), &["--wait", "0.5"]);
    assert_eq!(output.status.code(), Some(4), "{text}");
    assert!(text.contains("no robot at 127.0.13.7:1337"), "{text}");

    // Byte by byte: incompatible version, 4.
    let listener = TcpListener::bind((address(8), 1337)).expect("a port");
    let robot = thread::spawn(move || {
        let (mut tcp, _) = listener.accept().expect("the program connects");
        let mut request = [0; 16];
        tcp.read_exact(&mut request).expect("Connect");
        assert_eq!(request[12..14], [10, 0]);
        let mut reply = request[..12].to_vec();
        reply[8] = 15;
        reply.extend([1, 4, 0]);
        tcp.write_all(&reply).expect("the reply");
        // Until the program has gone.
        let _ = tcp.read(&mut request);
    });
    let (output, text) = run(folder.path(), address(8), &[]);
    assert_eq!(output.status.code(), Some(4), "{text}");
    let expected = "version of the robot: 4; tried: 10; allowed: 5 to 10";
    assert!(text.contains(expected), "{text}");
    robot.join().expect("the robot");
}

/// The tool of the scenario is the load of a robot that has no end effector.
#[test]
fn the_tool_is_the_load() {
    let folder = tempfile::tempdir().expect("a folder");
    let tool = "robot = \"fr3\"\nname = \"tool\"\nduration_s = 1.0\ncycle_ms = 1.0\n\
        start_deg = [0, -45, 0, -135, 0, 90, 45]\n\
        [tool]\nmass_kg = 0.75\ncenter_of_mass_m = [0, 0, 0.05]\n\
        inertia_kg_m2 = [1e-3, 0, 0, 1e-3, 0, 1e-3]\n\
        [[level]]\npoint = \"flange\"\naxes = \"xyz\"\nstiffness = 100.0\ndamping = 20.0\n\
        reference = { kind = \"hold\" }\n\
        [null_space]\nstiffness = [5, 5, 5, 5, 1, 1, 0.2]\n\
        damping = [2, 2, 2, 2, 0.3, 0.3, 0.03]\n[observer]\ngain = 50\n";
    std::fs::write(folder.path().join("tool.toml"), tool).expect("a file");
    let robot = robot(address(9), Version::V10, Act::Nothing);
    let (output, text) = run(folder.path(), address(9), &["--scenario", "tool.toml"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert_eq!(robot.join().expect("the robot").load_kg, 0.75);
}
