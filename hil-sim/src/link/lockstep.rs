//! Robot and client cycle by cycle in virtual time: no clock decides anything, so
//! a run over a socket and one in this process give the same bytes.

use std::io;

use super::channel::{Channel, Delivery};
use super::fault::{Direction, Fault};
use crate::robot::{ControlBox, Robot};
use record::run::Sample;

/// How much of an answer a measurement can expect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// A sound, new measurement: an answer that reflects its counter.
    Answer,
    /// A damaged one: perhaps.
    Perhaps,
    /// One that came before or was overtaken: a client should not answer.
    Nothing,
    /// The client need not answer: it may not be there yet, or has begun nothing.
    First,
    /// One of the last: nobody waits for an answer.
    Farewell,
}

/// A client of a robot with the control box `B`, wherever it runs.
pub trait Peer<B: ControlBox> {
    /// Gives it a measurement of `robot`; its answers go to `answers`, in their order. False
    /// where one was expected and none came, be it damaged or to another measurement:
    /// after [`Expect::Answer`] the client counts as gone.
    ///
    /// # Errors
    /// Those of the transport.
    fn exchange(
        &mut self,
        robot: &mut Robot<B>,
        measurement: &[u8],
        expect: Expect,
        answers: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool>;

    /// What goes beside the datagrams, both ways, where the robot has such a thing.
    ///
    /// # Errors
    /// Those of the transport.
    fn talk(&mut self, _: &mut Robot<B>) -> io::Result<()> {
        Ok(())
    }

    /// Tells the robot what no datagram carries; only a client in this process can.
    fn tell(&self, _: &mut Robot<B>) {}

    /// Whether it has said that it ends the conversation: what it has begun nobody goes on with.
    fn has_left(&self) -> bool {
        false
    }
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

    /// Whether the client stopped answering. From then on nothing is sent to it, until it no longer
    /// drives the arm.
    #[must_use]
    pub fn is_gone(&self) -> bool {
        self.gone
    }

    /// One cycle: its datagrams, then [`Robot::advance`]. What the cycle was, if scenario time
    /// runs.
    ///
    /// # Errors
    /// Those of the client's transport.
    pub fn step<B: ControlBox>(
        &mut self,
        robot: &mut Robot<B>,
        client: &mut (impl Peer<B> + ?Sized),
    ) -> io::Result<Option<Sample>> {
        self.cycle(robot, client)?;
        client.tell(robot);
        Ok(robot.advance())
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
        client.talk(robot)?;
        let mut measurement = B::EMPTY;
        robot.measurement(&mut measurement);
        // What it says may have a reply.
        client.talk(robot)?;
        let mut answers = Vec::new();
        if !robot.has_begun() {
            client.exchange(robot, measurement.as_ref(), Expect::First, &mut answers)?;
            for answer in answers {
                robot.command(&answer, 0.0);
            }
            return Ok(());
        }
        let driven = robot.is_driven();
        self.gone &= driven;
        let (start, t_s) = (robot.robot_time_s(), robot.time_s());
        let end = (robot.cycle() + 1) as f64 * self.cycle_s;
        self.to_client.send(start, t_s, measurement.as_ref());
        while let Some(arrived) = self.to_client.receive(end) {
            if self.gone {
                continue;
            }
            let expect = match self.expect(&arrived) {
                Expect::Answer if !driven => Expect::First,
                expect => expect,
            };
            let answered = client.exchange(robot, &arrived.bytes, expect, &mut answers)?;
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

/// Whether a run is over: the robot's is, or the client has left what it had begun.
pub fn is_over<B: ControlBox>(robot: &Robot<B>, client: &(impl Peer<B> + ?Sized)) -> bool {
    robot.is_over() || (robot.has_begun() && client.has_left())
}

/// The end of a run: what is due goes out, the robot lets answers move it no more and says so, three
/// times. Who has left hears nothing.
///
/// # Errors
/// Those of the client's transport.
pub fn finish<B: ControlBox>(
    robot: &mut Robot<B>,
    client: &mut (impl Peer<B> + ?Sized),
) -> io::Result<()> {
    if client.has_left() {
        return Ok(());
    }
    client.talk(robot)?;
    robot.leave();
    let mut measurement = B::EMPTY;
    for _ in 0..3 {
        robot.measurement(&mut measurement);
        let mut none = Vec::new();
        client.exchange(robot, measurement.as_ref(), Expect::Farewell, &mut none)?;
    }
    Ok(())
}
