//! What carries the datagrams to the client and back.

use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use crate::link::{Expect, Peer};
use crate::robot::{ControlBox, Robot, Stamp};

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

/// A datagram that was waited for by the clock.
#[derive(Debug)]
pub struct Arrival<'a> {
    /// Its bytes.
    pub datagram: &'a [u8],
    /// How long it lay on this PC before it was read, by the transport's [`Stamp`].
    pub waited: Duration,
}

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
    /// may be noticed that much late as well; [`Arrival::waited`] says how much.
    ///
    /// # Errors
    /// Anything but silence.
    fn receive_on_time(&mut self, deadline: Instant) -> io::Result<Option<Arrival<'_>>>;

    /// Who says when a datagram has arrived.
    fn stamp(&self) -> Stamp {
        Stamp::Program
    }

    /// The clock of its deadlines.
    fn now(&self) -> Instant {
        Instant::now()
    }
}

/// Whether nothing came or went, but nothing is wrong.
pub(super) fn silence(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

impl<B: ControlBox, T: Transport + ?Sized> Peer<B> for T {
    fn exchange(
        &mut self,
        _: &mut Robot<B>,
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
        let mut deadline = Instant::now() + patience;
        while let Some(answer) = self.receive(deadline)? {
            answers.push(answer.to_vec());
            if expect != Expect::Nothing && B::answers(measurement, answer) {
                return Ok(true);
            }
            // It has answered, if not to this: outdated or damaged. The right one may follow.
            deadline = deadline.min(Instant::now() + PERHAPS);
            // Datagrams without end are no answer either.
            if Instant::now() >= deadline {
                break;
            }
        }
        Ok(!answers.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::PlantOptions;
    use crate::robot::{LwrBox, LwrRobot, RobotOptions, RobotSetup};
    use cell::names::PlantKind;
    use cell::scenario::Scenario;

    /// Answers with these datagrams, then never.
    struct Script(Vec<Vec<u8>>, Vec<u8>);

    impl Transport for Script {
        fn send(&mut self, _: &[u8]) -> io::Result<()> {
            Ok(())
        }

        fn receive(&mut self, deadline: Instant) -> io::Result<Option<&[u8]>> {
            if self.0.is_empty() {
                std::thread::sleep(deadline.saturating_duration_since(Instant::now()));
                return Ok(None);
            }
            self.1 = self.0.remove(0);
            Ok(Some(&self.1))
        }

        fn receive_on_time(&mut self, _: Instant) -> io::Result<Option<Arrival<'_>>> {
            unreachable!("lock-step has no clock")
        }
    }

    #[test]
    fn a_wrong_answer_ends_the_cycle_soon_and_a_client_that_gives_none_is_gone() {
        // Nothing is asked of it.
        let mut robot = LwrRobot::new(RobotSetup {
            scenario: Scenario::find("two-level").expect("built in"),
            plant: PlantKind::Ideal,
            contacts: false,
            seed: 1,
            plant_options: PlantOptions::default(),
            options: RobotOptions::default(),
        });
        let (wrong, right) = (vec![9, 0, 8, 0], vec![9, 0, 7, 0]);
        for (script, there, soon) in [
            (vec![], false, false),
            (vec![wrong.clone()], true, true),
            (vec![wrong, right.clone()], true, true),
            (vec![right], true, true),
        ] {
            let (count, begun, mut answers) = (script.len(), Instant::now(), Vec::new());
            let mut client = Script(script, Vec::new());
            let peer: &mut dyn Peer<LwrBox> = &mut client;
            let measurement = [7, 0, 0, 0];
            let answered = peer.exchange(&mut robot, &measurement, Expect::Answer, &mut answers);
            assert_eq!(answered.expect("no socket"), there);
            assert_eq!(answers.len(), count);
            assert_eq!(begun.elapsed() < PATIENCE / 2, soon);
        }
    }
}
