//! Measurement of the realistic plant: encoder counts, and a velocity made from
//! them by the core's estimator, as on a robot that reports positions only; or
//! what motors report in frames of a bus.

use arms::realistic::Interface;
use controller_core::cycle::velocity::{CORNER_HZ, VelocityEstimator};
use controller_core::joint::{JointState, JointVector};

use super::frames::Frames;

/// How the joints are read.
#[derive(Clone, Debug, PartialEq)]
pub enum Sensor {
    /// Positions only.
    Encoders(Encoders),
    /// Positions and speeds, by the motors.
    Frames(Frames),
}

/// Encoders and velocity filter of all joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoders {
    step: f64,
    cycle_s: f64,
    velocity: VelocityEstimator<f64>,
}

impl Sensor {
    /// Sensor of an arm at rest at `q0` \[rad\], read every `cycle_s` \[s\].
    #[must_use]
    pub fn new(interface: &Interface, q0: &JointVector<f64>, cycle_s: f64) -> Self {
        match interface {
            Interface::Encoders { step } => Self::Encoders(Encoders::new(*step, q0, cycle_s)),
            Interface::Frames(motors) => Self::Frames(Frames::new(motors)),
        }
    }

    /// Reading one cycle after the last one: encoders are on the links, motors report their own
    /// state, which is that of the links unless the joints are elastic.
    pub fn measure(&mut self, link: &JointState<f64>, motor: &JointState<f64>) -> JointState<f64> {
        match self {
            Self::Encoders(encoders) => encoders.measure(&link.q),
            Self::Frames(frames) => frames.measured(motor),
        }
    }

    /// What reaches the drives of a commanded torque \[Nm\].
    #[must_use]
    pub fn commanded(&self, torque: &JointVector<f64>) -> JointVector<f64> {
        match self {
            Self::Encoders(_) => *torque,
            Self::Frames(frames) => frames.commanded(torque),
        }
    }
}

impl Encoders {
    /// With a step \[rad\] above 0, of an arm at rest at `q0` \[rad\], read every `cycle_s` \[s\].
    #[must_use]
    pub fn new(step: f64, q0: &JointVector<f64>, cycle_s: f64) -> Self {
        let mut velocity = VelocityEstimator::new(CORNER_HZ);
        velocity.update(&q0.map(|angle| quantised(angle, step)), cycle_s);
        Self {
            step,
            cycle_s,
            velocity,
        }
    }

    /// Reading of an arm at `q` \[rad\], one cycle after the last reading.
    pub fn measure(&mut self, q: &JointVector<f64>) -> JointState<f64> {
        let read = q.map(|angle| quantised(angle, self.step));
        self.velocity.update(&read, self.cycle_s)
    }
}

/// The nearest encoder position to an angle \[rad\].
#[must_use]
pub fn quantised(angle: f64, step: f64) -> f64 {
    (angle / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::realistic::ENCODER_STEP;

    #[test]
    fn positions_are_the_nearest_multiples_of_the_step() {
        let mut worst = 0.0f64;
        for i in -50_000..50_000 {
            let angle = f64::from(i) * 6.1e-5;
            let reading = quantised(angle, ENCODER_STEP);
            worst = worst.max((reading - angle).abs());
            let count = reading / ENCODER_STEP;
            assert!((count - count.round()).abs() < 1e-9);
        }
        assert!(worst <= 0.5 * ENCODER_STEP + 1e-15 && worst > 0.49 * ENCODER_STEP);
    }

    #[test]
    fn the_velocity_starts_at_zero_and_settles_at_the_true_one() {
        let (cycle, speed) = (0.002, 0.5);
        let position = |n: i32| JointVector::from_element(0.3 + speed * cycle * f64::from(n));
        let mut sensor = Encoders::new(ENCODER_STEP, &position(0), cycle);
        assert_eq!(sensor.measure(&position(0)).dq, JointVector::zeros());
        let pole = 1.0 - libm::exp(-core::f64::consts::TAU * 60.0 * cycle);
        // 1 mrad a cycle is 50 encoder steps: the difference quotient is exact.
        let first = sensor.measure(&position(1)).dq[0];
        assert!((first - pole * speed).abs() < 1e-9, "{first}");
        for n in 2..40 {
            sensor.measure(&position(n));
        }
        let settled = sensor.measure(&position(40)).dq[0];
        assert!((settled - speed).abs() < 1e-8, "{settled}");
    }
}
