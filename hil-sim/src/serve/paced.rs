//! Serving by the wall clock: an absolute schedule, so that a late cycle does not
//! move those after it. Only where this program itself was kept from running for more
//! than a cycle does the schedule move: the cycles that it slept through would
//! otherwise count as answers that the client did not give.

use std::io;
use std::time::{Duration, Instant as Clock};

use super::console::Operator;
use super::service::{End, Service};
use super::transport::{RESEND, Transport};
use crate::link::{Channel, Direction};
use crate::robot::{MEASUREMENT_BYTES, Robot};
use record::run::Sample;

/// Runs the service in real time.
pub(super) fn run(
    service: &Service,
    robot: &mut Robot,
    operator: &mut Operator,
    client: &mut dyn Transport,
    mut sink: impl FnMut(&Sample) -> io::Result<()>,
) -> io::Result<End> {
    let begun = Clock::now();
    let mut measurement = [0; MEASUREMENT_BYTES];
    while !robot.has_begun() {
        operator.attend(robot);
        if robot.is_finished() {
            return Ok(End::Finished);
        }
        if let Some(end) = service.hopeless(robot, begun) {
            return Ok(end);
        }
        robot.measurement(&mut measurement);
        client.send(&measurement)?;
        if let Some(answer) = client.receive(Clock::now() + RESEND)? {
            robot.command(answer, 0.0);
        }
    }
    // The cycle of the first answer ends at once; the schedule starts after it.
    if let Some(instant) = robot.advance() {
        sink(&instant)?;
    }
    let setup = robot.setup();
    let (cycle_s, seed) = (setup.scenario.cycle_s(), setup.seed);
    let mut schedule = Schedule {
        to_client: Channel::new(Direction::ToClient, &service.faults, cycle_s, seed),
        to_robot: Channel::new(Direction::ToRobot, &service.faults, cycle_s, seed),
        zero: Clock::now(),
        first: robot.cycle(),
        cycle_s,
    };
    while !robot.is_finished() {
        operator.attend(robot);
        if let Some(end) = service.hopeless(robot, begun) {
            return Ok(end);
        }
        schedule.cycle(robot, client)?;
        if let Some(instant) = robot.advance() {
            sink(&instant)?;
        }
    }
    robot.leave();
    for _ in 0..3 {
        robot.measurement(&mut measurement);
        client.send(&measurement)?;
    }
    Ok(End::Finished)
}

/// Both directions of the link, on the wall clock.
struct Schedule {
    to_client: Channel,
    to_robot: Channel,
    /// Wall clock at the start of cycle `first`, as if the robot had never slept.
    zero: Clock,
    first: u64,
    cycle_s: f64,
}

impl Schedule {
    fn now_s(&self) -> f64 {
        self.zero.elapsed().as_secs_f64()
    }

    fn at(&self, time_s: f64) -> Clock {
        self.zero + Duration::from_secs_f64(time_s.max(0.0))
    }

    /// Sends the measurement and takes answers until the cycle is over.
    fn cycle(&mut self, robot: &mut Robot, client: &mut dyn Transport) -> io::Result<()> {
        let start = (robot.cycle() - self.first) as f64 * self.cycle_s;
        let asleep_s = self.now_s() - start;
        if asleep_s > self.cycle_s {
            self.zero += Duration::from_secs_f64(asleep_s);
        }
        let end = start + self.cycle_s;
        let t_s = robot.time_s();
        let mut measurement = [0; MEASUREMENT_BYTES];
        robot.measurement(&mut measurement);
        self.to_client.send(self.now_s(), t_s, &measurement);
        loop {
            let now = self.now_s();
            while let Some(arrived) = self.to_client.receive(now.max(start) + 1e-9) {
                client.send(&arrived.bytes)?;
            }
            while let Some(arrived) = self.to_robot.receive(now + 1e-9) {
                robot.command(&arrived.bytes, (arrived.time_s - start).max(0.0));
            }
            let next = [self.to_client.next_time_s(), self.to_robot.next_time_s()];
            let until = next.into_iter().flatten().fold(end, f64::min);
            match client.receive_on_time(self.at(until))? {
                Some(answer) => self.to_robot.send(self.now_s(), t_s, answer),
                // Behind the schedule too, what has arrived is read first.
                None if self.now_s() >= end => return Ok(()),
                None => (),
            }
        }
    }
}
