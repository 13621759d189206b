//! Can this PC hold the cycle? Measured, with advice.

use std::net::UdpSocket;
use std::thread;
use std::time::{Duration, Instant};

use cell::names::{Named as _, RobotInterface};
use cell::realtime::{Grant, Realtime};
use cell::timing::{TimeFigures, Times};
use fri::{Command, Measurement};

/// Datagrams of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Its name.
    pub robot: &'static str,
    /// Its cycle \[s\].
    pub cycle_s: f64,
    /// Bytes of a measurement, and of the answer.
    pub bytes: [usize; 2],
    /// What else helps.
    advice: &'static str,
}

impl Link {
    /// That of a robot.
    #[must_use]
    pub fn of(robot: RobotInterface) -> Self {
        let (cycle_s, bytes, advice) = match robot {
            RobotInterface::Lwr => (
                0.002,
                [Measurement::LEN, Command::LEN],
                "or choose a longer cycle: friOpen(4) is 4 ms",
            ),
            RobotInterface::Fci => (
                0.001,
                [fci::Version::V10.state_len(), fci::command::LEN_MAX],
                "the cycle of a Franka robot is always 1 ms: a direct cable, no switch between",
            ),
        };
        Self {
            robot: robot.name(),
            cycle_s,
            bytes,
            advice,
        }
    }
}

/// Bytes of the longest datagram.
const ROOM: usize = 2048;

/// How long each test takes.
const TEST: Duration = Duration::from_secs(2);

/// What was found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// What the system gives.
    pub realtime: Realtime,
    /// How late a sleeping thread wakes.
    pub wake: TimeFigures,
    /// There and back over UDP on this PC.
    pub loopback: TimeFigures,
    /// The cycle that was asked about \[s\].
    pub cycle_s: f64,
    /// What was sent.
    pub link: Link,
}

/// Runs the tests: about 4 s.
///
/// # Errors
/// No UDP on this PC.
pub fn examine(link: &Link, cycle_s: f64, cpu: Option<usize>) -> std::io::Result<Findings> {
    // For the calling thread, which does the tests: as the control loop.
    let realtime = Realtime::ask(cpu);
    Ok(Findings {
        realtime,
        wake: wake_up(cycle_s),
        loopback: loopback(link.bytes, cycle_s)?,
        cycle_s,
        link: *link,
    })
}

/// Sleeps from cycle to cycle and measures how late it wakes.
fn wake_up(cycle_s: f64) -> TimeFigures {
    let cycle = Duration::from_secs_f64(cycle_s);
    let mut late = Times::new();
    let start = Instant::now();
    let mut next = start + cycle;
    while next < start + TEST {
        thread::sleep(next.saturating_duration_since(Instant::now()));
        late.add(next.elapsed());
        next += cycle;
    }
    late.figures()
}

/// Sends a datagram of a measurement's size and waits for it to come back from
/// another thread.
fn loopback([there_len, back_len]: [usize; 2], cycle_s: f64) -> std::io::Result<TimeFigures> {
    let here = UdpSocket::bind("127.0.0.1:0")?;
    let there = UdpSocket::bind("127.0.0.1:0")?;
    here.connect(there.local_addr()?)?;
    there.connect(here.local_addr()?)?;
    here.set_read_timeout(Some(Duration::from_millis(100)))?;
    there.set_read_timeout(Some(Duration::from_millis(200)))?;
    let echo = thread::spawn(move || {
        let mut bytes = [0; ROOM];
        while let Ok(length) = there.recv(&mut bytes) {
            if there
                .send(bytes.get(..length.min(back_len)).unwrap_or(&bytes))
                .is_err()
            {
                break;
            }
        }
    });
    let mut times = Times::new();
    let (mut bytes, start) = ([0; ROOM], Instant::now());
    while start.elapsed() < TEST {
        let sent = Instant::now();
        here.send(bytes.get(..there_len).unwrap_or(&bytes))?;
        // One that does not come back took at least as long as was waited for it.
        let _ = here.recv(&mut bytes);
        times.add(sent.elapsed());
        thread::sleep(Duration::from_secs_f64(cycle_s));
    }
    // Silence ends the echo.
    drop(here);
    let _ = echo.join();
    Ok(times.figures())
}

impl Findings {
    /// Whether a late wake-up and a loop over the network fit into half a cycle in
    /// 999 of 1000 cases.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.wake.p999_us + self.loopback.p999_us < self.cycle_s * 0.5e6
    }

    /// The report.
    #[must_use]
    pub fn report(&self) -> String {
        let mut text = format!(
            "scheduling   SCHED_FIFO {}\n\
             memory       locked {}\n\
             processor    own {}\n\
             wake-up      late by {}\n\
             loopback     {}\n\n",
            self.realtime.fifo, self.realtime.memory, self.realtime.cpu, self.wake, self.loopback
        );
        let cycle_ms = self.cycle_s * 1e3;
        text += &if self.holds() {
            format!(
                "Holds a cycle of {cycle_ms} ms: wake-up and loopback take less than half of it in 999 of \
                 1000 cycles.\n"
            )
        } else {
            format!(
                "Does not hold a cycle of {cycle_ms} ms: wake-up and loopback take more than half of it \
                 more often than once in 1000 cycles.\n"
            )
        };
        for advice in self.advice() {
            text += &format!("- {advice}\n");
        }
        text
    }

    fn advice(&self) -> Vec<&'static str> {
        let mut advice = Vec::new();
        if self.realtime.fifo != Grant::Given {
            advice.push(
                "without SCHED_FIFO any other program can delay an answer: fine for a simulated \
                 robot, not for a real one",
            );
        }
        if !self.holds() {
            advice.push(
                "a kernel with PREEMPT_RT, the processor governor `performance` and an idle PC \
                 make wake-ups shorter",
            );
            advice.push(self.link.advice);
        }
        if self.realtime.cpu == Grant::NotAsked {
            advice.push("`--cpu N` keeps the loop on one processor; isolate it with isolcpus=N");
        }
        advice
    }
}
