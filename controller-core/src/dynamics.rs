//! Mass matrix, Christoffel Coriolis matrix and gravity torque, eq. (6):
//! M ddq + C dq + g = tau - tau_ext.
//!
//! The sums run from flange to base over moments of mass about each joint's own
//! origin, so that a joint's own column has no lever arm and the small wrist
//! inertias do not drown in the large moments about the base.
//!
//! With J_p the velocity Jacobian of a mass element, M is the integral of
//! J_p^T J_p dm and the integral of J_p^T dJ_p/dt dm is the Christoffel form of
//! C: dM/dt = C + C^T holds without any further choice.

use crate::joint::{DOF, JointMatrix, JointState, JointVector, Vector3, zeros};
use crate::kinematics::Kinematics;
use crate::linalg::Cholesky;
use crate::model::ArmModel;
use crate::real::Real;
use crate::spatial::Moments;

/// Everything of the equation of motion (6) that depends on q and dq.
#[derive(Clone, Copy, Debug)]
pub struct Dynamics<T: Real> {
    /// M(q) \[kg m2\], symmetric, positive definite.
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

/// What the links from joint i outwards contribute to row and column i, as
/// force and moment about the origin of joint i.
struct JointWrench<T: Real> {
    /// Momentum for unit speed of joint i: moment and force of I S_i.
    inertia_moment: Vector3<T>,
    inertia_force: Vector3<T>,
    /// I dS_i + B S_i, the column i of C above the diagonal.
    rate_moment: Vector3<T>,
    rate_force: Vector3<T>,
    /// B^T S_i, a pure moment.
    transposed_rate: Vector3<T>,
}

impl<T: Real> Dynamics<T> {
    /// One pass from flange to base.
    #[must_use]
    #[inline]
    pub fn new(model: &ArmModel<T>, kinematics: &Kinematics<T>, state: &JointState<T>) -> Self {
        let k = kinematics;
        let mut mass_matrix = zeros();
        let mut coriolis_matrix = zeros();
        let mut gravity: JointVector<T> = zeros();
        let mut group = Moments::zero();

        for i in (0..DOF).rev() {
            let link = &model.links[i];
            let rotation = &k.rotation[i + 1];
            group.add_body(
                link.mass,
                &(rotation * link.first_moment),
                &(rotation * link.second_moment * rotation.transpose()),
                &k.origin_velocity[i + 1],
                &k.angular_velocity[i + 1],
            );
            group.shift(&(k.origin[i + 1] - k.origin[i]));

            let wrench = JointWrench::new(&group, k, i);
            gravity[i] = -model.gravity.dot(&wrench.inertia_force);
            wrench.project(k, i, &mut mass_matrix, &mut coriolis_matrix);
        }

        Self {
            cholesky: Cholesky::new(&mass_matrix),
            momentum: mass_matrix * state.dq,
            coriolis: coriolis_matrix * state.dq,
            mass_matrix,
            coriolis_matrix,
            gravity,
        }
    }

    /// C^T x \[Nm for x in rad/s\].
    #[must_use]
    #[inline]
    pub fn coriolis_transpose_times(&self, x: &JointVector<T>) -> JointVector<T> {
        self.coriolis_matrix.tr_mul(x)
    }
}

impl<T: Real> JointWrench<T> {
    /// Seen from the origin of joint i, S_i = (z, 0) and dS_i/dt = (dz, do x z).
    #[inline(always)]
    fn new(group: &Moments<T>, k: &Kinematics<T>, i: usize) -> Self {
        let axis = &k.axis[i];
        let axis_rate = &k.axis_rate[i];
        let slide = k.origin_velocity[i].cross(axis);
        let trace = group.rate.trace();
        Self {
            inertia_moment: group.inertia_times(axis),
            inertia_force: axis.cross(&group.first),
            rate_moment: group.inertia_times(axis_rate)
                + group.first.cross(&slide)
                + (axis * trace - group.rate * axis),
            rate_force: slide * group.mass
                + axis_rate.cross(&group.first)
                + axis.cross(&group.momentum),
            transposed_rate: axis * trace - group.rate.tr_mul(axis),
        }
    }

    /// Entries (i, j) and (j, i) for every joint j at or below i.
    #[inline(always)]
    fn project(
        &self,
        k: &Kinematics<T>,
        i: usize,
        mass_matrix: &mut JointMatrix<T>,
        coriolis_matrix: &mut JointMatrix<T>,
    ) {
        for j in 0..=i {
            let lever = k.origin[i] - k.origin[j];
            let axis = &k.axis[j];
            let moment = self.inertia_moment + lever.cross(&self.inertia_force);
            let inertia = axis.dot(&moment);
            mass_matrix[(i, j)] = inertia;
            mass_matrix[(j, i)] = inertia;

            let rate_moment = self.rate_moment + lever.cross(&self.rate_force);
            coriolis_matrix[(j, i)] = axis.dot(&rate_moment);
            if j < i {
                let slide = k.origin_velocity[j].cross(axis);
                coriolis_matrix[(i, j)] = moment.dot(&k.axis_rate[j])
                    + self.inertia_force.dot(&slide)
                    + self.transposed_rate.dot(axis);
            }
        }
    }
}
