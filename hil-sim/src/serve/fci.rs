//! Serving Franka's FCI: a stream for requests, datagrams for states and commands, to one client
//! after the other.
//!
//! Before the first command of a motion states go out every millisecond by the wall clock, in
//! virtual time as well: a client rightly reads on without an answer. From then on virtual time waits for
//! every command, and by the wall clock the schedule is absolute: a command counts when it is here
//! before the next state leaves, so that the robot's own lateness is not the client's.

mod sockets;

use std::io;
use std::net::SocketAddr;
use std::thread::sleep;
use std::time::{Duration, Instant as Clock};

use super::console::Operator;
use super::service::End;
use super::transport::{PATIENCE, POLL};
use crate::link::{Channel, Direction, Fault};
use crate::robot::{FciRobot, Stamp};
use cell::invalid::Invalid;
use record::run::Sample;

use sockets::Sockets;

/// Cycle of the interface.
pub const CYCLE: Duration = Duration::from_millis(1);

/// The same \[s\].
const CYCLE_S: f64 = 1e-3;

/// How long a motion may go on behind the end of the scenario \[cycles\].
const OVERTIME: u32 = 10_000;

/// How long a damaged state is waited for to be answered.
const PERHAPS: Duration = Duration::from_millis(5);

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

/// A robot with its sockets, while it is served.
struct Served<'a> {
    service: &'a FciService,
    robot: &'a mut FciRobot,
    sockets: Sockets,
    to_client: Channel,
    to_robot: Channel,
    /// Number of the newest state that has arrived.
    newest: Option<u64>,
    /// A client that does not answer any more is not waited for.
    gone: bool,
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
        let channel = |direction| Channel::new(direction, &self.faults, CYCLE_S, seed);
        let mut served = Served {
            service: self,
            robot,
            sockets: sockets.0,
            to_client: channel(Direction::ToClient),
            to_robot: channel(Direction::ToRobot),
            newest: None,
            gone: false,
        };
        let begun = Clock::now();
        if !self.lockstep {
            served.robot.keep_time(Stamp::Program);
        }
        let mut due = Clock::now();
        let mut overtime = 0;
        loop {
            operator.attend(served.robot);
            let over = served.robot.is_finished();
            if over && (!served.robot.is_driven() || overtime >= OVERTIME) {
                served.sockets.farewell(served.robot)?;
                return Ok(End::Finished);
            }
            overtime += u32::from(over);
            if !served.robot.has_begun() && begun.elapsed().as_secs_f64() > self.wait_s {
                return Ok(End::NoClient(served.nobody()));
            }
            if served.robot.has_begun() && !served.sockets.is_open() {
                // What the client has begun nobody can go on with.
                return Ok(End::Finished);
            }
            due = served.cycle(due)?;
            if let Some(sample) = served.robot.advance() {
                sink(&sample)?;
            }
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

impl Served<'_> {
    /// Why nobody was served.
    fn nobody(&self) -> String {
        let address = self.service.address;
        let wait_s = self.service.wait_s;
        match self.sockets.last() {
            None => format!("nobody connected to {address} within {wait_s} s"),
            Some(client) => format!("no command of a motion from {client} within {wait_s} s"),
        }
    }

    /// A cycle that is due at a time: state, requests, commands. When the next one is due.
    fn cycle(&mut self, due: Clock) -> io::Result<Clock> {
        self.sockets.talk(self.robot)?;
        let now = Clock::now();
        // Who slept for more than a cycle begins the schedule anew.
        let due = if now > due + CYCLE { now } else { due };
        if self.service.lockstep && self.robot.is_driven() {
            self.step()?;
            return Ok(Clock::now());
        }
        while Clock::now() < due {
            sleep(POLL.min(due.saturating_duration_since(Clock::now())));
        }
        self.paced(due)?;
        Ok(due + CYCLE)
    }

    /// Time of the link \[s\] that the present cycle begins at.
    fn start_s(&self) -> f64 {
        self.robot.cycle() as f64 * CYCLE_S
    }

    /// By the wall clock: the state, then what comes until the next one is due.
    fn paced(&mut self, due: Clock) -> io::Result<()> {
        // Nobody is there: the arm rests.
        if self.robot.control().client().is_none() {
            return Ok(());
        }
        let (start, t_s) = (self.start_s(), self.robot.time_s());
        let sound = !self.robot.has_begun();
        let state = self.sockets.emit(self.robot)?;
        if sound {
            self.sockets.send(self.robot, &state)?;
        } else {
            self.to_client.send(start, t_s, &state);
            let late_s = due.elapsed().as_secs_f64();
            self.robot.departed(start, late_s);
        }
        loop {
            let elapsed_s = due.elapsed().as_secs_f64().min(CYCLE_S);
            let now_s = start + elapsed_s;
            while let Some(arrived) = self.to_client.receive(now_s + 1e-9) {
                self.sockets.send(self.robot, &arrived.bytes)?;
            }
            self.sockets.talk(self.robot)?;
            while let Some(command) = self.sockets.receive()? {
                if sound {
                    self.robot.command(&command, 0.0);
                } else {
                    self.to_robot.send(now_s, t_s, &command);
                }
            }
            while let Some(arrived) = self.to_robot.receive(now_s + 1e-9) {
                self.robot
                    .command(&arrived.bytes, (arrived.time_s - start).max(0.0));
            }
            if elapsed_s >= CYCLE_S {
                return Ok(());
            }
            sleep(POLL);
        }
    }

    /// In virtual time: the state, and the command to it.
    fn step(&mut self) -> io::Result<()> {
        let (start, t_s) = (self.start_s(), self.robot.time_s());
        let end = start + CYCLE_S;
        let state = self.sockets.emit(self.robot)?;
        self.to_client.send(start, t_s, &state);
        while let Some(arrived) = self.to_client.receive(end) {
            self.sockets.send(self.robot, &arrived.bytes)?;
            let fresh = self.newest.is_none_or(|newest| arrived.number > newest);
            if !fresh || self.gone {
                continue;
            }
            self.newest = Some(arrived.number);
            let patience = if arrived.damaged { PERHAPS } else { PATIENCE };
            self.gone |=
                !self.answer(&arrived.bytes, patience, arrived.time_s, t_s)? && !arrived.damaged;
        }
        while let Some(arrived) = self.to_robot.receive(end) {
            self.robot
                .command(&arrived.bytes, (arrived.time_s - start).max(0.0));
        }
        Ok(())
    }

    /// Waits for the command to a state, whatever else comes; whether it came, or was no more to
    /// come as the motion has ended.
    fn answer(
        &mut self,
        state: &[u8],
        patience: Duration,
        time_s: f64,
        t_s: Option<f64>,
    ) -> io::Result<bool> {
        let deadline = Clock::now() + patience;
        let message_id = state.get(..8);
        while Clock::now() < deadline {
            self.sockets.talk(self.robot)?;
            if !self.robot.is_driven() {
                return Ok(true);
            }
            if let Some(command) = self.sockets.receive()? {
                self.to_robot.send(time_s, t_s, &command);
                if command.get(..8) == message_id {
                    return Ok(true);
                }
                continue;
            }
            self.sockets.wait()?;
        }
        Ok(false)
    }
}
