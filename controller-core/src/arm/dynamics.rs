//! Mass matrix, Christoffel Coriolis matrix and gravity torque, eq. (6):
//! M ddq + C dq + g = tau - tau_ext.
//!
//! The sums run from flange to base over moments of mass in joint axes, about each
//! joint's own origin: a joint's own column has no lever arm, and the small wrist
//! inertias do not drown in the large moments about the base.
//!
//! With J_p the velocity Jacobian of a mass element, M is the integral of
//! J_p^T J_p dm and the integral of J_p^T dJ_p/dt dm is the Christoffel form of
//! C: dM/dt = C + C^T holds without any further choice.

use crate::arm::kinematics::Kinematics;
use crate::arm::model::ArmModel;
use crate::arm::moments::{AxisRate, JointWrench, Moments, Motion};
use crate::arm::transform::JointTransform;
use crate::joint::{DOF, JointMatrix, JointState, JointVector, zeros};
use crate::linalg::Cholesky;
use crate::real::Real;

/// Everything of the equation of motion (6) that depends on q and dq.
// In this order in memory: both matrices lie within reach of one base register.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Dynamics<T: Real> {
    /// M(q) \[kg m2\], rotors included, symmetric, positive definite.
    pub mass_matrix: JointMatrix<T>,
    /// C(q, dq) \[Nms/rad\], Christoffel form.
    pub coriolis_matrix: JointMatrix<T>,
    /// C dq \[Nm\].
    pub coriolis: JointVector<T>,
    /// g(q) \[Nm\]: the torque that holds the arm at rest.
    pub gravity: JointVector<T>,
    /// p = M dq, generalised momentum \[Nms\].
    pub momentum: JointVector<T>,
    /// M = L L^T.
    pub cholesky: Cholesky<T>,
}

impl<T: Real> Dynamics<T> {
    /// Nothing computed yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            mass_matrix: zeros(),
            coriolis_matrix: zeros(),
            coriolis: zeros(),
            gravity: zeros(),
            momentum: zeros(),
            cholesky: Cholesky::new(),
        }
    }

    /// One pass from flange to base.
    #[inline]
    pub fn update(
        &mut self,
        arm: &ArmModel<T>,
        kinematics: &Kinematics<T>,
        joints: &JointState<T>,
    ) {
        // From the frame of joint i to that of joint i - 1; before joint 1 lies the
        // base, whose link 0 has no length and no twist.
        let transform = |i: usize| JointTransform {
            sine: kinematics.sine[i],
            cosine: kinematics.cosine[i],
            link: if i == 0 { &arm.base } else { &arm.links[i - 1] },
        };
        let base = Motion {
            // At rest; as numbers, because arrays of constant zeros are cleared by calls.
            spin: kinematics.at_rest().into(),
            velocity: kinematics.at_rest().into(),
            gravity: arm.gravity.into(),
        };
        let mut motion = [base; DOF];
        let mut last = base;
        for i in 0..DOF {
            last = last.in_child(&transform(i), joints.dq[i]);
            motion[i] = last;
        }

        let Self {
            mass_matrix,
            coriolis_matrix,
            gravity,
            ..
        } = self;
        let mut group = Moments::zero();
        for i in (0..DOF).rev() {
            if i < DOF - 1 {
                group = group.in_parent(&transform(i + 1));
            }
            group.add_link(&arm.links[i], &motion[i]);
            let [gx, gy, _] = motion[i].gravity;
            gravity[i] = gx * group.first[1] - gy * group.first[0];

            let mut wrench = JointWrench::new(&group, &AxisRate::new(&motion[i]));
            mass_matrix[(i, i)] = wrench.rows[2][0];
            coriolis_matrix[(i, i)] = wrench.rows[2][1];
            for j in (0..i).rev() {
                wrench = wrench.in_parent(&transform(j + 1));
                let [x, y, z] = &wrench.rows;
                let AxisRate {
                    turn: [a, b],
                    slide: [u, v],
                } = AxisRate::new(&motion[j]);
                mass_matrix[(i, j)] = z[0];
                mass_matrix[(j, i)] = z[0];
                coriolis_matrix[(j, i)] = z[1];
                coriolis_matrix[(i, j)] =
                    (x[0] * a + y[0] * b) + (x[2] * u + y[2] * v) + wrench.transposed_rate[2];
            }
        }

        for i in 0..DOF {
            self.mass_matrix[(i, i)] += arm.rotor_inertia[i];
        }
        self.cholesky.update(&self.mass_matrix);
        self.momentum = self.mass_matrix * joints.dq;
        self.coriolis = self.coriolis_matrix * joints.dq;
    }

    /// C^T x \[Nm for x in rad/s\].
    #[must_use]
    #[inline]
    pub fn coriolis_transpose_times(&self, x: &JointVector<T>) -> JointVector<T> {
        self.coriolis_matrix.tr_mul(x)
    }
}

impl<T: Real> Default for Dynamics<T> {
    fn default() -> Self {
        Self::new()
    }
}
