//! The fastest mode of a damping at one posture.

use nalgebra::Matrix4;

use crate::arm::{ArmModel, LinkModel};
use crate::joint::{DOF, JointMatrix, in_turn, zeros};
use crate::law::null_space::add_coupled;
use crate::linalg::{Cholesky, largest_eigenpair};
use crate::real::Real;

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

/// Slower than any.
pub(super) const NONE: DampingRate = DampingRate {
    rate: 0.0,
    joint: 1,
    posture: [0.0; DOF],
};

impl DampingRate {
    /// That of another posture \[rad\] where it is faster. Behind a call: it is in the flash once.
    #[inline(never)]
    pub(super) fn raise<T: Real>(
        &mut self,
        arm: &ArmModel<T>,
        damping: &JointMatrix<T>,
        posture: &[f64; DOF],
    ) {
        let mode = mode_at(arm, damping, *posture);
        if mode.rate > self.rate {
            *self = mode;
        }
    }
}

/// The fastest mode at one posture \[rad\]. Behind a call: once in the flash, and its work set
/// is not on the stack of a search several times.
#[must_use]
#[inline(never)]
pub fn mode_at<T: Real>(
    arm: &ArmModel<T>,
    damping: &JointMatrix<T>,
    posture: [f64; DOF],
) -> DampingRate {
    let factor = mass_factor(arm, &posture);
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
fn mass_factor<T: Real>(arm: &ArmModel<T>, posture: &[f64; DOF]) -> Cholesky<T> {
    let mut mass_matrix = zeros();
    set_mass_matrix(arm, posture, &mut mass_matrix);
    let mut factor = Cholesky::new();
    factor.update(&mass_matrix);
    factor
}

/// M(q) \[kg m2\], its lower triangle, by homogeneous coordinates: few instructions in
/// loops where [`crate::arm::dynamics`] has fast ones in a row, which would have to be
/// in the flash a second time.
///
/// With P the integral of p p^T dm over all links behind joint i, p = (x, y, z, 1) in
/// the frame of the joint, unit speed of it gives H, the integral of p v^T dm with
/// v = (-y, x, 0, 0). Carried to the frame of joint j, H has the moment M_ij of the
/// momentum about z as H_xy - H_yx.
#[inline(never)]
pub(crate) fn set_mass_matrix<T: Real>(
    arm: &ArmModel<T>,
    posture: &[f64; DOF],
    mass_matrix: &mut JointMatrix<T>,
) {
    let mut group = Matrix4::zeros();
    let angle = |i: usize| T::from_f64(posture[i]) - arm.zero_angle[i];
    for i in (0..DOF).rev() {
        let [x, y, z, one] = &arm.links[i].moments;
        group += Matrix4::from_columns(&[*x, *y, *z, *one]);
        let mut velocity_moment = Matrix4::zeros();
        velocity_moment.set_column(0, &-group.column(1));
        velocity_moment.set_column(1, &group.column(0));
        mass_matrix[(i, i)] = velocity_moment.m12 - velocity_moment.m21 + arm.rotor_inertia[i];
        for j in (0..i).rev() {
            velocity_moment = in_parent(&arm.links[j], angle(j + 1), &velocity_moment);
            mass_matrix[(i, j)] = velocity_moment.m12 - velocity_moment.m21;
        }
        if i > 0 {
            group = in_parent(&arm.links[i - 1], angle(i), &group);
        }
    }
}

/// A X A^T with A from the frame of a joint to that of the joint before it: turned
/// about z by its `angle` \[rad\], then the twist and lengths of the `link` between.
#[inline(never)]
fn in_parent<T: Real>(link: &LinkModel<T>, angle: T, x: &Matrix4<T>) -> Matrix4<T> {
    let (sine, cosine) = angle.sine_cosine();
    let (zero, one) = (T::ZERO, T::ONE);
    let (sin_alpha, cos_alpha) = (link.sin_alpha, link.cos_alpha);
    let transform = Matrix4::new(
        cosine,
        -sine,
        zero,
        link.a,
        sine * cos_alpha,
        cosine * cos_alpha,
        -sin_alpha,
        zero,
        sine * sin_alpha,
        cosine * sin_alpha,
        cos_alpha,
        link.d,
        zero,
        zero,
        zero,
        one,
    );
    transform * x * transform.transpose()
}

/// lambda_max(L^-1 D L^-T) \[1/s\], and the joint, 1..=7, that dissipates most in
/// its mode.
#[inline(never)]
fn fastest_of<T: Real>(factor: &Cholesky<T>, damping: &JointMatrix<T>) -> (T, usize) {
    let (rate, whitened) = largest_eigenpair(&mut factor.whiten(damping));
    let mode = factor.solve_upper(&whitened);
    let mut torque = zeros();
    add_coupled(&mut torque, damping, &mode);
    let (mut most, mut joint) = (T::ZERO, 0);
    for i in in_turn::<DOF>(DOF) {
        let power = mode[i] * torque[i];
        if power > most {
            (most, joint) = (power, i);
        }
    }
    (rate, joint + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::ArmParameters;
    use crate::arm::dynamics::Dynamics;
    use crate::arm::kinematics::Kinematics;
    use crate::arm::test_arm::RODS;
    use crate::joint::{JointState, JointVector};

    /// Largest difference from the mass matrix of the cycle, relative to its size.
    fn difference<T: Real>(parameters: &ArmParameters) -> f64 {
        let arm = &ArmModel::<T>::new(parameters).expect("an arm");
        let mut worst = 0.0f64;
        for number in 0..24 {
            // The first one stretched, the others anywhere within a turn.
            let posture =
                core::array::from_fn(|i| 3.0 * libm::sin(f64::from(number) * (1.0 + i as f64)));
            let mut own = zeros();
            set_mass_matrix(arm, &posture, &mut own);
            let state = JointState {
                q: JointVector::from(posture.map(T::from_f64)),
                dq: zeros(),
            };
            let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
            kinematics.update(arm, &state);
            dynamics.update(arm, &kinematics, &state);
            let cycle = dynamics.mass_matrix;
            for i in 0..DOF {
                for j in 0..=i {
                    let size = (cycle[(i, i)] * cycle[(j, j)]).to_f64();
                    let off = (own[(i, j)] - cycle[(i, j)]).to_f64();
                    worst = worst.max(off.abs() / libm::sqrt(size));
                }
            }
        }
        worst
    }

    #[test]
    fn the_mass_matrix_of_the_postures_is_that_of_the_cycle() {
        // With lengths too, and with twists that are not right.
        let (mut long, mut skew) = (RODS, RODS);
        for i in 0..DOF {
            long.links[i].a = 0.02 * (1.0 + i as f64);
            skew.links[i].a = long.links[i].a;
            skew.links[i].alpha += 0.1 * (1.0 + i as f64);
        }
        // Entries that cancel are some ten times smaller than their terms; a few
        // dozen roundings.
        for arm in [&RODS, &long, &skew] {
            assert!(difference::<f64>(arm) < 1e3 * f64::EPSILON);
            assert!(difference::<f32>(arm) < 1e3 * f64::from(f32::EPSILON));
        }
    }
}
