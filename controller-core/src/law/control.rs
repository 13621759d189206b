//! What the cycle commands, and the torque that this demands. Exact form of (34), see
//! docs/hierarchy.md:
//!
//! ```text
//! y   = R^-1 b                                              task accelerations, by levels
//! w   = L^-T Q_t^T Q_t s,   F = R^-T Q_t s                  task part of dq, task momentum
//! f   = -C dq - C^T w + (dJ/dt)^T F + K_q (q_d - q) - D n   null-space force, n = dq - w
//! tau = L Q_t^T (y - Q_t L^-1 r) + L Q_n^T Q_n L^-1 f + C dq + g
//! ```

use super::hierarchy::Hierarchy;
use super::motion::MotionSplit;
use super::null_space::Compliance;
use crate::arm::dynamics::Dynamics;
use crate::joint::{JointVector, zeros};
use crate::real::Real;
use crate::task::rows::TaskRows;

/// Task accelerations and null-space force, before they become a torque. There is no
/// residual in them.
#[derive(Clone, Copy, Debug)]
pub struct Control<T: Real> {
    /// y = R^-1 b, whitened task accelerations; zeros behind the last row.
    pub task_acceleration: JointVector<T>,
    /// f \[Nm\]: joint-space force of which the null-space part acts.
    pub null_force: JointVector<T>,
}

impl<T: Real> Control<T> {
    /// Nothing commanded yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            task_acceleration: zeros(),
            null_force: zeros(),
        }
    }

    /// y and f, the latter towards a posture that is `posture_error` q_d - q \[rad\] away.
    #[inline]
    pub fn update(
        &mut self,
        compliance: &Compliance<T>,
        dynamics: &Dynamics<T>,
        rows: &TaskRows<T>,
        hierarchy: &Hierarchy<T>,
        motion: &MotionSplit<T>,
        posture_error: &JointVector<T>,
    ) {
        let transport = rows.rate_transposed_times(&motion.task_momentum);
        self.task_acceleration = hierarchy.solve(&rows.acceleration());
        self.null_force = transport
            - dynamics.coriolis
            - dynamics.coriolis_transpose_times(&motion.task_velocity)
            + compliance.stiffness * posture_error
            - compliance.damping.times(dynamics, &motion.null_velocity);
    }
}

impl<T: Real> Default for Control<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// The joint torque that the law asks for \[Nm\], before limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueDemand<T: Real>(pub JointVector<T>);

impl<T: Real> TorqueDemand<T> {
    /// The product's law: strict priorities, null-space compliance, `residual`
    /// \[Nm\] compensated on the task part; zero leaves external torque uncompensated.
    #[must_use]
    #[inline]
    pub fn compensating(
        dynamics: &Dynamics<T>,
        hierarchy: &Hierarchy<T>,
        control: &Control<T>,
        residual: &JointVector<T>,
    ) -> Self {
        let cholesky = &dynamics.cholesky;
        let whitened = Self::whitened(dynamics, hierarchy, control, residual);
        let torque = cholesky.lower_times(&hierarchy.rotate_back(&whitened));
        Self(torque + dynamics.coriolis + dynamics.gravity)
    }

    /// The demand less C dq + g in the coordinates of Q: entries 0..m belong to
    /// the task rows, in priority order, the others to the null space. The
    /// torque is L Q^T times this.
    #[must_use]
    #[inline]
    pub fn whitened(
        dynamics: &Dynamics<T>,
        hierarchy: &Hierarchy<T>,
        control: &Control<T>,
        residual: &JointVector<T>,
    ) -> JointVector<T> {
        let cholesky = &dynamics.cholesky;
        // Apart, so that what f asks of the tasks, much near a singularity, leaves no
        // rounding in their entries.
        let task = hierarchy.rotate(&cholesky.solve_lower(residual));
        let null = hierarchy.rotate(&cholesky.solve_lower(&control.null_force));
        hierarchy.joined(&(control.task_acceleration - task), &null)
    }
}
