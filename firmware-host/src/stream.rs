//! References that arrive over UDP, for a planner in another process.
//!
//! One datagram is one reference, as text: for each level in priority order nine
//! numbers, x y z \[m\], their velocities \[m/s\] and accelerations \[m/s2\], base-plate
//! frame, separated by spaces or commas. Levels may be left out at the end: then
//! they keep their last reference.
//!
//! The references go through a bounded queue; of those that wait the newest
//! counts. After [`Stream::timeout`] without one the arm is held, and joins again
//! without a jump when the stream goes on.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use bridge::guide::ReferenceSource;
use controller_core::joint::Vector3;
use controller_core::measurement::Reference;
use hil_sim::terminal::tell;

/// References that wait for the loop.
const QUEUE: usize = 64;

/// Farthest position \[m\], fastest velocity \[m/s\], largest acceleration
/// \[m/s2\] that is taken for a reference.
const RANGES: [f64; 3] = [3.0, 5.0, 100.0];

/// Most levels times nine numbers.
const NUMBERS_MAX: usize = 9 * controller_core::task::MAX_LEVELS;

/// One reference, level by level: x, dx, ddx.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    numbers: [f64; NUMBERS_MAX],
    count: usize,
}

impl Setpoint {
    /// Reads a datagram.
    ///
    /// # Errors
    /// What is wrong with it, in one line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut setpoint = Self {
            numbers: [0.0; NUMBERS_MAX],
            count: 0,
        };
        let words = text.split([' ', ',', '\t', '\n', '\r']);
        for word in words.filter(|word| !word.is_empty()) {
            let Ok(number) = word.parse::<f64>() else {
                return Err(format!("'{word}'; allowed: a number"));
            };
            let Some(entry) = setpoint.numbers.get_mut(setpoint.count) else {
                return Err(format!("more than {NUMBERS_MAX} numbers"));
            };
            let kind = setpoint.count % 9 / 3;
            let limit = RANGES.get(kind).copied().unwrap_or(0.0);
            if !(-limit..=limit).contains(&number) {
                let position = setpoint.count + 1;
                return Err(format!(
                    "number {position}: {number}; allowed: -{limit} to {limit}"
                ));
            }
            *entry = number;
            setpoint.count += 1;
        }
        if setpoint.count == 0 || !setpoint.count.is_multiple_of(9) {
            return Err(format!(
                "{} numbers; allowed: 9 for each level, x y z, velocity, acceleration",
                setpoint.count
            ));
        }
        Ok(setpoint)
    }
}

/// The loop's end of the stream.
#[derive(Debug)]
pub struct Stream {
    queue: Receiver<Setpoint>,
    current: Reference<f64>,
    arrived: Option<Instant>,
    timeout: Duration,
    refused: Arc<AtomicU64>,
}

impl Stream {
    /// Listens at `address`; after `timeout` without a reference the arm is held.
    ///
    /// # Errors
    /// The address cannot be bound.
    pub fn listen(address: SocketAddr, timeout: Duration) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        let (sender, queue) = sync_channel(QUEUE);
        let refused = Arc::new(AtomicU64::new(0));
        let counter = Arc::clone(&refused);
        std::thread::Builder::new()
            .name("references".into())
            .spawn(move || receive(&socket, &sender, &counter))?;
        Ok(Self {
            queue,
            current: Reference::new(),
            arrived: None,
            timeout,
            refused,
        })
    }

    /// A stream that is fed by a channel of this process.
    #[must_use]
    pub fn from_channel(queue: Receiver<Setpoint>, timeout: Duration) -> Self {
        Self {
            queue,
            current: Reference::new(),
            arrived: None,
            timeout,
            refused: Arc::default(),
        }
    }

    /// After how long without a reference the arm is held.
    #[must_use]
    pub fn timeout(&self) -> Duration {
        self.timeout
    }

    /// Datagrams that were no reference, or found the queue full.
    #[must_use]
    pub fn refused(&self) -> u64 {
        self.refused.load(Ordering::Relaxed)
    }

    fn take(&mut self, setpoint: &Setpoint) {
        let levels = setpoint.numbers.chunks_exact(9).take(setpoint.count / 9);
        for (task, numbers) in self.current.tasks.iter_mut().zip(levels) {
            let vector =
                |from: usize| Vector3::from_iterator(numbers.iter().copied().skip(from).take(3));
            (task.x, task.dx, task.ddx) = (vector(0), vector(3), vector(6));
        }
    }
}

impl ReferenceSource for Stream {
    fn start(&mut self, origin: &Reference<f64>) {
        self.current.clone_from(origin);
        self.arrived = None;
    }

    fn sample(&mut self, _: f64) -> Option<Reference<f64>> {
        while let Ok(setpoint) = self.queue.try_recv() {
            self.take(&setpoint);
            self.arrived = Some(Instant::now());
        }
        let fresh = self.arrived.is_some_and(|at| at.elapsed() <= self.timeout);
        fresh.then(|| self.current.clone())
    }
}

fn receive(socket: &UdpSocket, queue: &SyncSender<Setpoint>, refused: &AtomicU64) {
    let mut bytes = [0; 2048];
    let mut said = false;
    loop {
        let Ok((length, from)) = socket.recv_from(&mut bytes) else {
            return;
        };
        let text = bytes
            .get(..length)
            .and_then(|bytes| std::str::from_utf8(bytes).ok());
        let setpoint = text
            .ok_or_else(|| "not text".to_string())
            .and_then(Setpoint::parse);
        match setpoint {
            Ok(setpoint) if queue.try_send(setpoint).is_ok() => {}
            Ok(_) => {
                refused.fetch_add(1, Ordering::Relaxed);
            }
            Err(error) => {
                refused.fetch_add(1, Ordering::Relaxed);
                // Once: a stream that is wrong is wrong a thousand times a second.
                if !said {
                    tell(format_args!("note: reference from {from}: {error}"));
                    said = true;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::task::TaskReference;

    fn origin() -> Reference<f64> {
        let rest = TaskReference::rest(Vector3::new(0.1, 0.2, 0.3));
        Reference {
            tasks: [rest, rest].into_iter().collect(),
            ..Reference::new()
        }
    }

    #[test]
    fn datagrams_are_read_or_say_what_is_wrong() {
        let good = Setpoint::parse("0.5 0 0.4, 0.1 0 0, 0 0 -1\n").expect("nine numbers");
        assert_eq!(good.count, 9);
        for (text, part) in [
            ("", "0 numbers"),
            ("1 2", "2 numbers"),
            ("a 0 0 0 0 0 0 0 0", "'a'"),
            ("NaN 0 0 0 0 0 0 0 0", "number 1: NaN"),
            ("4 0 0 0 0 0 0 0 0", "number 1: 4"),
            ("0 0 0 0 0 inf 0 0 0", "number 6: inf"),
        ] {
            let error = Setpoint::parse(text).expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
        assert!(Setpoint::parse(&"0 ".repeat(72)).is_err());
    }

    #[test]
    fn the_newest_counts_and_silence_holds() {
        let (sender, queue) = sync_channel(8);
        let mut stream = Stream::from_channel(queue, Duration::from_millis(50));
        stream.start(&origin());
        assert!(stream.sample(0.0).is_none(), "nothing has arrived");
        for x in ["0.4", "0.5"] {
            let text = format!("{x} 0 0 0 0 0 0 0 0");
            sender
                .send(Setpoint::parse(&text).expect("good"))
                .expect("room");
        }
        let sampled = stream.sample(0.0).expect("fresh");
        assert_eq!(sampled.tasks[0].x.x, 0.5);
        assert_eq!(sampled.tasks[1], origin().tasks[1], "left out: kept");
        std::thread::sleep(Duration::from_millis(60));
        assert!(stream.sample(0.0).is_none(), "too old");
    }
}
