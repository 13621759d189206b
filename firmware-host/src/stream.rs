//! References that arrive over UDP, for a planner in another process.
//!
//! One datagram is one reference, as text: numbers separated by spaces or commas, for
//! each level in the order of the scenario
//!
//! - of a position nine: x y z \[m\], velocity \[m/s\], acceleration \[m/s2\];
//! - of an orientation ten: a quaternion w x y z, angular velocity \[rad/s\], angular
//!   acceleration \[rad/s2\],
//!
//! in base-plate axes. Levels may be left out at the end: then they keep their last
//! reference. Any other count of numbers, or a number out of range, and the datagram is
//! refused as a whole.
//!
//! A datagram that begins with a letter is a [change](crate::changes) of tasks or gains.
//!
//! One sender is obeyed: the one that is named, or else the first whose datagram is a
//! reference. Those of others are counted and have no effect.
//!
//! The references go through a bounded queue; of those that wait the newest
//! counts. After [`Stream::timeout`] without one the arm is held, and joins again
//! without a jump when the stream goes on.

mod setpoint;

use std::fmt;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use crate::changes::Lines;
use bridge::source::ReferenceSource;
use cell::scenario::EquippedArm;
use cell::terminal::tell;
use controller_core::joint::DOF;
use controller_core::{Reference, TaskSet};
use serde::Serialize;

pub use setpoint::Setpoint;

/// References that wait for the loop.
const QUEUE: usize = 64;

/// Longer than any UDP datagram: none is cut off within a number.
const LONGEST: usize = 1 << 16;

/// What became of the datagrams of a stream.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StreamFigures {
    /// Who is obeyed.
    pub sender: Option<SocketAddr>,
    /// References that were taken.
    pub taken: u64,
    /// Datagrams that are no reference.
    pub unusable: u64,
    /// Datagrams of other senders.
    pub strangers: u64,
    /// References that found the queue full.
    pub crowded_out: u64,
}

impl fmt::Display for StreamFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} taken", self.taken)?;
        if let Some(sender) = self.sender {
            write!(f, " from {sender}")?;
        }
        write!(
            f,
            "; refused: {} unusable, {} of other senders, {} too many at once",
            self.unusable, self.strangers, self.crowded_out
        )
    }
}

/// The same while they are counted, in the thread that receives.
#[derive(Debug, Default)]
struct Tally {
    sender: OnceLock<SocketAddr>,
    taken: AtomicU64,
    unusable: AtomicU64,
    strangers: AtomicU64,
    crowded_out: AtomicU64,
}

/// The loop's end of the stream.
#[derive(Debug)]
pub struct Stream {
    queue: Receiver<Setpoint>,
    current: Reference<f64>,
    /// Whether the motion was asked for since it started.
    begun: bool,
    arrived: Option<Instant>,
    timeout: Duration,
    tally: Arc<Tally>,
}

impl Stream {
    /// Listens at `address` for references of levels of `arm` that have these `tasks`, from the
    /// address `from` alone or, without one, from the first that sends one; after
    /// `timeout` without one the arm is held. `changes` takes those of tasks.
    ///
    /// # Errors
    /// The address cannot be bound.
    pub fn listen(
        address: SocketAddr,
        from: Option<SocketAddr>,
        tasks: &TaskSet,
        arm: &EquippedArm,
        timeout: Duration,
        changes: Option<Lines>,
    ) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        let (sender, queue) = sync_channel(QUEUE);
        let stream = Self::from_channel(queue, timeout);
        let (tally, tasks, arm) = (Arc::clone(&stream.tally), *tasks, arm.clone());
        if let Some(from) = from {
            tally.sender.get_or_init(|| from);
        }
        std::thread::Builder::new()
            .name("references".into())
            .spawn(move || receive(&socket, (&tasks, &arm), &sender, &tally, changes.as_ref()))?;
        Ok(stream)
    }

    /// A stream that is fed by a channel of this process.
    #[must_use]
    pub fn from_channel(queue: Receiver<Setpoint>, timeout: Duration) -> Self {
        Self {
            queue,
            current: Reference::hold(0, [0.0; DOF]),
            begun: false,
            arrived: None,
            timeout,
            tally: Arc::default(),
        }
    }

    /// After how long without a reference the arm is held.
    #[must_use]
    pub fn timeout(&self) -> Duration {
        self.timeout
    }

    /// What has come so far.
    #[must_use]
    pub fn figures(&self) -> StreamFigures {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        StreamFigures {
            sender: self.tally.sender.get().copied(),
            taken: count(&self.tally.taken),
            unusable: count(&self.tally.unusable),
            strangers: count(&self.tally.strangers),
            crowded_out: count(&self.tally.crowded_out),
        }
    }

    fn take(&mut self, setpoint: &Setpoint) {
        let levels = self.current.targets_mut().iter_mut();
        for (level, target) in levels.zip(setpoint.targets()) {
            *level = *target;
        }
    }
}

impl ReferenceSource for Stream {
    fn start(&mut self, origin: &Reference<f64>) {
        self.current.clone_from(origin);
        self.begun = false;
        self.arrived = None;
    }

    fn sample(&mut self, _: f64) -> Option<Reference<f64>> {
        if !std::mem::replace(&mut self.begun, true) {
            // At time 0 a motion is followed at once, as one that starts where the arm is. A
            // stream may be anywhere: with nothing to follow yet it is joined. What waits is
            // from before.
            while self.queue.try_recv().is_ok() {}
            return None;
        }
        while let Ok(setpoint) = self.queue.try_recv() {
            self.take(&setpoint);
            self.arrived = Some(Instant::now());
        }
        let fresh = self.arrived.is_some_and(|at| at.elapsed() <= self.timeout);
        fresh.then(|| self.current.clone())
    }
}

fn receive(
    socket: &UdpSocket,
    (tasks, arm): (&TaskSet, &EquippedArm),
    queue: &SyncSender<Setpoint>,
    tally: &Tally,
    changes: Option<&Lines>,
) {
    let mut bytes = vec![0; LONGEST];
    let count = |counter: &AtomicU64| counter.fetch_add(1, Ordering::Relaxed);
    // Once of a kind: a stream that is wrong is wrong a thousand times a second.
    let note = |before: u64, text: &dyn fmt::Display| {
        if before == 0 {
            tell(format_args!("note: reference from {text}"));
        }
    };
    loop {
        let Ok((length, from)) = socket.recv_from(&mut bytes) else {
            return;
        };
        if let Some(sender) = tally.sender.get().filter(|sender| **sender != from) {
            let before = count(&tally.strangers);
            note(before, &format_args!("{from} refused; allowed: {sender}"));
            continue;
        }
        let text = bytes
            .get(..length)
            .and_then(|bytes| std::str::from_utf8(bytes).ok());
        if let (Some(changes), Some(line)) = (changes, text.filter(|text| Lines::is_change(text))) {
            match changes.send(line) {
                Ok(()) => {
                    tally.sender.get_or_init(|| from);
                }
                Err(error) => note(count(&tally.unusable), &format_args!("{from}: {error}")),
            }
            continue;
        }
        let setpoint = text
            .ok_or_else(|| "not text".to_string())
            .and_then(|text| Setpoint::parse(text, tasks, arm));
        match setpoint {
            Ok(setpoint) => {
                tally.sender.get_or_init(|| from);
                match queue.try_send(setpoint) {
                    Ok(()) => count(&tally.taken),
                    Err(_) => count(&tally.crowded_out),
                };
            }
            Err(error) => note(count(&tally.unusable), &format_args!("{from}: {error}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::setpoint::tests::three;
    use super::*;
    use controller_core::Target;
    use controller_core::joint::Vector3;

    fn origin() -> Reference<f64> {
        Reference::new(
            [
                Target::position([0.1, 0.2, 0.3]),
                Target::orientation([0.8, 0.6, 0.0, 0.0]),
                Target::position([0.0, 0.0, 0.7]),
            ],
            [0.0; DOF],
        )
    }

    #[test]
    fn the_newest_counts_and_silence_holds() {
        let arm = EquippedArm::of(&arms::LWR_IV);
        let (sender, queue) = sync_channel(8);
        let mut stream = Stream::from_channel(queue, Duration::from_millis(50));
        stream.start(&origin());
        let send = |x: &str| {
            let text = format!("{x} {} 0 0 0 -2 0 0 3 0 0 0", "0 ".repeat(8));
            let setpoint = Setpoint::parse(&text, &three(), &arm).expect("good");
            sender.send(setpoint).expect("room");
        };
        send("0.3");
        assert!(stream.sample(0.0).is_none(), "from before the motion");
        assert!(stream.sample(0.0).is_none(), "nothing has arrived");
        send("0.4");
        send("0.5");
        let sampled = stream.sample(0.0).expect("fresh");
        let [flange, link, height] = sampled.targets() else {
            panic!("three levels");
        };
        assert_eq!(*flange, Target::position([0.5, 0.0, 0.0]));
        let turning = Target::Orientation {
            q: [0.0, 0.0, 0.0, -1.0].into(),
            w: [0.0, 0.0, 3.0].into(),
            dw: Vector3::zeros(),
        };
        assert_eq!(*link, turning);
        assert_eq!(*height, origin().targets()[2], "left out: kept");
        std::thread::sleep(Duration::from_millis(60));
        assert!(stream.sample(0.0).is_none(), "too old");
    }
}
