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

use crate::arm::dynamics::Dynamics;
use crate::cells::Cells;
use crate::joint::{DOF, JointState, JointVector, zeros};
use crate::real::Real;

/// What the observer remembers from the previous cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer<T: Real> {
    /// p_(k-1) \[Nms\].
    pub momentum: JointVector<T>,
    /// u_(k-1) = tau + C^T dq - g \[Nm\], tau as it was applied.
    pub input: JointVector<T>,
    /// tau in that input \[Nm\].
    pub applied_torque: JointVector<T>,
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
            applied_torque: zeros(),
            residual: zeros(),
            started: false,
        }
    }

    /// What it remembers.
    pub(super) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.numbers("momentum", self.momentum.as_mut_slice());
        cells.numbers("observer_input", self.input.as_mut_slice());
        cells.numbers("applied_torque", self.applied_torque.as_mut_slice());
        cells.numbers("residual", self.residual.as_mut_slice());
        cells.flag("started", &mut self.started);
    }

    /// One step with `gain` K_I \[1/s\] per joint, the measured interval h \[s\] > 0
    /// and the present momentum \[Nms\]. Afterwards `residual` is r \[Nm\], which tends to
    /// -tau_ext: positive where the environment pushes the joint forward.
    #[inline]
    pub fn update(&mut self, gain: &JointVector<T>, interval_s: T, momentum: &JointVector<T>) {
        if self.started {
            let rate = T::ONE / interval_s;
            // Most often all joints have one gain, and what decays by the other is the same.
            let (mut last, mut decay) = (T::ZERO, T::ONE);
            for i in 0..DOF {
                let innovation = (momentum[i] - self.momentum[i]) * rate - self.input[i];
                if gain[i] != last {
                    (last, decay) = (gain[i], (gain[i] * interval_s).exp_negative());
                }
                self.residual[i] = decay * self.residual[i] + (T::ONE - decay) * innovation;
            }
        }
        self.momentum = *momentum;
        self.started = true;
    }

    /// Keeps u of this cycle for the next [`Observer::update`]. `torque` \[Nm\] is the
    /// one that reaches the joints, after limits.
    #[inline]
    pub fn set_input(
        &mut self,
        dynamics: &Dynamics<T>,
        state: &JointState<T>,
        torque: &JointVector<T>,
    ) {
        self.input = torque + dynamics.coriolis_transpose_times(&state.dq) - dynamics.gravity;
        self.applied_torque = *torque;
    }

    /// Replaces the torque \[Nm\] in the input kept by [`Observer::set_input`].
    pub fn set_applied_torque(&mut self, torque: &JointVector<T>) {
        // Number by number: a vector from elsewhere is moved by a call.
        for i in 0..DOF {
            self.input[i] += torque[i] - self.applied_torque[i];
            self.applied_torque[i] = torque[i];
        }
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
    use crate::arm::ArmModel;
    use crate::arm::kinematics::Kinematics;
    use crate::arm::test_arm::RODS;

    #[test]
    fn a_corrected_torque_counts_like_an_applied_one() {
        let arm = ArmModel::new(&RODS).expect("an arm");
        let state = JointState {
            q: JointVector::from([0.1, 0.6, -0.2, -1.4, 0.3, 1.0, 0.4]),
            dq: JointVector::from([0.3, -0.2, 0.1, 0.4, -0.5, 0.2, 1.0]),
        };
        let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
        kinematics.update(&arm, &state);
        dynamics.update(&arm, &kinematics, &state);
        let (assumed, real) = (JointVector::repeat(3.0), JointVector::repeat(-2.5));
        let mut corrected = Observer::new();
        corrected.set_input(&dynamics, &state, &assumed);
        corrected.set_applied_torque(&real);
        let mut direct = Observer::new();
        direct.set_input(&dynamics, &state, &real);
        // Rounding of a sum of torques of some ten Nm.
        assert!((corrected.input - direct.input).amax() < 1e-13);
        assert_eq!(corrected.applied_torque, direct.applied_torque);
        // Nothing changes when the assumption was right.
        corrected.set_applied_torque(&real);
        assert_eq!(corrected.applied_torque, direct.applied_torque);
    }
}
