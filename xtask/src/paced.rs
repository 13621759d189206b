//! Robot and controller by the wall clock on a busy PC: who is late, and how often.

use std::fs;
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use serde_json::Value;

use crate::tools::{Outcome, Trouble, good, program, target};

/// Largest share of cycles that may be without the client's answer in time.
const MISSED_SHARE: f64 = 0.001;

/// The client's own p99.9 must be below this, or its share says nothing of the robot \[us\].
const CLIENT_P999_US: f64 = 1000.0;

/// Threads that may be kept busy.
const MOST_BUSY: usize = 64;

/// How long both talk, and how busy the PC is meanwhile.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Setting {
    seconds: f64,
    busy: usize,
    /// Whether a PC on which the share says nothing of the link is no failure.
    smoke: bool,
}

/// Runs both programs with SCHED_FIFO while threads are kept busy, and judges the link.
pub fn run(words: &[&str]) -> Outcome {
    let setting = Setting::read(words)?;
    let robot = program("hil-sim", "hil-sim")?;
    let client = program("firmware-host", "firmware-host")?;
    let work = target().join("paced");
    fs::create_dir_all(&work)?;
    let stop = AtomicBool::new(false);
    let [served, answered] = thread::scope(|scope| {
        for _ in 0..setting.busy {
            scope.spawn(|| {
                while !stop.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let talked = talk(&work, &robot, &client, setting.seconds);
        stop.store(true, Ordering::Relaxed);
        talked
    })?;
    let judged = Judged::of(&served, &answered)?;
    println!(
        "{:.0} s at load {}: {}",
        setting.seconds,
        setting.busy,
        judged.row()
    );
    let (unmet, mut objections) = (judged.unmet(), judged.objections());
    if setting.smoke && !unmet.is_empty() {
        // Without them the share is the PC's. That both came to talk is not.
        objections.retain(|objection| !objection.is_share);
        println!("the share is not judged: {}", unmet.join("; "));
    } else {
        for text in &unmet {
            println!("NOT as it should be: {text}");
        }
    }
    for Objection { text, .. } in &objections {
        println!("NOT as it should be: {text}");
    }
    Ok(objections.is_empty() && (setting.smoke || unmet.is_empty()))
}

impl Setting {
    fn read(mut words: &[&str]) -> Result<Self, Trouble> {
        let smoke = matches!(words, ["--smoke", ..]);
        let (mut seconds, mut busy) = (600.0, 8);
        if smoke {
            (seconds, busy) = (15.0, 1);
            words = &words[1..];
        }
        while let [name, value, rest @ ..] = words {
            let number = value.parse::<f64>().unwrap_or(f64::NAN);
            match *name {
                "--minutes" => seconds = number * 60.0,
                "--seconds" => seconds = number,
                "--load" => busy = value.parse().unwrap_or(usize::MAX),
                _ => break,
            }
            words = rest;
        }
        let usage = |what: String| Err(Trouble::usage(what));
        if let [word, ..] = words {
            let allowed = "--smoke at first, --minutes, --seconds or --load with a number";
            return usage(format!("{word}: allowed: {allowed}"));
        }
        // The least that command state and its settling take; the longest scenario.
        if !(1.0..=3600.0).contains(&seconds) {
            return usage(format!("length {seconds} s: allowed: 1 to 3600"));
        }
        if busy > MOST_BUSY {
            return usage(format!("--load: allowed: 0 to {MOST_BUSY}"));
        }
        Ok(Self {
            seconds,
            busy,
            smoke,
        })
    }
}

/// Lets both programs talk: the robot's summary and the client's.
fn talk(work: &Path, robot: &Path, client: &Path, seconds: f64) -> Result<[Value; 2], Trouble> {
    // A port that is free now.
    let port = UdpSocket::bind("127.0.0.1:0")?.local_addr()?.port();
    let (folder, file) = (work.join("served"), work.join("client.json"));
    for path in [folder.join("summary.json"), file.clone()] {
        if path.exists() {
            // That of another run would count.
            fs::remove_file(path)?;
        }
    }
    let duration = seconds.to_string();
    let robot = Command::new(robot)
        .args(["serve", "--scenario", "two-level", "--duration", &duration])
        .args(["--port", &port.to_string(), "--out"])
        .arg(&folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let mut client = Command::new(client);
    client
        .args(["run", "--scenario", "two-level", "--duration", &duration])
        .args(["--listen", &format!("127.0.0.1:{port}"), "--summary"])
        .arg(&file)
        .current_dir(work);
    let answered = client.output();
    // It ends with its scenario, or for want of a client.
    let served = robot.wait_with_output()?;
    let answered = answered?;
    // Exit code 1 is the robot's verdict on the motion; the link is judged here.
    if served.status.code() != Some(1) {
        good("hil-sim serve", &served)?;
    }
    good("firmware-host run", &answered)?;
    Ok([read(&folder.join("summary.json"))?, read(&file)?])
}

fn read(path: &Path) -> Result<Value, Trouble> {
    Ok(serde_json::from_str(&fs::read_to_string(path)?)?)
}

/// What is wrong with the link.
struct Objection {
    text: String,
    /// Whether it is the share of cycles without an answer in time.
    is_share: bool,
}

/// What the summaries say.
#[derive(Clone, Debug)]
struct Judged {
    cycles: u64,
    /// Those of them in command state.
    commanded: u64,
    missed: u64,
    client_p999_us: f64,
    own: String,
    /// Who got no SCHED_FIFO, and why.
    ordinary: Vec<String>,
    /// By whom arrivals are timed.
    stamp: String,
}

impl Judged {
    fn of(served: &Value, answered: &Value) -> Result<Self, Trouble> {
        let link = &served["link"];
        let (own, states) = (&link["own_lateness"], &link["state_cycles"]);
        let missing = |what: &str| Trouble::new(format!("the summaries lack {what}"));
        let count = |value: &Value, what| value.as_u64().ok_or_else(|| missing(what));
        let number = |value: &Value, what| value.as_f64().ok_or_else(|| missing(what));
        let programs = [("serve", link), ("firmware-host", answered)];
        let ordinary = programs.iter().filter_map(|(name, of)| {
            let fifo = &of["realtime"]["fifo"];
            (fifo != "given").then(|| format!("{name} has no SCHED_FIFO: {fifo}"))
        });
        let late = count(&own["cycles"], "link.own_lateness")?;
        let [bound, p999, max] = ["bound_ms", "p999_ms", "max_ms"].map(|name| &own[name]);
        let max = Duration::from_secs_f64(number(max, "link.own_lateness.max_ms")? * 1e-3);
        let commanded = count(&states["command"], "link.state_cycles")?;
        Ok(Self {
            cycles: count(&states["monitor"], "link.state_cycles")? + commanded,
            commanded,
            missed: count(&link["missed"], "link.missed")?,
            client_p999_us: number(&answered["latency"]["p999_us"], "latency.p999_us")?,
            own: format!(
                "{late} cycles more than {bound} ms late, p99.9 {p999} ms, max {:.3} ms",
                max.as_secs_f64() * 1e3
            ),
            ordinary: ordinary.collect(),
            stamp: own["stamp"].as_str().unwrap_or_default().into(),
        })
    }

    fn share(&self) -> f64 {
        self.missed as f64 / self.cycles.max(1) as f64
    }

    fn row(&self) -> String {
        format!(
            "client p99.9 {:.1} us, {} of {} cycles attributed to it ({:.4} %, at most {} %); \
             robot's own lateness {}; arrivals by the clock of the {}",
            self.client_p999_us,
            self.missed,
            self.cycles,
            self.share() * 100.0,
            MISSED_SHARE * 100.0,
            self.own,
            self.stamp,
        )
    }

    /// What must be so for the share to be the link's.
    fn unmet(&self) -> Vec<String> {
        let mut unmet = self.ordinary.clone();
        // Also NaN.
        if !matches!(self.client_p999_us, p999 if p999 < CLIENT_P999_US) {
            unmet.push(format!(
                "the client's own p99.9 is {:.1} us; allowed: below {CLIENT_P999_US}",
                self.client_p999_us
            ));
        }
        unmet
    }

    fn objections(&self) -> Vec<Objection> {
        let mut objections = Vec::new();
        if self.commanded == 0 {
            objections.push(Objection {
                text: "command state was never reached".into(),
                is_share: false,
            });
        }
        if self.share() > MISSED_SHARE {
            objections.push(Objection {
                text: format!(
                    "{:.4} % of the cycles are attributed to the client; allowed: at most {} %",
                    self.share() * 100.0,
                    MISSED_SHARE * 100.0
                ),
                is_share: true,
            });
        }
        objections
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn judged(missed: u64, p999_us: f64, robot: Value, client: Value) -> Judged {
        let served = json!({"link": {
            "state_cycles": {"monitor": 200, "command": 9800}, "missed": missed,
            "own_lateness": {"cycles": 3, "bound_ms": 0.2, "p999_ms": 0.1, "max_ms": 1.5,
                "stamp": "kernel"},
            "realtime": {"fifo": robot},
        }});
        let answered = json!({"latency": {"p999_us": p999_us}, "realtime": {"fifo": client}});
        Judged::of(&served, &answered).expect("complete")
    }

    #[test]
    fn each_condition_is_named_and_fails_alone() {
        let given = || json!("given");
        let none = || json!({"refused": "not permitted"});
        let unmet = |p999, robot, client| judged(0, p999, robot, client).unmet().join("\n");
        assert_eq!(unmet(999.0, given(), given()), "");
        assert!(unmet(1000.0, given(), given()).contains("p99.9 is 1000.0 us"));
        assert!(unmet(9.0, none(), given()).contains("serve has no SCHED_FIFO"));
        let host = unmet(9.0, given(), none());
        assert!(host.contains("firmware-host has no SCHED_FIFO") && host.contains("permitted"));

        let objections = |missed| judged(missed, 9.0, given(), given()).objections();
        assert!(objections(10).is_empty());
        let [share] = &objections(11)[..] else {
            panic!("one");
        };
        assert!(share.is_share && share.text.starts_with("0.1100 % of the cycles"));
        let silent = Judged {
            commanded: 0,
            ..judged(0, 9.0, none(), none())
        };
        let [objection] = &silent.objections()[..] else {
            panic!("one");
        };
        assert!(!objection.is_share && objection.text.contains("command state"));
    }

    #[test]
    fn a_summary_without_the_row_is_no_pass() {
        assert!(Judged::of(&json!({"link": {}}), &json!({})).is_err());
    }

    #[test]
    fn settings_are_read_and_wrong_ones_named() {
        let read = |text: &str| Setting::read(&text.split_whitespace().collect::<Vec<_>>());
        let setting = Setting {
            seconds: 30.0,
            busy: 2,
            smoke: false,
        };
        assert_eq!(read("--minutes 0.5 --load 2"), Ok(setting));
        let smoke = Setting {
            busy: 1,
            smoke: true,
            ..setting
        };
        assert_eq!(read("--smoke --seconds 30"), Ok(smoke));
        for wrong in [
            "--minutes",
            "--minutes x",
            "--seconds 0",
            "--load -1",
            "--load 65",
            "fast",
            "--load 2 --smoke",
        ] {
            let trouble = read(wrong).expect_err(wrong);
            assert!(
                trouble.exit_code == 2 && trouble.text.contains("allowed"),
                "{wrong}"
            );
        }
    }
}
