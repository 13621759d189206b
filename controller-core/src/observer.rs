//! The generalised-momentum observer (30): external torque without torque
//! sensors.
//!
//! With p = M dq and the equation of motion (6), dp/dt = u - tau_ext where
//! u = tau + C^T dq - g is known. The residual r follows -tau_ext through a
//! first-order lag with the rate K_I, joint by joint:
//!
//! ```text
//! r_k = e^(-K_I h) r_(k-1) + (1 - e^(-K_I h)) ((p_k - p_(k-1)) / h - u_(k-1))
//! ```
//!
//! This is exact for a d = dp/dt - u that is constant over a cycle, and stable
//! for every K_I > 0; the explicit Euler form of (30) is stable only for
//! K_I < 2 / h. It starts from the momentum at hand: (30) as printed assumes
//! that the arm starts at rest.

use crate::config::DEAD_CYCLES_MAX;
use crate::dynamics::Dynamics;
use crate::joint::{DOF, JointState, JointVector, exponentials, zeros};
use crate::real::Real;

/// What the observer remembers from the previous cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer<T: Real> {
    /// p_(k-1) \[Nms\].
    pub momentum: JointVector<T>,
    /// u_(k-1) = tau + C^T dq - g \[Nm\], tau as it was applied.
    pub input: JointVector<T>,
    /// tau in that input \[Nm\].
    pub torque: JointVector<T>,
    /// r_(k-1) \[Nm\].
    pub residual: JointVector<T>,
    /// False until the first momentum is known.
    pub started: bool,
}

impl<T: Real> Observer<T> {
    /// Not started: the first update only takes the momentum.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            momentum: zeros(),
            input: zeros(),
            torque: zeros(),
            residual: zeros(),
            started: false,
        }
    }

    /// One step with `gain` K_I \[1/s\] per joint, the measured interval h \[s\] > 0
    /// and the present momentum \[Nms\]. Returns r \[Nm\], which tends to -tau_ext:
    /// positive where the environment pushes the joint forward.
    #[inline]
    pub fn update(
        &mut self,
        gain: &JointVector<T>,
        interval_s: T,
        momentum: &JointVector<T>,
    ) -> JointVector<T> {
        if self.started {
            let rate = T::ONE / interval_s;
            let innovation = (momentum - self.momentum) * rate - self.input;
            let decay = exponentials(&(gain * interval_s));
            for i in 0..DOF {
                self.residual[i] =
                    decay[i] * self.residual[i] + (T::ONE - decay[i]) * innovation[i];
            }
        }
        self.momentum = *momentum;
        self.started = true;
        self.residual
    }

    /// Keeps u of this cycle for the next [`Observer::update`]. `torque` \[Nm\] is the
    /// one that reaches the joints, after limits.
    #[inline]
    pub fn apply(
        &mut self,
        dynamics: &Dynamics<T>,
        state: &JointState<T>,
        torque: &JointVector<T>,
    ) {
        self.input = torque + dynamics.coriolis_transpose_times(&state.dq) - dynamics.gravity;
        self.torque = *torque;
    }

    /// Replaces the torque \[Nm\] in the input kept by [`Observer::apply`].
    pub fn correct(&mut self, torque: &JointVector<T>) {
        self.input += torque - self.torque;
        self.torque = *torque;
    }
}

/// The torques of the last cycles: which of them acts now, behind a dead time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DeadTime<T: Real> {
    /// A ring.
    sent: [JointVector<T>; REMEMBERED],
    /// Where the next torque goes.
    place: usize,
    started: bool,
}

const REMEMBERED: usize = DEAD_CYCLES_MAX as usize;

impl<T: Real> DeadTime<T> {
    pub const fn new() -> Self {
        Self {
            sent: [zeros(); REMEMBERED],
            place: 0,
            started: false,
        }
    }

    /// Sends `torque` and returns the one that acts in this cycle: sent
    /// `cycles` cycles ago, or `before` if that was before the first.
    #[inline]
    pub fn send(
        &mut self,
        cycles: u8,
        torque: &JointVector<T>,
        before: &JointVector<T>,
    ) -> JointVector<T> {
        let ago = usize::from(cycles).min(REMEMBERED);
        if ago == 0 {
            return *torque;
        }
        if !self.started {
            self.sent = [*before; REMEMBERED];
            self.started = true;
        }
        let acting = self.sent[(self.place + REMEMBERED - ago) % REMEMBERED];
        self.place %= REMEMBERED;
        self.sent[self.place] = *torque;
        self.place = (self.place + 1) % REMEMBERED;
        acting
    }
}

impl<T: Real> Default for Observer<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// tau_ext of (6) \[Nm\] from the residual: the torque that the arm exerts on its
/// environment. The one place where the sign changes, eq. (31).
#[must_use]
pub fn external_torque<T: Real>(residual: &JointVector<T>) -> JointVector<T> {
    -residual
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::Kinematics;
    use crate::model::{ArmModel, LWR_IV};

    #[test]
    fn a_corrected_torque_counts_like_an_applied_one() {
        let model = ArmModel::new(&LWR_IV).expect("the built-in arm");
        let state = JointState {
            q: JointVector::from([0.1, 0.6, -0.2, -1.4, 0.3, 1.0, 0.4]),
            dq: JointVector::from([0.3, -0.2, 0.1, 0.4, -0.5, 0.2, 1.0]),
        };
        let dynamics = Dynamics::new(&model, &Kinematics::new(&model, &state), &state);
        let (assumed, real) = (JointVector::repeat(3.0), JointVector::repeat(-2.5));
        let mut corrected = Observer::new();
        corrected.apply(&dynamics, &state, &assumed);
        corrected.correct(&real);
        let mut direct = Observer::new();
        direct.apply(&dynamics, &state, &real);
        // Rounding of a sum of torques of some ten Nm.
        assert!((corrected.input - direct.input).amax() < 1e-13);
        assert_eq!(corrected.torque, direct.torque);
        // Nothing changes when the assumption was right.
        corrected.correct(&real);
        assert_eq!(corrected.torque, direct.torque);
    }

    #[test]
    fn the_torque_that_acts_is_the_one_sent_that_many_cycles_ago() {
        for cycles in 0..=DEAD_CYCLES_MAX {
            let mut line = DeadTime::<f64>::new();
            let before = JointVector::repeat(-1.0);
            for k in 0..12u8 {
                let acting = line.send(cycles, &JointVector::repeat(f64::from(k)), &before);
                let expected = if k < cycles {
                    -1.0
                } else {
                    f64::from(k - cycles)
                };
                assert_eq!(acting, JointVector::repeat(expected), "{cycles} {k}");
            }
        }
    }
}
