//! Compliance of what the tasks leave: K_q, D, and c of D = c M.

use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::{DOF, JointMatrix, JointVector};
use controller_core::law::sampling::fastest_mode;
use nalgebra::SymmetricEigen;

/// Torque per rad of deflection as a share of the torque limit: a body that is pushed gives way by
/// 1 rad for a tenth of its torque. Chosen.
pub const TORQUE_SHARE: f64 = 0.1;

/// Fastest mode of the spring as a share of the largest rate of a damping: with critical damping
/// it has half of that rate.
const SPRING_SHARE: f64 = 0.25;

/// What a scenario says of the null space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliance {
    /// K_q \[Nm/rad\].
    pub stiffness: [f64; DOF],
    /// D \[Nms/rad\].
    pub damping: [f64; DOF],
    /// c \[1/s\].
    pub damping_rate: f64,
    /// Whether the lightness of the joint, not its torque, bounds its K_q.
    pub is_light: [bool; DOF],
    /// Whether the sampled loop, not critical damping, bounds its D.
    pub is_sampled: [bool; DOF],
}

/// `diagonal` with those entries made smaller that make modes of M^-1 times it faster than `most`.
fn within(model: &ArmModel<f64>, diagonal: [f64; DOF], most: f64) -> [f64; DOF] {
    let mut values = diagonal;
    loop {
        let mode = fastest_mode(model, &JointMatrix::from_diagonal(&values.into()));
        let share = most / mode.rate;
        if share >= 1.0 {
            return values;
        }
        if share > 0.97 {
            // What is left is shared by all.
            return values.map(|value| value * share);
        }
        values[mode.joint - 1] *= share;
    }
}

/// The middle one, of an even number the upper of both; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

impl Compliance {
    /// Of an arm with these mass matrices \[kg m2\] in postures all over its ranges. `direct`
    /// and `late` are the largest rates \[1/s\] of a damping D and of D = c M.
    #[must_use]
    pub fn of(
        arm: &ArmParameters,
        model: &ArmModel<f64>,
        mass_matrices: &[JointMatrix<f64>],
        [direct, late]: [f64; 2],
    ) -> Self {
        let by_torque = arm.links.map(|link| TORQUE_SHARE * link.torque_limit);
        let fastest = SPRING_SHARE * direct.min(late);
        let stiffness = within(model, by_torque, fastest * fastest);
        let critical = std::array::from_fn(|joint| {
            let inertias = mass_matrices.iter().map(|all| all[(joint, joint)]);
            2.0 * (stiffness[joint] * median(inertias.collect())).sqrt()
        });
        let damping = within(model, critical, direct);
        let spring = JointMatrix::from_diagonal(&JointVector::from(stiffness));
        let mut squares = Vec::new();
        for mass_matrix in mass_matrices {
            if let Some(factor) = mass_matrix.cholesky() {
                let inverse = factor.inverse();
                // Similar to L^-1 K L^-T.
                let half = spring.map(f64::sqrt);
                let modes = SymmetricEigen::new(half * inverse * half).eigenvalues;
                squares.extend(modes.iter().copied());
            }
        }
        let bounded = |all: [f64; DOF], by: [f64; DOF]| {
            // Beyond what is shared by all.
            std::array::from_fn(|joint| by[joint] < 0.95 * all[joint])
        };
        Self {
            stiffness,
            damping,
            damping_rate: (2.0 * median(squares).sqrt()).min(late),
            is_light: bounded(by_torque, stiffness),
            is_sampled: bounded(critical, damping),
        }
    }

    /// The same with no larger c than `rate` \[1/s\], its spring and D as much slower.
    #[must_use]
    pub fn within(&self, rate: f64) -> Self {
        let share = f64::min(1.0, rate / self.damping_rate);
        Self {
            stiffness: self.stiffness.map(|value| value * share * share),
            damping: self.damping.map(|value| value * share),
            damping_rate: self.damping_rate * share,
            ..*self
        }
    }
}
