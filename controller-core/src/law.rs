//! The control law: task accelerations in strict priority, compliance in what
//! is left, the residual compensated where tasks are tracked. Exact form of
//! (34), see docs/hierarchy.md.
//!
//! ```text
//! y   = R^-1 b                                              task accelerations, by levels
//! w   = L^-T Q_t^T Q_t s,   F = R^-T Q_t s                  task part of dq, task momentum
//! f   = -C dq - C^T w + (dJ/dt)^T F + K_q (q_d - q) - D n   null-space force, n = dq - w
//! tau = L Q_t^T (y - Q_t L^-1 r) + L Q_n^T Q_n L^-1 f + C dq + g
//! ```

use crate::dynamics::Dynamics;
use crate::hierarchy::Hierarchy;
use crate::joint::{JointMatrix, JointState, JointVector, zeros};
use crate::kinematics::Kinematics;
use crate::real::Real;
use crate::task::{MAX_ROWS, TaskRows};

/// Compliance of the null space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NullSpace<T: Real> {
    /// K_q \[Nm/rad\], symmetric positive definite; acts on torque.
    pub stiffness: JointMatrix<T>,
    /// D; acts on torque. Through K_l,d = Z D Z^T the torque does not depend on
    /// the choice of basis.
    pub damping: NullDamping<T>,
    /// Where q_d comes from.
    pub posture: Posture,
}

/// Damping of the null space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NullDamping<T: Real> {
    /// A constant D \[Nms/rad\], symmetric positive definite.
    Joint(JointMatrix<T>),
    /// D = c M(q) with c \[1/s\]: every null-space motion decays at the rate c, in
    /// every posture. For loops with dead time, where a constant D that damps
    /// the arm is too strong for the wrist.
    Inertia(T),
}

impl<T: Real> NullDamping<T> {
    /// D x \[Nm for x in rad/s\].
    #[inline]
    fn times(&self, dynamics: &Dynamics<T>, x: &JointVector<T>) -> JointVector<T> {
        match self {
            Self::Joint(damping) => damping * x,
            Self::Inertia(rate) => dynamics.mass_matrix * x * *rate,
        }
    }
}

/// Where the posture q_d of the null space comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub enum Posture {
    /// The posture of the reference.
    #[default]
    Constant,
    /// The integral (51) of the task part of the motion, dq_d = w, from the
    /// posture of the first reference. It drifts: with it the null space has no
    /// posture of its own.
    IntegralCoupled,
    /// (51) as printed, dq_d = sum of Jbar_i^# dx_i, without the coupling
    /// between moving levels.
    IntegralUncoupled,
}

/// The motion split in its task and null-space parts, (48).
#[derive(Clone, Copy, Debug)]
pub struct TaskMotion<T: Real> {
    /// w \[rad/s\]: the part of dq that the tasks see.
    pub task_velocity: JointVector<T>,
    /// n = dq - w \[rad/s\]: the part that no task sees, Jbar_l^# v.
    pub null_velocity: JointVector<T>,
    /// F \[kg m/s\] per row: the task momenta of the stack, Lambda dx.
    pub task_momentum: [T; MAX_ROWS],
}

impl<T: Real> TaskMotion<T> {
    /// Splits dq.
    #[must_use]
    #[inline]
    pub fn new(dynamics: &Dynamics<T>, hierarchy: &Hierarchy<T>, state: &JointState<T>) -> Self {
        let cholesky = &dynamics.cholesky;
        let whitened = hierarchy.task_part(&hierarchy.rotate(&cholesky.upper_times(&state.dq)));
        let task_velocity = cholesky.solve_upper(&hierarchy.rotate_back(&whitened));
        Self {
            task_velocity,
            null_velocity: state.dq - task_velocity,
            task_momentum: hierarchy.solve_transposed(&whitened),
        }
    }
}

/// What the cycle commands, before it becomes a torque.
#[derive(Clone, Copy, Debug)]
pub struct Command<T: Real> {
    /// y = R^-1 b, whitened task accelerations; zeros behind the last row.
    pub task_acceleration: JointVector<T>,
    /// f \[Nm\]: joint-space force of which the null-space part acts.
    pub null_force: JointVector<T>,
}

impl<T: Real> Command<T> {
    /// Task accelerations and null-space force towards `posture` q_d \[rad\].
    #[must_use]
    #[inline]
    pub fn new(
        null_space: &NullSpace<T>,
        dynamics: &Dynamics<T>,
        rows: &TaskRows<T>,
        hierarchy: &Hierarchy<T>,
        motion: &TaskMotion<T>,
        state: &JointState<T>,
        posture: &JointVector<T>,
    ) -> Self {
        let mut transport: JointVector<T> = zeros();
        for (row, &momentum) in rows.jacobian_dot.iter().zip(&motion.task_momentum) {
            transport += row * momentum;
        }
        Self {
            task_acceleration: hierarchy.solve(&rows.acceleration()),
            null_force: transport
                - dynamics.coriolis
                - dynamics.coriolis_transpose_times(&motion.task_velocity)
                + null_space.stiffness * (posture - state.q)
                - null_space.damping.times(dynamics, &motion.null_velocity),
        }
    }
}

/// Everything one cycle has computed when the law is applied.
#[derive(Clone, Copy, Debug)]
pub struct Cycle<'a, T: Real> {
    /// Measured joint state.
    pub state: &'a JointState<T>,
    /// Frames and their motion.
    pub kinematics: &'a Kinematics<T>,
    /// Equation of motion.
    pub dynamics: &'a Dynamics<T>,
    /// Stacked task rows.
    pub rows: &'a TaskRows<T>,
    /// Their factorisation.
    pub hierarchy: &'a Hierarchy<T>,
    /// Task and null-space parts of the motion.
    pub motion: &'a TaskMotion<T>,
    /// q_d \[rad\] of this cycle.
    pub posture: &'a JointVector<T>,
    /// Task accelerations and null-space force.
    pub command: &'a Command<T>,
    /// r \[Nm\].
    pub residual: &'a JointVector<T>,
}

/// The joint torque that the law asks for \[Nm\], before limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueDemand<T: Real>(pub JointVector<T>);

impl<T: Real> TorqueDemand<T> {
    /// The product's law: strict priorities, null-space compliance, residual
    /// compensated on the task part.
    #[must_use]
    #[inline]
    pub fn hierarchical(cycle: &Cycle<'_, T>) -> Self {
        Self::compensating(cycle, cycle.residual)
    }

    /// The same law with another torque in the place of r \[Nm\]; zero leaves
    /// external torque uncompensated.
    #[must_use]
    #[inline]
    pub fn compensating(cycle: &Cycle<'_, T>, residual: &JointVector<T>) -> Self {
        let Cycle {
            dynamics,
            hierarchy,
            ..
        } = cycle;
        let whitened = Self::whitened(cycle, residual);
        let cholesky = &dynamics.cholesky;
        let torque = cholesky.lower_times(&hierarchy.rotate_back(&whitened));
        Self(torque + dynamics.coriolis + dynamics.gravity)
    }

    /// The demand less C dq + g in the coordinates of Q: entries 0..m belong to
    /// the task rows, in priority order, the others to the null space. The
    /// torque is L Q^T times this.
    #[must_use]
    #[inline]
    pub fn whitened(cycle: &Cycle<'_, T>, residual: &JointVector<T>) -> JointVector<T> {
        let Cycle {
            dynamics,
            hierarchy,
            command,
            ..
        } = cycle;
        let cholesky = &dynamics.cholesky;
        // Apart, so that what f asks of the tasks, much near a singularity, leaves no
        // rounding in their entries.
        let task = hierarchy.rotate(&cholesky.solve_lower(residual));
        let null = hierarchy.rotate(&cholesky.solve_lower(&command.null_force));
        hierarchy.joined(&(command.task_acceleration - task), &null)
    }
}

/// q_d of the present cycle, and what an integrated posture remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PostureState<T: Real> {
    integral: Option<(JointVector<T>, JointVector<T>)>,
}

impl<T: Real> PostureState<T> {
    pub const fn new() -> Self {
        Self { integral: None }
    }

    /// q_d \[rad\]. Integrals use the trapezoidal rule over the measured interval.
    #[inline]
    pub fn update(
        &mut self,
        posture: Posture,
        reference: &JointVector<T>,
        interval_s: T,
        rate: impl FnOnce(Posture) -> JointVector<T>,
    ) -> JointVector<T> {
        if posture == Posture::Constant {
            return *reference;
        }
        let rate = rate(posture);
        let q_d = match self.integral {
            Some((q_d, last_rate)) => q_d + (rate + last_rate) * (T::HALF * interval_s),
            None => *reference,
        };
        self.integral = Some((q_d, rate));
        q_d
    }
}

/// dq_d of the integrated posture (51) \[rad/s\].
#[must_use]
#[inline]
pub fn posture_rate<T: Real>(
    posture: Posture,
    dynamics: &Dynamics<T>,
    rows: &TaskRows<T>,
    hierarchy: &Hierarchy<T>,
    motion: &TaskMotion<T>,
    state: &JointState<T>,
) -> JointVector<T> {
    match posture {
        Posture::Constant => zeros(),
        Posture::IntegralCoupled => motion.task_velocity,
        Posture::IntegralUncoupled => {
            let mut velocity = [T::ZERO; MAX_ROWS];
            for (velocity, row) in velocity.iter_mut().zip(&rows.jacobian) {
                *velocity = row.dot(&state.dq);
            }
            let whitened = hierarchy.solve_uncoupled(&velocity);
            dynamics
                .cholesky
                .solve_upper(&hierarchy.rotate_back(&whitened))
        }
    }
}
