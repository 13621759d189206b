//! The sampling bound: the largest null-space damping that the sampled loop carries.
//!
//! A joint-space damping D acts on the mass matrix M through a zero-order hold:
//! a mode of M^-1 D with the rate lambda is multiplied by 1 - h lambda every
//! cycle, which is unstable for h lambda > 2, and for h lambda > 1 where a cycle
//! of dead time lies between measurement and torque ([`bound`]). The wrist of the arm is so
//! light that ordinary values exceed this. M depends on the posture, so the
//! bound is taken as the largest rate over the ranges of the joints. A table may bring postures
//! that contain, for the damping of each single joint and for ordinary dampings, the worst
//! one found by a search over the whole joint range; without them the search runs for the
//! very damping when a controller is made (`search`). It takes at most some 7,000 mass
//! matrices: 40 ms on a workstation, on a Cortex-M7 0.5 thousand million instructions in `f64`
//! and 0.4 in `f32`, counted by QEMU: 1.3 and 1.0 s at 400 MHz and one per clock cycle, at most
//! 3.9 and 2.0 s by the borders of docs/timing.md. A table that must start faster brings postures.
//!
//! A search proves nothing. What other searches find is above the sampling bound by 0.3 % at
//! most for the arms of the crate `arms`, bare and with 2 kg (`tests/tests/damping_search.rs`).

use crate::arm::ArmModel;
use crate::joint::JointMatrix;
use crate::real::Real;

mod mode;
mod search;

pub(crate) use mode::set_mass_matrix;
pub use mode::{DampingRate, mode_at};
pub(crate) use search::ranges as posture_ranges;

/// What h lambda must stay below with `dead_cycles` cycles between measurement
/// and torque: 2 cos(d pi / (2 d + 1)), where z^(d+1) - z^d + h lambda = 0 leaves
/// the unit circle. 2 without dead time, 1 with one cycle, 0.618 with two. Behind a call: it is in
/// the flash once.
#[must_use]
#[inline(never)]
pub fn bound(dead_cycles: u8) -> f64 {
    let d = f64::from(dead_cycles);
    let (_, cosine) = (d * core::f64::consts::PI / (2.0 * d + 1.0)).sine_cosine();
    2.0 * cosine
}

/// The fastest mode over the postures of the arm, or by the search where it has none.
#[must_use]
pub fn fastest_mode<T: Real>(arm: &ArmModel<T>, damping: &JointMatrix<T>) -> DampingRate {
    if arm.damping_postures.is_empty() {
        return search::fastest_mode(arm, damping);
    }
    let mut fastest = mode::NONE;
    for posture in arm.damping_postures {
        fastest.raise(arm, damping, posture);
    }
    fastest
}
