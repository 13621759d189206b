//! How the difference between two motions dies out.

use crate::cells::Cells;
use crate::joint::{Vector3, zeros};
use crate::real::Real;

/// From 0 to 1 as s does, without a step of its rate.
pub(crate) fn smoothstep<T: Real>(s: T) -> T {
    s * s * (T::from_f64(3.0) - s - s)
}

/// Time that passes while a difference dies out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock<T: Real> {
    elapsed_s: T,
    /// 0 where nothing is left.
    duration_s: T,
}

impl<T: Real> Clock<T> {
    /// Nothing is left.
    pub const ENDED: Self = Self {
        elapsed_s: T::ZERO,
        duration_s: T::ZERO,
    };

    /// For `duration_s` > 0.
    pub fn new(duration_s: T) -> Self {
        Self {
            elapsed_s: T::ZERO,
            duration_s,
        }
    }

    /// Time passed and time given \[s\].
    pub fn visit(&mut self, cells: &mut impl Cells<T>) {
        let mut times = [self.elapsed_s, self.duration_s];
        cells.numbers("clock_s", &mut times);
        [self.elapsed_s, self.duration_s] = times;
    }

    /// Whether some is left.
    #[inline(always)]
    pub fn runs(&self) -> bool {
        self.duration_s > T::ZERO
    }

    /// Begins anew where some is left, for `duration_s` > 0.
    pub fn shorten(&mut self, duration_s: T) {
        if self.runs() {
            *self = Self::new(duration_s);
        }
    }

    /// Nothing is left from now on.
    #[inline(always)]
    pub fn end(&mut self) {
        self.duration_s = T::ZERO;
    }

    /// The next cycle, `interval_s` later.
    #[inline(always)]
    pub fn advance(&mut self, interval_s: T) {
        self.elapsed_s += interval_s;
        if self.elapsed_s >= self.duration_s {
            self.end();
        }
    }

    /// Share of the duration that has passed, 0 to 1. To be asked while it runs.
    #[inline(always)]
    pub fn share(&self) -> T {
        self.elapsed_s / self.duration_s
    }
}

/// A difference e that goes to zero in the time T, on the polynomial of least degree whose
/// value and first two derivatives are those of the difference at first and zero at last:
///
/// ```text
/// e(s) = (1 - s)^3 (a + b s + c s^2)                      s = t / T
/// a = e0,  b = 3 e0 + T de0,  c = 6 e0 + 3 T de0 + T^2 dde0 / 2
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Decay<T: Real> {
    /// a, b, c.
    coefficients: [Vector3<T>; 3],
    /// From 0 to T.
    clock: Clock<T>,
}

impl<T: Real> Decay<T> {
    /// No difference.
    pub const NONE: Self = Self {
        coefficients: [zeros(); 3],
        clock: Clock::ENDED,
    };

    /// From the difference and its first two derivatives by time, in `duration_s` > 0; over
    /// at once where all are zero.
    pub fn new([e, de, dde]: [Vector3<T>; 3], duration_s: T) -> Self {
        let mut largest = T::ZERO;
        for value in [e, de, dde].iter().flatten() {
            largest = value.magnitude().most(largest);
        }
        if largest == T::ZERO {
            return Self::NONE;
        }
        let (three, six) = (T::from_f64(3.0), T::from_f64(6.0));
        let (de, dde) = (de * duration_s, dde * (duration_s * duration_s));
        Self {
            coefficients: [e, e * three + de, e * six + de * three + dde * T::HALF],
            clock: Clock::new(duration_s),
        }
    }

    /// Its coefficients and its clock.
    pub fn visit(&mut self, cells: &mut impl Cells<T>) {
        for coefficient in &mut self.coefficients {
            cells.numbers("decay", coefficient.as_mut_slice());
        }
        self.clock.visit(cells);
    }

    /// Whether there is a difference.
    #[inline(always)]
    pub fn lasts(&self) -> bool {
        self.clock.runs()
    }

    /// No difference from now on.
    #[inline(always)]
    pub fn end(&mut self) {
        self.clock.end();
    }

    /// The next cycle, `interval_s` later.
    #[inline(always)]
    pub fn advance(&mut self, interval_s: T) {
        self.clock.advance(interval_s);
    }

    /// e, de/dt, d2e/dt2 of now. To be asked while it lasts.
    #[inline(never)]
    pub fn now(&self) -> [Vector3<T>; 3] {
        let rate = T::ONE / self.clock.duration_s;
        let s = self.clock.elapsed_s * rate;
        let left = T::ONE - s;
        let [a, b, c] = &self.coefficients;
        let (two, three, six) = (T::from_f64(2.0), T::from_f64(3.0), T::from_f64(6.0));
        let p = a + b * s + c * (s * s);
        let dp = b + c * (two * s);
        let ddp = c * two;
        let first = dp * left - p * three;
        let second = ddp * (left * left) - dp * (six * left) + p * six;
        [
            p * (left * left * left),
            first * (left * left * rate),
            second * (left * rate * rate),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decay() -> (Decay<f64>, [Vector3<f64>; 3]) {
        let start = [[0.1, -0.2, 0.3], [0.4, 0.0, -0.5], [2.0, 1.0, -3.0]].map(Vector3::from);
        (Decay::new(start, 0.4), start)
    }

    #[test]
    fn it_begins_as_the_difference_and_ends_in_nothing() {
        let (mut decay, start) = decay();
        for (now, start) in decay.now().iter().zip(start) {
            // Three roundings of numbers below 200 (d2e/dt2 from 1/T^2).
            assert!((now - start).amax() < 1e-13);
        }
        decay.advance(0.4 - 1e-6);
        for (now, bound) in decay.now().iter().zip([1e-15, 1e-9, 1e-3]) {
            assert!(now.amax() < bound, "{now}");
        }
        assert!(decay.lasts());
        decay.advance(1e-5);
        assert!(!decay.lasts());
    }

    /// Against central differences, whose error at 1e-5 s is 1e-10 times a fourth
    /// derivative below 1e5, and 1e-16 / 1e-10 of rounding.
    #[test]
    fn its_derivatives_are_those_of_its_value() {
        let (decay, _) = decay();
        let at = |t_s: f64| {
            let mut later = decay;
            later.advance(t_s);
            later.now()
        };
        for i in 1..39 {
            let t = f64::from(i) * 0.01;
            let [before, now, after] = [at(t - 1e-5), at(t), at(t + 1e-5)];
            for order in 0..2 {
                let slope = (after[order] - before[order]) / 2e-5;
                assert!((slope - now[order + 1]).amax() < 2e-5, "{t} {order}");
            }
        }
    }
}
