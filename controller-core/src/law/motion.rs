//! The motion split in its task and null-space parts, (48).

use super::hierarchy::Hierarchy;
use crate::arm::dynamics::Dynamics;
use crate::joint::{JointState, JointVector, zeros};
use crate::ranges::{EXACT_ROWS, MAX_ROWS};
use crate::real::Real;
use crate::task::rows::TaskRows;

/// The two parts of dq, and the momenta of the tasks.
#[derive(Clone, Copy, Debug)]
pub struct MotionSplit<T: Real> {
    /// w \[rad/s\]: the part of dq that the tasks see.
    pub task_velocity: JointVector<T>,
    /// n = dq - w \[rad/s\]: the part that no task sees, Jbar_l^# v.
    pub null_velocity: JointVector<T>,
    /// F \[kg m/s\] per row: the task momenta of the stack, Lambda dx.
    pub task_momentum: [T; MAX_ROWS],
}

impl<T: Real> MotionSplit<T> {
    /// Nothing split yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            task_velocity: zeros(),
            null_velocity: zeros(),
            task_momentum: [T::ZERO; MAX_ROWS],
        }
    }

    /// Splits dq.
    #[inline]
    pub fn update(
        &mut self,
        dynamics: &Dynamics<T>,
        hierarchy: &Hierarchy<T>,
        joints: &JointState<T>,
    ) {
        let cholesky = &dynamics.cholesky;
        let whitened = hierarchy.task_part(&hierarchy.rotate(&cholesky.upper_times(&joints.dq)));
        self.task_velocity = cholesky.solve_upper(&hierarchy.rotate_back(&whitened));
        self.null_velocity = joints.dq - self.task_velocity;
        let momenta = hierarchy.solve_transposed(&whitened);
        for (momentum, of_row) in self.task_momentum.iter_mut().zip(momenta) {
            *momentum = of_row;
        }
    }

    /// sum of Jbar_i^# dx_i \[rad/s\]: the task velocity as (51) prints it, without the
    /// coupling between moving levels.
    #[must_use]
    pub fn uncoupled_task_velocity(
        dynamics: &Dynamics<T>,
        rows: &TaskRows<T>,
        hierarchy: &Hierarchy<T>,
        joints: &JointState<T>,
    ) -> JointVector<T> {
        let mut velocity = [T::ZERO; EXACT_ROWS];
        for (velocity, row) in velocity.iter_mut().zip(&rows.jacobian).take(rows.count()) {
            *velocity = row.dot(&joints.dq);
        }
        let whitened = hierarchy.solve_uncoupled(&velocity);
        dynamics
            .cholesky
            .solve_upper(&hierarchy.rotate_back(&whitened))
    }
}

impl<T: Real> Default for MotionSplit<T> {
    fn default() -> Self {
        Self::new()
    }
}
