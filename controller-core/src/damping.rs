//! Guard against a null-space damping that the sampled loop cannot carry.
//!
//! A joint-space damping D acts on the mass matrix M through a zero-order hold:
//! a mode of M^-1 D with the rate lambda is multiplied by 1 - h lambda every
//! cycle, which is unstable for h lambda > 2, and for h lambda > 1 where a cycle
//! of dead time lies between measurement and torque ([`bound`]). The wrist of the arm is so
//! light that ordinary values exceed this. M depends on the posture, so the
//! guard takes the largest rate over a fixed set of postures that contains, for
//! the damping of each single joint and for the reference damping, the worst
//! one found by a search over the whole joint range.

use crate::dynamics::Dynamics;
use crate::joint::{DOF, JointMatrix, JointState, JointVector, zeros};
use crate::kinematics::Kinematics;
use crate::linalg::{Cholesky, largest_eigenpair};
use crate::model::ArmModel;
use crate::real::Real;

/// What h lambda must stay below with `dead_cycles` cycles between measurement
/// and torque: 2 cos(d pi / (2 d + 1)), where z^(d+1) - z^d + h lambda = 0 leaves
/// the unit circle. 2 without dead time, 1 with one cycle, 0.618 with two.
#[must_use]
pub fn bound(dead_cycles: u8) -> f64 {
    let d = f64::from(dead_cycles);
    let (_, cosine) = (d * core::f64::consts::PI / (2.0 * d + 1.0)).sine_cosine();
    2.0 * cosine
}

/// Postures \[deg\] at which the damping is checked: the worst one found for the
/// reference damping, for the damping of each single joint and for equal
/// damping of all, then folded and wrist-aligned ones for damping matrices of
/// other shapes. The first joint has no influence. `tests/tests/damping.rs`
/// confirms on random postures that none is worse.
const POSTURES_DEG: [[f64; DOF]; 12] = [
    [0.0, 0.03, -6.85, -0.91, 1.38, 1.99, -2.53],
    [0.0, 0.01, 0.72, 0.1, -0.3, -2.72, -2.35],
    [0.0, 0.03, 0.0, 0.11, -0.29, -2.77, -2.31],
    [0.0, 0.03, -7.87, -0.76, 3.01, -0.72, -170.0],
    [0.0, 2.71, 1.91, 0.09, -0.54, -1.36, -2.83],
    [0.0, -0.04, -7.19, -0.35, -4.01, 1.2, 32.66],
    [0.0, 2.77, 1.94, 0.2, -0.28, -2.46, -0.05],
    [0.0, -0.12, 2.3, 0.59, -3.15, 0.14, 6.17],
    [0.0; DOF],
    [0.0, 60.0, 0.0, 120.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, -90.0, 0.0, 90.0, 0.0],
    [0.0, 90.0, 90.0, 90.0, 90.0, 0.0, 90.0],
];

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

/// The fastest mode over the set of postures.
#[must_use]
pub fn fastest_mode<T: Real>(model: &ArmModel<T>, damping: &JointMatrix<T>) -> DampingRate {
    let mut fastest = DampingRate {
        rate: 0.0,
        joint: 1,
        posture: [0.0; DOF],
    };
    // By reference: a copy of the set would lie on the stack.
    for posture in &POSTURES_DEG {
        let mode = mode_at(model, damping, posture.map(f64::to_radians));
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
    let factor = mass_factor(model, &posture);
    let (rate, joint) = fastest_of(&factor, damping);
    DampingRate {
        rate: rate.to_f64(),
        joint,
        posture,
    }
}

/// L of M = L L^T at a posture \[rad\]. Behind a call, as [`fastest_of`]: their work
/// sets take turns on the stack instead of lying there together.
#[inline(never)]
fn mass_factor<T: Real>(model: &ArmModel<T>, posture: &[f64; DOF]) -> Cholesky<T> {
    let state = JointState {
        q: JointVector::from(posture.map(T::from_f64)),
        dq: zeros(),
    };
    let kinematics = Kinematics::new(model, &state);
    Dynamics::new(model, &kinematics, &state).cholesky
}

/// lambda_max(L^-1 D L^-T) \[1/s\], and the joint, 1..=7, that dissipates most in
/// its mode.
#[inline(never)]
fn fastest_of<T: Real>(factor: &Cholesky<T>, damping: &JointMatrix<T>) -> (T, usize) {
    let (rate, whitened) = largest_eigenpair(&factor.whiten(damping));
    let mode = factor.solve_upper(&whitened);
    let power = mode.component_mul(&(damping * mode));
    let mut joint = 0;
    for i in 1..DOF {
        if power[i] > power[joint] {
            joint = i;
        }
    }
    (rate, joint + 1)
}
