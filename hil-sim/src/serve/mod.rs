//! The robot on a socket or a serial line: it sends first, to the one client that
//! it was told, and takes answers from there only.

mod console;
mod fci;
mod paced;
mod serial;
mod service;
mod stamped;
mod transport;
mod udp;

use std::io;
use std::time::Instant as Clock;

pub use self::fci::{FciService, FciSockets};
pub use console::{Operator, Wish};
pub use serial::Serial;
pub use service::{Client, End, Service};
pub use transport::{Arrival, Transport};
pub use udp::Udp;

use crate::link::{LockStep, finish, is_over};
use crate::robot::{ControlBox, Robot};
use record::run::Sample;

impl Service {
    /// Serves `robot` to `client` until its scenario is over. Every cycle of scenario
    /// time goes to `sink`.
    ///
    /// # Errors
    /// The socket's, and those of `sink`.
    pub fn run<B: ControlBox>(
        &self,
        robot: &mut Robot<B>,
        operator: &mut Operator,
        client: &mut dyn Transport,
        sink: impl FnMut(&Sample) -> io::Result<()>,
    ) -> io::Result<End> {
        if self.lockstep {
            self.lockstep(robot, operator, client, sink)
        } else {
            paced::run(self, robot, operator, client, sink)
        }
    }

    fn lockstep<B: ControlBox>(
        &self,
        robot: &mut Robot<B>,
        operator: &mut Operator,
        client: &mut dyn Transport,
        mut sink: impl FnMut(&Sample) -> io::Result<()>,
    ) -> io::Result<End> {
        let cycle_s = robot.setup().scenario.cycle_s();
        let mut link = LockStep::new(&self.faults, cycle_s, robot.setup().seed);
        let begun = Clock::now();
        while !is_over(robot, client) {
            operator.attend(robot);
            if let Some(end) = self.hopeless(robot, begun) {
                return Ok(end);
            }
            if let Some(instant) = link.step(robot, client)? {
                sink(&instant)?;
            }
        }
        finish(robot, client)?;
        Ok(End::Finished)
    }
}
