//! What carries the datagrams to the client and back.

use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use crate::link::{Expect, Peer};

/// How long a client may take to answer in lock-step before it counts as gone.
pub const PATIENCE: Duration = Duration::from_secs(2);

/// Between first measurements while nobody answers.
pub const RESEND: Duration = Duration::from_millis(50);

/// How long answers to damaged measurements are waited for.
const PERHAPS: Duration = Duration::from_millis(50);

/// How long answers that should not come are waited for.
pub(super) const NOTHING: Duration = Duration::from_millis(5);

/// Between looks at the transport where time counts.
pub(super) const POLL: Duration = Duration::from_micros(50);

/// A way to one client.
pub trait Transport {
    /// Sends a datagram; that nobody is there is no error.
    ///
    /// # Errors
    /// Anything else.
    fn send(&mut self, datagram: &[u8]) -> io::Result<()>;

    /// The next datagram until `deadline`, if one comes.
    ///
    /// # Errors
    /// Anything but silence.
    fn receive(&mut self, deadline: Instant) -> io::Result<Option<&[u8]>>;

    /// As [`Transport::receive`], ends at `deadline` to a tenth of a millisecond: the
    /// system's own timeouts are whole ticks of several milliseconds. The datagram
    /// may be noticed that much late as well.
    ///
    /// # Errors
    /// Anything but silence.
    fn receive_on_time(&mut self, deadline: Instant) -> io::Result<Option<&[u8]>>;
}

/// Whether nothing came or went, but nothing is wrong.
pub(super) fn silence(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

impl<T: Transport + ?Sized> Peer for T {
    fn exchange(
        &mut self,
        measurement: &[u8],
        expect: Expect,
        answers: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool> {
        self.send(measurement)?;
        let patience = match expect {
            Expect::Answer => PATIENCE,
            Expect::First => RESEND,
            Expect::Perhaps => PERHAPS,
            Expect::Nothing => NOTHING,
            Expect::Farewell => return Ok(true),
        };
        let deadline = Instant::now() + patience;
        let counter = measurement.get(..2);
        while let Some(answer) = self.receive(deadline)? {
            answers.push(answer.to_vec());
            if expect != Expect::Nothing && answer.get(2..4) == counter {
                return Ok(true);
            }
            // Datagrams without end are no answer either.
            if Instant::now() >= deadline {
                break;
            }
        }
        Ok(false)
    }
}
