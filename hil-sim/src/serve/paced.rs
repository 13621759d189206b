//! Serving by the wall clock: an absolute schedule, so that a late cycle does not
//! move those after it. Only where this program itself was kept from running for more
//! than a cycle does the schedule move: the cycles that it slept through would
//! otherwise count as answers that the client did not give.
//!
//! A client has a whole cycle from when the measurement really left to when its answer
//! really arrived, be it sent late or read late: the robot's own lateness is a figure of
//! its own.

use std::io;
use std::time::{Duration, Instant as Clock};

use super::console::Operator;
use super::service::{End, Service};
use super::transport::{RESEND, Transport};
use crate::link::{Channel, Direction};
use crate::robot::{ControlBox, Robot};
use record::run::Sample;

/// Runs the service in real time.
pub(super) fn run<B: ControlBox>(
    service: &Service,
    robot: &mut Robot<B>,
    operator: &mut Operator,
    client: &mut dyn Transport,
    mut sink: impl FnMut(&Sample) -> io::Result<()>,
) -> io::Result<End> {
    let begun = Clock::now();
    let mut measurement = B::EMPTY;
    while !robot.has_begun() {
        operator.attend(robot);
        if robot.is_finished() {
            return Ok(End::Finished);
        }
        if let Some(end) = service.hopeless(robot, begun) {
            return Ok(end);
        }
        robot.measurement(&mut measurement);
        client.send(measurement.as_ref())?;
        if let Some(answer) = client.receive(client.now() + RESEND)? {
            robot.command(answer, 0.0);
        }
    }
    // The cycle of the first answer ends at once; the schedule starts after it.
    if let Some(instant) = robot.advance() {
        sink(&instant)?;
    }
    robot.keep_time(client.stamp());
    let setup = robot.setup();
    let (cycle_s, seed) = (setup.scenario.cycle_s(), setup.seed);
    let mut schedule = Schedule {
        to_client: Channel::new(Direction::ToClient, &service.faults, cycle_s, seed),
        to_robot: Channel::new(Direction::ToRobot, &service.faults, cycle_s, seed),
        zero: client.now(),
        moved_s: 0.0,
        free_s: 0.0,
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
        client.send(measurement.as_ref())?;
    }
    Ok(End::Finished)
}

/// Both directions of the link, on the wall clock.
struct Schedule {
    to_client: Channel,
    to_robot: Channel,
    /// Wall clock at the start of cycle `first`; times count from here.
    zero: Clock,
    /// What the robot slept since, in which the schedule stood still \[s\].
    moved_s: f64,
    /// Until when the last cycle waited, rightly, for its answer \[s\].
    free_s: f64,
    first: u64,
    cycle_s: f64,
}

impl Schedule {
    fn now_s(&self, client: &dyn Transport) -> f64 {
        client.now().duration_since(self.zero).as_secs_f64()
    }

    fn at(&self, time_s: f64) -> Clock {
        self.zero + Duration::from_secs_f64(time_s.max(0.0))
    }

    /// Sends the measurement and takes answers until the cycle is over.
    fn cycle<B: ControlBox>(
        &mut self,
        robot: &mut Robot<B>,
        client: &mut dyn Transport,
    ) -> io::Result<()> {
        let mut start = (robot.cycle() - self.first) as f64 * self.cycle_s + self.moved_s;
        let wanted = start.max(self.free_s);
        let asleep_s = self.now_s(client) - start;
        if asleep_s > self.cycle_s {
            self.moved_s += asleep_s;
            start += asleep_s;
        }
        let end = start + self.cycle_s;
        let t_s = robot.time_s();
        let mut measurement = B::EMPTY;
        robot.measurement(&mut measurement);
        let now = self.now_s(client);
        self.to_client.send(now, t_s, measurement.as_ref());
        self.pass_on(client)?;
        // Looked at behind the sending: in doubt the time is the robot's.
        let sent = self.now_s(client);
        robot.departed(sent, sent - wanted);
        let patience = sent.max(start) + self.cycle_s;
        loop {
            self.pass_on(client)?;
            let now = self.now_s(client);
            // What arrived later belongs to the next cycle, also where the robot slept.
            while let Some(arrived) = self.to_robot.receive(now.min(patience) + 1e-9) {
                robot.command(&arrived.bytes, arrived.time_s - sent);
            }
            let over = if robot.is_answered() { end } else { patience };
            let next = [self.to_client.next_time_s(), self.to_robot.next_time_s()];
            let until = next.into_iter().flatten().fold(over, f64::min);
            let read = client.receive_on_time(self.at(until))?;
            let read = read.map(|read| (read.datagram.to_vec(), read.waited.as_secs_f64()));
            let now = self.now_s(client);
            match read {
                Some((answer, waited_s)) => self.to_robot.send(now - waited_s, t_s, &answer),
                // Behind the schedule too, what has arrived is read first.
                None if now >= over => {
                    self.free_s = over;
                    return Ok(());
                }
                None => (),
            }
        }
    }

    /// Sends the measurements whose time has come.
    fn pass_on(&mut self, client: &mut dyn Transport) -> io::Result<()> {
        let now = self.now_s(client);
        while let Some(arrived) = self.to_client.receive(now + 1e-9) {
            client.send(&arrived.bytes)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::super::transport::Arrival;
    use super::*;
    use crate::plant::PlantOptions;
    use crate::robot::{LinkFigures, LwrRobot, RatingOptions, RobotOptions, RobotSetup, Stamp};
    use cell::names::PlantKind;
    use cell::scenario::Scenario;
    use fri::{Command, Flags, Measurement, MeasurementPacket};

    const MS: Duration = Duration::from_millis(1);

    /// Client and clock: a measurement is answered `answers` after it left, and the robot
    /// oversleeps as `sleeps` says.
    struct Fake {
        now: Clock,
        sent: usize,
        answers: fn(usize) -> Duration,
        /// By how much the robot wakes late after measurement number so.
        sleeps: fn(usize) -> Duration,
        slept: usize,
        under_way: VecDeque<(Clock, [u8; Command::LEN])>,
        read: [u8; Command::LEN],
        stamp: Stamp,
    }

    impl Transport for Fake {
        fn send(&mut self, datagram: &[u8]) -> io::Result<()> {
            let packet = MeasurementPacket::new_checked(datagram).expect("a measurement");
            let measurement = Measurement::parse(&packet);
            self.sent += 1;
            let mut command = Command {
                flags: Flags::JOINT_IMPEDANCE,
                joint_stiffness: [100.0; 7],
                joint_damping: [0.7; 7],
                joint_position: measurement.total_commanded_position(),
                ..Command::default()
            };
            command.header.counter = self.sent as u16;
            command.header.reflected = measurement.header.counter;
            let mut bytes = [0; Command::LEN];
            command.emit(&mut bytes);
            let answer = (self.now + (self.answers)(self.sent), bytes);
            self.under_way.push_back(answer);
            Ok(())
        }

        fn receive(&mut self, deadline: Clock) -> io::Result<Option<&[u8]>> {
            let arrival = self.receive_on_time(deadline)?;
            Ok(arrival.map(|arrival| arrival.datagram))
        }

        fn receive_on_time(&mut self, deadline: Clock) -> io::Result<Option<Arrival<'_>>> {
            let came = self.under_way.front().map(|(came, _)| *came);
            let wakes = came.map_or(deadline, |came| came.min(deadline));
            // A clock that nobody sees standing still.
            self.now = self.now.max(wakes) + Duration::from_nanos(1);
            if self.slept < self.sent {
                self.slept = self.sent;
                self.now += (self.sleeps)(self.sent);
            }
            let now = self.now;
            let ready = self.under_way.pop_front_if(|(came, _)| *came <= now);
            Ok(ready.map(|(came, bytes)| {
                self.read = bytes;
                let waited = match self.stamp {
                    Stamp::Kernel => now - came,
                    Stamp::Program => Duration::ZERO,
                };
                Arrival {
                    datagram: &self.read,
                    waited,
                }
            }))
        }

        fn stamp(&self) -> Stamp {
            self.stamp
        }

        fn now(&self) -> Clock {
            self.now
        }
    }

    /// The link after 3 s in cycles of 2 ms.
    fn served(
        stamp: Stamp,
        answers: fn(usize) -> Duration,
        sleeps: fn(usize) -> Duration,
    ) -> LinkFigures {
        let mut scenario = Scenario::find("two-level").expect("built in");
        scenario.duration_s = 1.8;
        let mut robot = LwrRobot::new(RobotSetup {
            scenario,
            plant: PlantKind::Ideal,
            contacts: false,
            seed: 1,
            plant_options: PlantOptions::default(),
            // Content with any link: what is rated here are single answers.
            options: RobotOptions {
                rating: RatingOptions {
                    bad_rate: 0.1,
                    ok_rate: 0.2,
                    ..RatingOptions::default()
                },
                ..RobotOptions::default()
            },
        });
        let mut client = Fake {
            now: Clock::now(),
            sent: 0,
            answers,
            sleeps,
            slept: 0,
            under_way: VecDeque::new(),
            read: [0; Command::LEN],
            stamp,
        };
        let service = Service {
            client: super::super::Client::Udp {
                remote: ([127, 0, 0, 1], 1).into(),
                local_port: 0,
            },
            lockstep: false,
            faults: Vec::new(),
            wait_s: 60.0,
        };
        let mut operator = Operator::absent();
        let end = run(&service, &mut robot, &mut operator, &mut client, |_| Ok(()));
        assert_eq!(end.expect("no socket"), End::Finished);
        robot.summary().link.expect("a link")
    }

    /// The robot wakes 1.9 ms late in every tenth cycle, and 7 ms in every hundredth.
    fn late(number: usize) -> Duration {
        match number {
            _ if number.is_multiple_of(100) => 7 * MS,
            _ if number.is_multiple_of(10) => 19 * MS / 10,
            _ => Duration::ZERO,
        }
    }

    #[test]
    fn the_robots_own_lateness_is_not_the_clients() {
        let quick = |_| MS / 2;
        let link = served(Stamp::Kernel, quick, late);
        assert_eq!((link.missed, link.late), (0, 0));
        // The latency is the client's, to the nanosecond of the clock.
        let latency = link.latency_ms.max.expect("answers");
        assert!((latency - 0.5).abs() < 1e-5, "{latency}");
        // Woken 1.9 ms after 0.5 the robot is 0.4 ms behind, more than a tenth of a cycle:
        // every tenth cycle, the hundredth among them.
        let own = link.own_lateness.expect("by the clock");
        let cycles = link.answers / 10;
        assert!(own.cycles.abs_diff(cycles) <= 1, "{own:?} of {cycles}");
        // 7 ms late after 0.5 ms of the cycle: 5.5 ms behind its end.
        assert!((own.max_ms - 5.5).abs() < 0.01, "{own:?}");
        // Read by the program's clock the same robot takes it for the client's.
        let link = served(Stamp::Program, quick, late);
        assert!(link.late >= link.answers / 10 - 1, "{}", link.late);
    }

    #[test]
    fn a_late_client_is_late_however_late_the_robot_is() {
        let slow = |number: usize| match number.is_multiple_of(20) {
            true => 25 * MS / 10,
            false => MS / 2,
        };
        for sleeps in [late, |_| Duration::ZERO] {
            let link = served(Stamp::Kernel, slow, sleeps);
            assert!(link.late.abs_diff(link.answers / 20) <= 1, "{link:?}");
            assert_eq!(link.missed, link.late);
            let latency = link.latency_ms.max.expect("answers");
            assert!(latency > 2.0 && latency < 3.0, "{latency}");
        }
    }

    /// A measurement that left late leaves the client its whole cycle all the same.
    #[test]
    fn an_answer_has_a_cycle_from_when_its_measurement_left() {
        let nearly = |_| 19 * MS / 10;
        let nap = |number: usize| match number.is_multiple_of(10) {
            true => MS,
            false => Duration::ZERO,
        };
        let link = served(Stamp::Kernel, nearly, nap);
        assert_eq!((link.missed, link.late), (0, 0));
        let own = link.own_lateness.expect("by the clock");
        // 1 ms after 1.9 of 2 ms: 0.9 ms behind.
        assert!((own.max_ms - 0.9).abs() < 0.01, "{own:?}");
    }
}
