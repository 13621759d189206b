//! Frames of a motor bus: positions of 16 bits, speeds and torques of 12, over the motor's ranges.
//!
//! As Damiao's motors have it: 2^n - 1 steps from one end of a range to the other. A motor cuts
//! what it reports down to a step, and who reads that adds half a one. A command is the nearest
//! step; there is none for zero.

use arms::realistic::MotorRanges;
use controller_core::joint::{DOF, JointState, JointVector};

/// Bits of a position, and of a speed or torque.
const POSITION_BITS: u32 = 16;
const BITS: u32 = 12;

/// A range from -`most` to `most` in steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    most: f64,
    step: f64,
}

impl Scale {
    fn new(most: f64, bits: u32) -> Self {
        let steps = (1_u32 << bits) - 1;
        Self {
            most,
            step: 2.0 * most / f64::from(steps),
        }
    }

    /// Steps from the lower end, within the range.
    fn steps(&self, value: f64) -> f64 {
        (value.clamp(-self.most, self.most) + self.most) / self.step
    }

    /// What is read of a true value.
    fn reading(&self, value: f64) -> f64 {
        (self.steps(value).floor() + 0.5) * self.step - self.most
    }

    /// What arrives of a command.
    fn command(&self, value: f64) -> f64 {
        self.steps(value).round() * self.step - self.most
    }
}

/// The frames of all motors.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames {
    position: [Scale; DOF],
    speed: [Scale; DOF],
    torque: [Scale; DOF],
}

impl Frames {
    /// Between these ranges.
    #[must_use]
    pub fn new(motors: &[MotorRanges; DOF]) -> Self {
        Self {
            position: motors.map(|motor| Scale::new(motor.position, POSITION_BITS)),
            speed: motors.map(|motor| Scale::new(motor.speed, BITS)),
            torque: motors.map(|motor| Scale::new(motor.torque, BITS)),
        }
    }

    /// Steps of positions \[rad\] and speeds \[rad/s\] that are reported.
    #[must_use]
    pub fn steps(&self) -> [JointVector<f64>; 2] {
        [&self.position, &self.speed].map(|all| JointVector::from(all.map(|scale| scale.step)))
    }

    /// Positions and speeds as the motors report them.
    #[must_use]
    pub fn measured(&self, state: &JointState<f64>) -> JointState<f64> {
        JointState {
            q: JointVector::from_fn(|i, _| self.position[i].reading(state.q[i])),
            dq: JointVector::from_fn(|i, _| self.speed[i].reading(state.dq[i])),
        }
    }

    /// Torques \[Nm\] as they reach the motors.
    #[must_use]
    pub fn commanded(&self, torque: &JointVector<f64>) -> JointVector<f64> {
        JointVector::from_fn(|i, _| self.torque[i].command(torque[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::OPENARM_V20_REALISTIC;
    use arms::realistic::Interface;

    fn frames() -> Frames {
        let Interface::Frames(motors) = OPENARM_V20_REALISTIC.interface else {
            panic!("motors on a bus");
        };
        Frames::new(&motors)
    }

    /// Steps of the motors, by hand: 25 rad / 65535, twice 45 rad/s / 4095 and so on.
    #[test]
    fn steps_are_those_of_the_motors() {
        let frames = frames();
        let close = |scale: &[Scale; DOF], steps: [f64; DOF]| {
            for (scale, step) in scale.iter().zip(steps) {
                assert!((scale.step / step - 1.0).abs() < 1e-3, "{}", scale.step);
            }
        };
        close(&frames.position, [3.815e-4; DOF]);
        let [big, middle, small, least] = [0.021978, 0.004884, 0.014652, 0.02442];
        close(
            &frames.speed,
            [big, big, middle, middle, small, small, least],
        );
        let [big, middle, small, least] = [0.026374, 0.013675, 0.004884, 0.002442];
        close(
            &frames.torque,
            [big, big, middle, middle, small, small, least],
        );
    }

    #[test]
    fn rest_reads_as_zero_and_nothing_is_further_off_than_half_a_step() {
        let frames = frames();
        let rest = JointState {
            q: JointVector::zeros(),
            dq: JointVector::zeros(),
        };
        let read = frames.measured(&rest);
        assert!(read.q.amax() < 1e-14 && read.dq.amax() < 1e-14, "{read:?}");
        for scale in [frames.position, frames.speed, frames.torque].as_flattened() {
            let half = scale.step * (0.5 + 1e-9);
            let (mut reading, mut command) = (0.0_f64, 0.0_f64);
            for n in -5000..5000 {
                let value = scale.most * f64::from(n) / 5001.0;
                reading = reading.max((scale.reading(value) - value).abs());
                command = command.max((scale.command(value) - value).abs());
            }
            assert!(reading <= half && command <= half);
            // And no finer.
            assert!(reading > 0.4 * scale.step && command > 0.4 * scale.step);
        }
    }

    #[test]
    fn beyond_the_range_is_its_end() {
        let frames = frames();
        let most = JointVector::from_fn(|i, _| frames.torque[i].most);
        assert!((frames.commanded(&(most * 3.0)) - most).amax() < 1e-12);
        assert!((frames.commanded(&(most * -3.0)) + most).amax() < 1e-12);
    }
}
