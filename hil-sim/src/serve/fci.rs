//! Serving Franka's FCI: a stream for requests, datagrams for states and commands, to one client
//! after the other.
//!
//! Before the first command of a motion states go out by the wall clock, in virtual time as well: a
//! client rightly reads on without an answer. From then on virtual time waits for every command, in the
//! same loop as for every robot ([`LockStep`]), and by the wall clock the schedule is absolute: a
//! command counts when it is here before the next state leaves, so that the robot's own lateness is
//! not the client's.

mod sockets;

use std::io;
use std::net::SocketAddr;
use std::thread::sleep;
use std::time::Instant as Clock;

use super::console::Operator;
use super::service::End;
use super::transport::POLL;
use crate::link::{Channel, Direction, Fault, LockStep, finish, is_over};
use crate::robot::{ControlBox as _, FciBox, FciRobot, Stamp};
use cell::invalid::Invalid;
use record::run::Sample;

use sockets::{CYCLE, Sockets};

/// Cycle of the interface \[s\].
const CYCLE_S: f64 = 1e-3;

/// How a robot with the FCI is served.
#[derive(Clone, Debug)]
pub struct FciService {
    /// Where it listens.
    pub address: SocketAddr,
    /// Virtual time instead of the wall clock.
    pub lockstep: bool,
    /// What happens to datagrams.
    pub faults: Vec<Fault>,
    /// How long to wait for a first command \[s\].
    pub wait_s: f64,
}

/// Both directions of the link by the wall clock.
struct Paced {
    to_client: Channel,
    to_robot: Channel,
    /// When the next state is due.
    due: Clock,
}

/// Whose time decides.
enum Pace {
    Virtual(LockStep),
    Wall(Paced),
}

impl FciService {
    /// Listens at its address.
    ///
    /// # Errors
    /// The address is not one of this PC, or taken.
    pub fn open(&self) -> Result<FciSockets, Invalid> {
        Sockets::open(self.address).map(FciSockets)
    }

    /// Serves `robot` until its scenario is over and the client has ended its motion. Every cycle of
    /// scenario time goes to `sink`.
    ///
    /// # Errors
    /// The sockets', and those of `sink`.
    pub fn run(
        &self,
        robot: &mut FciRobot,
        operator: &mut Operator,
        sockets: FciSockets,
        mut sink: impl FnMut(&Sample) -> io::Result<()>,
    ) -> io::Result<End> {
        let seed = robot.setup().seed;
        let mut sockets = sockets.0;
        let begun = Clock::now();
        let mut pace = if self.lockstep {
            Pace::Virtual(LockStep::new(&self.faults, CYCLE_S, seed))
        } else {
            robot.keep_time(Stamp::Program);
            let channel = |direction| Channel::new(direction, &self.faults, CYCLE_S, seed);
            Pace::Wall(Paced {
                to_client: channel(Direction::ToClient),
                to_robot: channel(Direction::ToRobot),
                due: begun,
            })
        };
        while !is_over(robot, &sockets) {
            operator.attend(robot);
            if !robot.has_begun() && begun.elapsed().as_secs_f64() > self.wait_s {
                return Ok(End::NoClient(self.nobody(&sockets)));
            }
            let sample = match &mut pace {
                Pace::Virtual(link) => link.step(robot, &mut sockets)?,
                Pace::Wall(paced) => {
                    paced.cycle(robot, &mut sockets)?;
                    robot.advance()
                }
            };
            if let Some(sample) = sample {
                sink(&sample)?;
            }
        }
        finish(robot, &mut sockets)?;
        Ok(End::Finished)
    }

    /// Why nobody was served.
    fn nobody(&self, sockets: &Sockets) -> String {
        let Self {
            address, wait_s, ..
        } = self;
        match sockets.last() {
            None => format!("nobody connected to {address} within {wait_s} s"),
            Some(client) => format!("no command of a motion from {client} within {wait_s} s"),
        }
    }
}

/// Sockets that listen.
pub struct FciSockets(Sockets);

impl FciSockets {
    /// Where.
    ///
    /// # Errors
    /// The system's.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.0.address()
    }
}

impl Paced {
    /// A cycle, once it is due: the state, then what comes until the next one is.
    fn cycle(&mut self, robot: &mut FciRobot, sockets: &mut Sockets) -> io::Result<()> {
        sockets.talk(robot)?;
        let now = Clock::now();
        // Who slept for more than a cycle begins the schedule anew.
        let due = if now > self.due + CYCLE {
            now
        } else {
            self.due
        };
        self.due = due + CYCLE;
        while Clock::now() < due {
            sleep(POLL.min(due.saturating_duration_since(Clock::now())));
        }
        // Nobody is there: the arm rests.
        if robot.control().client().is_none() {
            return Ok(());
        }
        let (start, t_s) = (robot.robot_time_s(), robot.time_s());
        let sound = !robot.has_begun();
        let mut state = FciBox::EMPTY;
        robot.measurement(&mut state);
        // A reflex has a reply.
        sockets.talk(robot)?;
        if sound {
            sockets.send(robot, state.as_ref())?;
        } else {
            self.to_client.send(start, t_s, state.as_ref());
            let late_s = due.elapsed().as_secs_f64();
            robot.departed(start, late_s);
        }
        loop {
            let elapsed_s = due.elapsed().as_secs_f64().min(CYCLE_S);
            let now_s = start + elapsed_s;
            while let Some(arrived) = self.to_client.receive(now_s + 1e-9) {
                sockets.send(robot, &arrived.bytes)?;
            }
            sockets.talk(robot)?;
            while let Some(command) = sockets.receive()? {
                if sound {
                    robot.command(&command, 0.0);
                } else {
                    self.to_robot.send(now_s, t_s, &command);
                }
            }
            while let Some(arrived) = self.to_robot.receive(now_s + 1e-9) {
                robot.command(&arrived.bytes, (arrived.time_s - start).max(0.0));
            }
            if elapsed_s >= CYCLE_S {
                return Ok(());
            }
            sleep(POLL);
        }
    }
}
