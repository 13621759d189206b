//! Torques on their way: which of them acted on the arm.
//!
//! A robot mirrors in every measurement the counter of the last command it has.
//! So the bridge knows, also where commands are lost or late, what the robot has
//! used since the last measurement, and can tell the observer.

use controller_core::cycle::delay::Delay;
use controller_core::joint::{JointVector, zeros};
use heapless::HistoryBuf;

/// Commands remembered. One that was overtaken by more than this is too old to
/// matter.
const MEMORY: usize = 32;

/// Commands sent lately, and those that the robot had lately.
#[derive(Clone, Debug)]
pub(crate) struct SentTorques {
    sent: HistoryBuf<(u16, JointVector<f64>), MEMORY>,
    /// What the robot had at the last measurements.
    received: Delay<f64>,
}

impl SentTorques {
    /// Nothing sent: zero torque acts.
    pub fn new() -> Self {
        Self {
            // What a robot without a command mirrors is 0.
            sent: HistoryBuf::new_with((0, zeros())),
            received: Delay::new(),
        }
    }

    /// A command with this counter carries `torque` \[Nm\].
    pub fn send(&mut self, counter: u16, torque: JointVector<f64>) {
        self.sent.write((counter, torque));
    }

    /// The torque \[Nm\] that acted until the measurement that mirrors `reflected`,
    /// with `dead_cycles` cycles between the arrival of a command and its effect.
    /// A counter that was not sent lately counts as the last one sent.
    pub fn acted(&mut self, reflected: u16, dead_cycles: u8) -> JointVector<f64> {
        let mirrored = self.sent.iter().find(|(counter, _)| *counter == reflected);
        let torque = mirrored
            .or(self.sent.recent())
            .map_or(zeros(), |(_, torque)| *torque);
        self.received.send(dead_cycles, &torque, &zeros())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn torque(value: u16) -> JointVector<f64> {
        JointVector::repeat(f64::from(value))
    }

    #[test]
    fn a_lost_command_leaves_the_one_before_in_place() {
        let mut sent = SentTorques::new();
        let mut acted = Vec::new();
        for (counter, reflected) in [(65534, 65534), (65535, 65535), (0, 65535), (1, 1)] {
            sent.send(counter, torque(counter));
            acted.push(sent.acted(reflected, 0)[0]);
        }
        assert_eq!(acted, [65534.0, 65535.0, 65535.0, 1.0]);
    }

    #[test]
    fn dead_time_counts_from_the_arrival() {
        let mut sent = SentTorques::new();
        let mut acted = Vec::new();
        for counter in 1..6 {
            sent.send(counter, torque(counter));
            acted.push(sent.acted(counter, 2)[0]);
        }
        assert_eq!(acted, [0.0, 0.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn a_robot_that_mirrors_nothing_has_the_last_command() {
        let mut sent = SentTorques::new();
        for counter in 100..200 {
            sent.send(counter, torque(counter));
            assert_eq!(sent.acted(7, 0)[0], f64::from(counter));
        }
    }
}
