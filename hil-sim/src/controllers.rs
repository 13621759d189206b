//! The controllers that are compared on equal terms: the product's law and
//! others, all inside the core's cycle with its checks, observer and limits.

use controller_core::hierarchy::Hierarchy;
use controller_core::joint::JointVector;
use controller_core::law::{Cycle, TorqueDemand};
use controller_core::linalg::Cholesky;

use crate::names::Named;

/// A torque law by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControllerKind {
    /// The product: strict priorities, compliant null space, residual
    /// compensated on the tasks.
    Hierarchical,
    /// The same with r = 0 in the law.
    NoObserver,
    /// Acceleration-level priorities (7)-(9), (12)-(14) with Moore-Penrose
    /// inverses: a null space with rate but without stiffness, and no estimate
    /// of the external torque.
    AccelerationLevel,
}

impl Named for ControllerKind {
    const THING: &'static str = "controller";
    const ALL: &'static [(&'static str, Self)] = &[
        ("hierarchical", Self::Hierarchical),
        ("no-observer", Self::NoObserver),
        ("acceleration-level", Self::AccelerationLevel),
    ];
}

impl ControllerKind {
    /// The torque demanded by this law. `rate_gain` is K of (14) \[1/s\] per
    /// joint, read by the acceleration-level law only.
    #[must_use]
    pub fn demand(self, cycle: &Cycle<'_, f64>, rate_gain: &JointVector<f64>) -> TorqueDemand<f64> {
        match self {
            Self::Hierarchical => TorqueDemand::hierarchical(cycle),
            Self::NoObserver => TorqueDemand::compensating(cycle, &JointVector::zeros()),
            Self::AccelerationLevel => acceleration_level(cycle, rate_gain),
        }
    }

    /// The joint torque \[Nm\] by which the residual changes the demand.
    #[must_use]
    pub fn residual_compensation(self, cycle: &Cycle<'_, f64>) -> JointVector<f64> {
        match self {
            Self::Hierarchical => {
                let (hierarchy, cholesky) = (cycle.hierarchy, &cycle.dynamics.cholesky);
                let whitened = hierarchy.rotate(&cholesky.solve_lower(cycle.residual));
                let task = hierarchy.rotate_back(&hierarchy.task_part(&whitened));
                -cholesky.lower_times(&task)
            }
            Self::NoObserver | Self::AccelerationLevel => JointVector::zeros(),
        }
    }
}

/// tau = M (sum of (J_i N)^# (b_i - J_i sum ddq_j) - N K dq) + C dq + g.
///
/// The hierarchy of Moore-Penrose inverses is the same row-ordered
/// factorisation, of J instead of J L^-T.
fn acceleration_level(cycle: &Cycle<'_, f64>, rate_gain: &JointVector<f64>) -> TorqueDemand<f64> {
    let hierarchy = Hierarchy::new(cycle.rows, &Cholesky::identity());
    let tasks = hierarchy.solve(&cycle.rows.acceleration());
    let braking = -rate_gain.component_mul(&cycle.state.dq);
    let null = hierarchy.null_part(&hierarchy.rotate(&braking));
    let ddq = hierarchy.rotate_back(&(tasks + null));
    let dynamics = cycle.dynamics;
    TorqueDemand(dynamics.mass_matrix * ddq + dynamics.coriolis + dynamics.gravity)
}
