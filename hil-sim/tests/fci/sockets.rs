//! `hil-sim serve --robot fci` as a program, and a client on its sockets.

use std::fs;
use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::path::Path;
use std::process::{Child, Command as Process, Stdio};
use std::time::Duration;

use fci::status::MoveStatus;
use fci::{
    Reply, Request, RobotError, RobotErrors, RobotMode, State, StatePacket, Stream, Version, state,
};
use serde_json::Value;

use crate::client::{bytes, command, connect, motion, springs, thresholds};

/// The program, listening.
struct Served {
    process: Child,
    address: SocketAddr,
}

impl Served {
    fn start(out: &Path, options: &[&str]) -> Self {
        let mut process = Process::new(env!("CARGO_BIN_EXE_hil-sim"))
            .args(
                "serve --robot fci --address 127.0.0.1:0 --duration 0.3 --contacts off".split(' '),
            )
            .args(options)
            .arg("--out")
            .arg(out)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("started");
        let errors = process.stderr.take().expect("piped");
        let mut lines = BufReader::new(errors).lines();
        let address = lines.find_map(|line| {
            let line = line.expect("text");
            let (_, rest) = line.split_once("listening on ")?;
            rest.split_once(';')?.0.parse().ok()
        });
        // What else it says is read, so that it can say it.
        std::thread::spawn(move || lines.for_each(drop));
        Self {
            process,
            address: address.expect("an address"),
        }
    }

    /// Its exit code and the part `fci` of the summary.
    fn end(mut self, out: &Path) -> (Option<i32>, Value) {
        let code = self.process.wait().expect("ended").code();
        let summary = fs::read_to_string(out.join("summary.json")).expect("written");
        let summary: Value = serde_json::from_str(&summary).expect("JSON");
        (code, summary["fci"].clone())
    }
}

struct Client {
    version: Version,
    stream: TcpStream,
    datagrams: UdpSocket,
    replies: Stream<Vec<u8>>,
    next_id: u32,
}

impl Client {
    fn new(address: SocketAddr, version: Version) -> Self {
        let stream = TcpStream::connect(address).expect("listening");
        let datagrams = UdpSocket::bind("127.0.0.1:0").expect("a port");
        let patience = Some(Duration::from_secs(10));
        stream.set_read_timeout(patience).expect("a timeout");
        datagrams.set_read_timeout(patience).expect("a timeout");
        let port = datagrams.local_addr().expect("an address").port();
        let mut client = Self {
            version,
            stream,
            datagrams,
            replies: Stream::new(vec![0; 1 << 16], 1 << 16).expect("room"),
            next_id: 0,
        };
        client.send(&connect(version, port));
        client
    }

    fn send(&mut self, request: &Request) {
        let bytes = bytes(self.version, self.next_id, request);
        self.next_id += 1;
        self.stream.write_all(&bytes).expect("a connection");
    }

    /// The next reply as text.
    fn reply(&mut self) -> String {
        loop {
            let mut byte = [0];
            self.stream.read_exact(&mut byte).expect("a reply");
            if let Some(message) = self.replies.next(&mut &byte[..]).expect("sizes") {
                let reply = Reply::parse(self.version, &message).expect("a reply");
                return format!("{reply:?}");
            }
        }
    }

    fn state(&mut self) -> (State, SocketAddr) {
        let mut room = [0; state::LEN_MAX];
        let (count, from) = self.datagrams.recv_from(&mut room).expect("a state");
        let packet = StatePacket::new_checked(self.version, &room[..count]).expect("a state");
        (State::parse(&packet), from)
    }

    /// Moves for so many cycles of its own and ends the motion, unless a reflex does: its errors.
    fn run(&mut self, cycles: u32) -> RobotErrors {
        assert!(self.reply().contains("Success"));
        self.send(&thresholds(100.0, 100.0));
        assert!(self.reply().contains("Success"));
        self.send(&motion(self.version));
        let started = format!("{:?}", Reply::Move(MoveStatus::MotionStarted));
        assert_eq!(self.reply(), started);
        while self.state().0.robot_mode != RobotMode::Move {}
        let posture = self.state().0.q;
        for cycle in 1.. {
            let (state, robot) = self.state();
            if state.robot_mode != RobotMode::Move {
                let status = if state.errors.is_empty() {
                    MoveStatus::Success
                } else {
                    MoveStatus::ReflexAborted
                };
                assert_eq!(self.reply(), format!("{:?}", Reply::Move(status)));
                return state.errors;
            }
            let mut wish = posture;
            wish[0] += 0.2 * (1.0 - (0.005 * f64::from(cycle)).cos());
            let torque = springs(&state, &wish);
            let answer = command(self.version, &state, torque, cycle >= cycles);
            self.datagrams.send_to(&answer, robot).expect("sent");
        }
        unreachable!("cycles without end")
    }
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("fci")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

#[test]
fn virtual_time_gives_the_same_bytes() {
    for (version, number) in [(Version::V5, "5"), (Version::V10, "10")] {
        for faults in [None, Some("both:drop=0.03")] {
            let traces = ["one", "two"].map(|name| {
                let out = folder(&format!("{number}-{}-{name}", faults.is_some()));
                let mut options = vec!["--lockstep", "--version", number];
                options.extend(faults.iter().flat_map(|spec| ["--fault", spec]));
                let served = Served::start(&out, &options);
                let mut client = Client::new(served.address, version);
                assert_eq!(client.run(1400), RobotErrors::NONE);
                drop(client);
                let (code, fci) = served.end(&out);
                assert_eq!(code, Some(0));
                assert_eq!(fci["version"].to_string(), number);
                assert_eq!(fci["motions"], 1);
                assert_eq!(fci["command_share"], 1.0);
                let lost = fci["lost"].as_u64().expect("a count");
                match faults {
                    None => assert_eq!(lost, 0),
                    // 6 % of 1500 within six standard deviations.
                    Some(_) => assert!((35..150).contains(&lost), "{lost}"),
                }
                fs::read(out.join("trace.csv")).expect("written")
            });
            assert!(traces[0] == traces[1], "{number} {faults:?}");
        }
    }
}

#[test]
fn by_the_wall_clock_it_is_served_too() {
    let out = folder("paced");
    let served = Served::start(&out, &[]);
    let mut client = Client::new(served.address, Version::V10);
    let errors = client.run(1400);
    drop(client);
    let (code, fci) = served.end(&out);
    // A PC that is busy may keep the client from running for 20 ms.
    let late = RobotErrors::NONE.with(RobotError::CommunicationConstraintsViolation);
    match errors {
        RobotErrors::NONE => assert_eq!(code, Some(0)),
        errors => {
            assert_eq!(errors, late);
            assert_eq!(code, Some(1));
            assert_eq!(
                fci["errors"][0],
                RobotError::CommunicationConstraintsViolation.name()
            );
        }
    }
    assert!(fci["own_lateness"]["max_ms"].as_f64().is_some());
}

#[test]
fn one_client_at_a_time_and_of_the_same_version() {
    let out = folder("second");
    let served = Served::start(&out, &["--lockstep"]);
    let mut other = Client::new(served.address, Version::V5);
    let reply = other.reply();
    assert!(
        reply.contains("IncompatibleVersion, version: 10"),
        "{reply}"
    );
    // A second one is turned away while the first is there.
    let mut second = TcpStream::connect(served.address).expect("listening");
    let timeout = Some(Duration::from_secs(10));
    second.set_read_timeout(timeout).expect("a timeout");
    let read = second.read(&mut [0; 1]);
    let closed = |error: &std::io::Error| error.kind() == ErrorKind::ConnectionReset;
    assert!(
        read.as_ref().map_or_else(closed, |count| *count == 0),
        "{read:?}"
    );
    drop(other);
    // One that says nonsense is closed, and the next is served.
    // The robot may not have seen yet that the one before has gone: several try.
    for _ in 0..50 {
        let mut wrong = TcpStream::connect(served.address).expect("listening");
        wrong.set_read_timeout(timeout).expect("a timeout");
        let _ = wrong.write_all(&[0xFF; 12]);
        let read = wrong.read(&mut [0; 1]);
        assert!(read.map_or_else(|error| closed(&error), |count| count == 0));
    }
    let mut client = loop {
        let mut client = Client::new(served.address, Version::V10);
        let mut peeked = [0; 1];
        match client.stream.peek(&mut peeked) {
            Ok(1) => break client,
            // The first is still being turned away.
            _ => client.next_id = 0,
        }
    };
    assert_eq!(client.run(1400), RobotErrors::NONE);
    drop(client);
    let (code, fci) = served.end(&out);
    assert_eq!(code, Some(0));
    let events = fci["events"].to_string();
    assert!(
        events.contains("length of message: 4294967295 bytes"),
        "{events}"
    );
}
