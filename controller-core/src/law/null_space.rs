//! Compliance of what the tasks leave: stiffness, damping, posture.

use super::motion::MotionSplit;
use crate::arm::dynamics::Dynamics;
use crate::cells::Cells;
use crate::error::{ConfigError, Gain};
use crate::gain;
use crate::joint::{DOF, JointMatrix, JointVector, in_turn, zeros};
use crate::linalg::approach;
use crate::ranges::GAIN_MAX;
use crate::real::Real;
use crate::task::rows::TaskRows;

/// Compliance of the null space. Plain `f64` data, usable as a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NullSpace {
    /// K_q \[Nm/rad\] by rows, symmetric positive definite; acts on torque.
    pub stiffness: [[f64; DOF]; DOF],
    /// D; acts on torque. Through K_l,d = Z D Z^T the torque does not depend on
    /// the choice of basis.
    pub damping: NullDamping,
    /// Where q_d comes from.
    pub posture: Posture,
}

/// Damping of the null space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it in")]
pub enum NullDamping {
    /// A constant D \[Nms/rad\] by rows, symmetric positive definite.
    Joint([[f64; DOF]; DOF]),
    /// D = c M(q) with c \[1/s\]: every null-space motion decays at the rate c, in
    /// every posture. For loops with dead time, where a constant D that damps
    /// the arm is too strong for the wrist.
    Inertia(f64),
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

impl NullSpace {
    /// One `stiffness` \[Nm/rad\] and constant `damping` \[Nms/rad\] per joint, constant
    /// posture.
    #[must_use]
    pub const fn diagonal(stiffness: [f64; DOF], damping: [f64; DOF]) -> Self {
        Self {
            stiffness: gain::diagonal(stiffness),
            damping: NullDamping::Joint(gain::diagonal(damping)),
            posture: Posture::Constant,
        }
    }

    /// The same with K_q times `factor`.
    #[must_use]
    pub fn stiffened(&self, factor: f64) -> Self {
        Self {
            stiffness: self.stiffness.map(|row| row.map(|entry| entry * factor)),
            ..*self
        }
    }

    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        gain::validate(Gain::NullStiffness, 0, &self.stiffness, [true; DOF])?;
        match &self.damping {
            NullDamping::Joint(matrix) => gain::validate(Gain::NullDamping, 0, matrix, [true; DOF]),
            &NullDamping::Inertia(value) if value > 0.0 && value <= GAIN_MAX => Ok(()),
            &NullDamping::Inertia(value) => Err(ConfigError::InertiaDamping { value }),
        }
    }
}

/// The compliance in the precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliance<T: Real> {
    /// K_q \[Nm/rad\].
    pub stiffness: JointMatrix<T>,
    /// D.
    pub damping: Damping<T>,
    /// Where q_d comes from.
    pub posture: Posture,
    /// Whether K_q, and D, couple no joints: then [`Compliance::force`] reads their diagonals.
    decoupled: [bool; 2],
}

/// [`NullDamping`] in the precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping<T: Real> {
    /// D \[Nms/rad\].
    Joint(JointMatrix<T>),
    /// c \[1/s\] of D = c M.
    Inertia(T),
}

impl<T: Real> Compliance<T> {
    /// Of no null space.
    pub(crate) const NONE: Self = Self {
        stiffness: zeros(),
        damping: Damping::Inertia(T::ZERO),
        posture: Posture::Constant,
        decoupled: [false; 2],
    };

    /// Whether the damping of both is of the same kind.
    pub(crate) fn has_the_kind_of(&self, other: &Self) -> bool {
        core::mem::discriminant(&self.damping) == core::mem::discriminant(&other.damping)
    }

    /// On the way to another one joints are coupled as soon as either couples them.
    pub(crate) fn make_room_for(&mut self, other: &Self) {
        for (own, other) in self.decoupled.iter_mut().zip(other.decoupled) {
            *own &= other;
        }
    }

    /// A step towards another one of the same kind of damping: of the way there a share is `left`.
    pub(crate) fn approach(&mut self, other: &Self, left: T) {
        if left == T::ZERO {
            *self = *other;
            return;
        }
        approach(
            self.stiffness.as_mut_slice(),
            other.stiffness.as_slice(),
            left,
        );
        match (&mut self.damping, &other.damping) {
            (Damping::Joint(own), Damping::Joint(other)) => {
                approach(own.as_mut_slice(), other.as_slice(), left);
            }
            (Damping::Inertia(own), Damping::Inertia(other)) => {
                *own = *other + (*own - *other) * left;
            }
            _ => {}
        }
    }

    /// Behind a call, so that it is made in the place of the result.
    #[inline(never)]
    pub(crate) fn new(null_space: &NullSpace) -> Self {
        Self {
            stiffness: matrix(&null_space.stiffness),
            damping: match &null_space.damping {
                NullDamping::Joint(damping) => Damping::Joint(matrix(damping)),
                NullDamping::Inertia(rate) => Damping::Inertia(T::from_f64(*rate)),
            },
            posture: null_space.posture,
            decoupled: [
                gain::is_diagonal(&null_space.stiffness),
                match &null_space.damping {
                    NullDamping::Joint(damping) => gain::is_diagonal(damping),
                    NullDamping::Inertia(_) => false,
                },
            ],
        }
    }

    /// K_q, and D or c.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.numbers("null_stiffness", self.stiffness.as_mut_slice());
        match &mut self.damping {
            Damping::Joint(damping) => cells.numbers("null_damping", damping.as_mut_slice()),
            Damping::Inertia(rate) => cells.numbers("damping_rate", core::slice::from_mut(rate)),
        }
    }

    /// f \[Nm\] of [`Control`](super::control::Control), of the law within limits: into one vector
    /// without any of its terms as a vector of its own, and therefore rounded otherwise. Behind a
    /// call: with the stage around it its numbers do not fit into registers.
    #[inline(never)]
    pub(crate) fn force(
        &self,
        dynamics: &Dynamics<T>,
        rows: &TaskRows<T>,
        motion: &MotionSplit<T>,
        posture_error: &JointVector<T>,
    ) -> JointVector<T> {
        let (damping, rate) = match &self.damping {
            Damping::Joint(damping) => (damping, T::ONE),
            Damping::Inertia(rate) => (&dynamics.mass_matrix, *rate),
        };
        let [stiffness_decoupled, damping_decoupled] = self.decoupled;
        let mut force = rows.rate_transposed_times(&motion.task_momentum) - dynamics.coriolis;
        for j in 0..DOF {
            let velocity = motion.task_velocity[j];
            for i in 0..DOF {
                force[i] -= dynamics.coriolis_matrix[(j, i)] * velocity;
            }
        }
        add_product(
            &mut force,
            &self.stiffness,
            stiffness_decoupled,
            posture_error,
        );
        let opposed = motion.null_velocity * -rate;
        add_product(&mut force, damping, damping_decoupled, &opposed);
        force
    }
}

/// Adds a matrix times x; of one that couples no joints the diagonal.
#[inline(always)]
fn add_product<T: Real>(
    sum: &mut JointVector<T>,
    matrix: &JointMatrix<T>,
    decoupled: bool,
    x: &JointVector<T>,
) {
    if decoupled {
        for i in 0..DOF {
            sum[i] += matrix[(i, i)] * x[i];
        }
    } else {
        add_coupled(sum, matrix, x);
    }
}

/// Behind a call: it is in the flash once.
#[inline(never)]
pub(crate) fn add_coupled<T: Real>(
    sum: &mut JointVector<T>,
    matrix: &JointMatrix<T>,
    x: &JointVector<T>,
) {
    for j in 0..DOF {
        for i in 0..DOF {
            sum[i] += matrix[(i, j)] * x[j];
        }
    }
}

impl<T: Real> Damping<T> {
    /// D x \[Nm for x in rad/s\].
    #[inline]
    pub(crate) fn times(&self, dynamics: &Dynamics<T>, x: &JointVector<T>) -> JointVector<T> {
        match self {
            Self::Joint(damping) => damping * x,
            Self::Inertia(rate) => dynamics.mass_matrix * x * *rate,
        }
    }
}

/// A joint-space matrix from its rows. Behind a call: it is in the flash once.
#[inline(never)]
pub(crate) fn matrix<T: Real>(rows: &[[f64; DOF]; DOF]) -> JointMatrix<T> {
    let mut matrix = zeros();
    for i in in_turn::<DOF>(DOF) {
        for j in in_turn::<DOF>(DOF) {
            matrix[(i, j)] = T::from_f64(rows[i][j]);
        }
    }
    matrix
}

/// What an integrated posture remembers: q_d and its last rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PostureIntegral<T: Real> {
    last: Option<(JointVector<T>, JointVector<T>)>,
}

impl<T: Real> PostureIntegral<T> {
    pub const fn new() -> Self {
        Self { last: None }
    }

    /// q_d \[rad\] by the trapezoidal rule over the measured interval, from `start` on.
    #[inline]
    pub fn advance(
        &mut self,
        start: &JointVector<T>,
        rate: &JointVector<T>,
        interval_s: T,
    ) -> JointVector<T> {
        let q_d = match &self.last {
            Some((q_d, last_rate)) => q_d + (rate + last_rate) * (T::HALF * interval_s),
            None => *start,
        };
        self.last = Some((q_d, *rate));
        q_d
    }
}
