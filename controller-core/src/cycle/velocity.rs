//! Joint speeds from measured positions, for robots that report no speed.
//!
//! The difference quotient over the measured interval goes through one low-pass
//! pole. At low frequencies the estimate is late by [`VelocityEstimator::delay_s`]:
//! half an interval for the quotient, and the lag of the pole.

use crate::joint::{JointState, JointVector, zeros};
use crate::real::Real;

/// Corner frequency of the pole unless another one is chosen \[Hz\]: high enough
/// for task gains of 20 rad/s, low enough for encoder steps of 2e-5 rad.
pub const CORNER_HZ: f64 = 60.0;

/// The last position and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityEstimator<T: Real> {
    /// 2 pi times the corner frequency \[1/s\].
    rate: T,
    last: JointState<T>,
    started: bool,
}

impl<T: Real> VelocityEstimator<T> {
    /// Not started, pole at `corner_hz` \[Hz\] > 0.
    #[must_use]
    pub fn new(corner_hz: f64) -> Self {
        Self {
            rate: T::from_f64(core::f64::consts::TAU * corner_hz),
            last: JointState {
                q: zeros(),
                dq: zeros(),
            },
            started: false,
        }
    }

    /// Position and estimated speed at `q` \[rad\], `interval_s` \[s\] > 0 after the
    /// last one. The first call gives speed zero.
    #[inline]
    pub fn update(&mut self, q: &JointVector<T>, interval_s: T) -> JointState<T> {
        if self.started {
            let pole = T::ONE - (self.rate * interval_s).exp_negative();
            let difference = (q - self.last.q) / interval_s;
            self.last.dq += (difference - self.last.dq) * pole;
        }
        self.last.q = *q;
        self.started = true;
        self.last
    }

    /// Forgets position and speed.
    pub fn reset(&mut self) {
        self.started = false;
        self.last.dq = zeros();
    }

    /// Delay of the estimate at low frequencies \[s\] with regular intervals of
    /// `interval_s` \[s\]: h / 2 for the quotient and h (1 - a) / a for the pole, with
    /// a = 1 - e^(-2 pi f h). 2.8 ms at 2 ms and 60 Hz.
    #[must_use]
    pub fn delay_s(&self, interval_s: T) -> T {
        let decay = (self.rate * interval_s).exp_negative();
        interval_s / (T::ONE + T::ONE) + interval_s * decay / (T::ONE - decay)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_speed_is_found_and_a_ramp_is_late_by_the_stated_delay() {
        let (h, acceleration) = (0.002, 3.0);
        let mut constant = VelocityEstimator::<f64>::new(CORNER_HZ);
        let mut ramp = VelocityEstimator::<f64>::new(CORNER_HZ);
        let (mut speed, mut late) = (0.0, 0.0);
        for k in 0..500 {
            let t = h * f64::from(k);
            speed = constant.update(&JointVector::repeat(0.7 * t), h).dq[3];
            let q = JointVector::repeat(acceleration * t * t / 2.0);
            late = t - ramp.update(&q, h).dq[0] / acceleration;
        }
        // The start has decayed by e^(-2 pi 60): what is left is rounding of q over h.
        assert!((speed - 0.7).abs() < 1e-12, "{speed}");
        assert!((late - ramp.delay_s(h)).abs() < 1e-9, "{late}");
        assert!((ramp.delay_s(h) - 2.777e-3).abs() < 1e-6);
    }

    #[test]
    fn a_gap_gives_the_mean_speed_over_it() {
        let mut estimator = VelocityEstimator::<f64>::new(CORNER_HZ);
        assert_eq!(
            estimator.update(&JointVector::repeat(1.0), 0.002).dq[0],
            0.0
        );
        let after = estimator.update(&JointVector::repeat(1.1), 0.1).dq[0];
        // The pole lets all but e^(-2 pi 6) of it through.
        assert!((after - 1.0).abs() < 1e-12, "{after}");
        estimator.reset();
        assert_eq!(
            estimator.update(&JointVector::repeat(2.0), 0.002).dq[0],
            0.0
        );
    }
}
