//! Robot and client cycle by cycle in virtual time: no clock decides anything, so
//! a run over a socket and one in this process give the same bytes.

use std::io;

use super::channel::{Channel, Delivery};
use super::fault::{Direction, Fault};
use crate::robot::{ControlBox, Robot};

/// How much of an answer a measurement can expect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// A sound, new measurement: an answer that reflects its counter.
    Answer,
    /// A damaged one: perhaps.
    Perhaps,
    /// One that came before or was overtaken: a client should not answer.
    Nothing,
    /// The first of all: the client may not be there yet.
    First,
    /// One of the last: nobody waits for an answer.
    Farewell,
}

/// A client of a robot with the control box `B`, wherever it runs.
pub trait Peer<B> {
    /// Gives it a measurement; its answers go to `answers`, in their order. False
    /// where one was expected and none came, be it damaged or to another measurement:
    /// after [`Expect::Answer`] the client counts as gone.
    ///
    /// # Errors
    /// Those of the transport.
    fn exchange(
        &mut self,
        measurement: &[u8],
        expect: Expect,
        answers: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool>;
}

/// The link between one robot and one client.
pub struct LockStep {
    to_client: Channel,
    to_robot: Channel,
    cycle_s: f64,
    /// Number of the newest measurement that arrived.
    newest: Option<u64>,
    gone: bool,
}

impl LockStep {
    /// A link with `faults`, whose random numbers are those of `seed`.
    #[must_use]
    pub fn new(faults: &[Fault], cycle_s: f64, seed: u64) -> Self {
        Self {
            to_client: Channel::new(Direction::ToClient, faults, cycle_s, seed),
            to_robot: Channel::new(Direction::ToRobot, faults, cycle_s, seed),
            cycle_s,
            newest: None,
            gone: false,
        }
    }

    /// Whether the client stopped answering. From then on nothing is sent to it.
    #[must_use]
    pub fn is_gone(&self) -> bool {
        self.gone
    }

    /// The datagrams of one cycle, up to the moment when [`Robot::advance`] is due.
    /// Before the first answer the link is sound and [`Robot::advance`] does nothing:
    /// call it again until [`Robot::has_begun`].
    ///
    /// # Errors
    /// Those of the client's transport.
    pub fn cycle<B: ControlBox>(
        &mut self,
        robot: &mut Robot<B>,
        client: &mut (impl Peer<B> + ?Sized),
    ) -> io::Result<()> {
        let mut measurement = B::EMPTY;
        robot.measurement(&mut measurement);
        let mut answers = Vec::new();
        if !robot.has_begun() {
            client.exchange(measurement.as_ref(), Expect::First, &mut answers)?;
            for answer in answers {
                robot.command(&answer, 0.0);
            }
            return Ok(());
        }
        let (start, t_s) = (robot.robot_time_s(), robot.time_s());
        let end = (robot.cycle() + 1) as f64 * self.cycle_s;
        self.to_client.send(start, t_s, measurement.as_ref());
        while let Some(arrived) = self.to_client.receive(end) {
            if self.gone {
                continue;
            }
            let expect = self.expect(&arrived);
            let answered = client.exchange(&arrived.bytes, expect, &mut answers)?;
            self.gone |= expect == Expect::Answer && !answered;
            for answer in answers.drain(..) {
                self.to_robot.send(arrived.time_s, t_s, &answer);
            }
        }
        while let Some(arrived) = self.to_robot.receive(end) {
            robot.command(&arrived.bytes, (arrived.time_s - start).max(0.0));
        }
        Ok(())
    }

    /// The end: the robot lets answers move it no more and says so, three times.
    ///
    /// # Errors
    /// Those of the client's transport.
    pub fn finish<B: ControlBox>(
        &mut self,
        robot: &mut Robot<B>,
        client: &mut (impl Peer<B> + ?Sized),
    ) -> io::Result<()> {
        robot.leave();
        let mut measurement = B::EMPTY;
        for _ in 0..3 {
            robot.measurement(&mut measurement);
            client.exchange(measurement.as_ref(), Expect::Farewell, &mut Vec::new())?;
        }
        Ok(())
    }

    fn expect(&mut self, arrived: &Delivery) -> Expect {
        let fresh = self.newest.is_none_or(|newest| arrived.number > newest);
        if fresh {
            self.newest = Some(arrived.number);
        }
        match (fresh, arrived.damaged) {
            (false, _) => Expect::Nothing,
            (true, true) => Expect::Perhaps,
            (true, false) => Expect::Answer,
        }
    }
}
