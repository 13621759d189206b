//! Forward dynamics by the articulated-body algorithm (Featherstone), spatial
//! vectors in link axes about the link's origin.
//!
//! It shares neither frames nor method with [`super::composite`], nor with the controller's
//! model: what tests hold both against. No run uses it.

use controller_core::joint::{DOF, JointVector, Matrix3, Vector3};

use super::body::{Body, Twist};
use super::model::PlantModel;

/// An inertia that need not be a rigid body's: the force on the handle of a
/// chain per acceleration of the handle, by 3 x 3 blocks.
///
/// moment = rotational * angular + coupling * linear,
/// force = coupling^T * angular + translational * linear.
#[derive(Clone, Copy)]
struct ArticulatedInertia {
    rotational: Matrix3<f64>,
    coupling: Matrix3<f64>,
    translational: Matrix3<f64>,
}

/// Moment about the link's origin and force, link axes.
#[derive(Clone, Copy)]
struct Wrench {
    moment: Vector3<f64>,
    force: Vector3<f64>,
}

/// What the outward pass needs of a joint.
#[derive(Clone, Copy)]
struct Joint {
    rotation: Matrix3<f64>,
    /// Velocity-product acceleration of the link.
    drift: Twist,
    /// Force that one rad/s2 of the joint takes: column of the inertia.
    column: Wrench,
    /// Torque left for the joint after the bias of what it carries.
    torque: f64,
    /// 1 / (inertia the joint feels).
    mobility: f64,
}

#[inline]
fn skew(v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// R S R^T of a symmetric S: six of nine elements are computed.
#[inline]
fn rotate_symmetric(r: &Matrix3<f64>, s: &Matrix3<f64>) -> Matrix3<f64> {
    let half = r * s;
    let element = |i: usize, j: usize| {
        half[(i, 0)] * r[(j, 0)] + half[(i, 1)] * r[(j, 1)] + half[(i, 2)] * r[(j, 2)]
    };
    let (xx, yy, zz) = (element(0, 0), element(1, 1), element(2, 2));
    let (xy, xz, yz) = (element(0, 1), element(0, 2), element(1, 2));
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

impl ArticulatedInertia {
    fn rigid(link: &Body) -> Self {
        Self {
            rotational: link.inertia,
            coupling: skew(&link.first_moment),
            translational: Matrix3::from_diagonal_element(link.mass),
        }
    }

    #[inline]
    fn times(&self, motion: &Twist) -> Wrench {
        Wrench {
            moment: self.rotational * motion.angular + self.coupling * motion.linear,
            force: self.coupling.tr_mul(&motion.angular) + self.translational * motion.linear,
        }
    }

    /// What is left when a joint gives way along `column`.
    #[inline]
    fn released(&self, column: &Wrench, mobility: f64) -> Self {
        let (moment, force) = (column.moment * mobility, column.force * mobility);
        Self {
            rotational: self.rotational - moment * column.moment.transpose(),
            coupling: self.coupling - moment * column.force.transpose(),
            translational: self.translational - force * column.force.transpose(),
        }
    }

    /// The same inertia seen from the previous link's frame. The shift comes
    /// first, in link axes, where the vector back is constant.
    #[inline]
    fn carried(&self, link: &Body, rotation: &Matrix3<f64>) -> Self {
        let reach = skew(&link.reach);
        let coupling = self.coupling + reach * self.translational;
        // Both products are needed: only their sum is symmetric.
        let rotational = self.rotational + reach * self.coupling.transpose() - coupling * reach;
        Self {
            rotational: rotate_symmetric(rotation, &rotational),
            coupling: rotation * coupling * rotation.transpose(),
            translational: rotate_symmetric(rotation, &self.translational),
        }
    }

    #[inline]
    fn add(&mut self, other: &Self) {
        self.rotational += other.rotational;
        self.coupling += other.coupling;
        self.translational += other.translational;
    }
}

impl Wrench {
    #[inline]
    fn carried(&self, link: &Body, rotation: &Matrix3<f64>) -> Self {
        Self {
            moment: rotation * (self.moment + link.reach.cross(&self.force)),
            force: rotation * self.force,
        }
    }

    /// Part that a joint feels (or power, for a twist of one).
    #[inline]
    fn along(&self, angular: &Vector3<f64>, linear: &Vector3<f64>) -> f64 {
        self.moment.dot(angular) + self.force.dot(linear)
    }
}

impl PlantModel {
    /// As [`PlantModel::forward_dynamics`], by articulated bodies: joint accelerations
    /// \[rad/s2\] at `q` \[rad\] and `dq` \[rad/s\] under `torque` \[Nm\], with `armature`
    /// \[kg m2\] on the diagonal of M.
    #[must_use]
    pub fn articulated_bodies(
        &self,
        q: &JointVector<f64>,
        dq: &JointVector<f64>,
        torque: &JointVector<f64>,
        armature: &JointVector<f64>,
    ) -> JointVector<f64> {
        // Outward: velocities, and the force each link alone takes to keep them.
        let mut twist = Twist::REST;
        let mut joints = [Joint {
            rotation: Matrix3::zeros(),
            drift: Twist::REST,
            column: Wrench::ZERO,
            torque: 0.0,
            mobility: 0.0,
        }; DOF];
        let mut bias = [Wrench::ZERO; DOF];
        for (i, link) in self.links.iter().enumerate() {
            let rotation = link.rotation(q[i]);
            twist = link.twist(&twist, &rotation, dq[i]);
            let (axis, lever) = (link.axis * dq[i], link.lever * dq[i]);
            joints[i].rotation = rotation;
            joints[i].drift = Twist {
                angular: twist.angular.cross(&axis),
                linear: twist.angular.cross(&lever) + twist.linear.cross(&axis),
            };
            let (angular, linear) = link.momentum(&twist);
            bias[i] = Wrench {
                moment: twist.angular.cross(&angular) + twist.linear.cross(&linear),
                force: twist.angular.cross(&linear),
            };
        }

        // Inward: what each joint carries, as inertia and bias.
        let mut inertia = ArticulatedInertia::rigid(&self.links[DOF - 1]);
        let mut load = bias[DOF - 1];
        for i in (0..DOF).rev() {
            let (link, joint) = (&self.links[i], &mut joints[i]);
            joint.column = inertia.times(&Twist {
                angular: link.axis,
                linear: link.lever,
            });
            let felt = joint.column.along(&link.axis, &link.lever) + link.rotor_inertia;
            joint.mobility = 1.0 / (felt + armature[i]);
            joint.torque = torque[i] - load.along(&link.axis, &link.lever);
            if i == 0 {
                break;
            }
            let released = inertia.released(&joint.column, joint.mobility);
            let moved = released.times(&joint.drift);
            let share = joint.mobility * joint.torque;
            let carried = Wrench {
                moment: load.moment + moved.moment + joint.column.moment * share,
                force: load.force + moved.force + joint.column.force * share,
            }
            .carried(link, &joint.rotation);
            inertia = ArticulatedInertia::rigid(&self.links[i - 1]);
            inertia.add(&released.carried(link, &joint.rotation));
            load = Wrench {
                moment: bias[i - 1].moment + carried.moment,
                force: bias[i - 1].force + carried.force,
            };
        }

        // Outward: gravity is a base that accelerates upwards.
        let mut acceleration = Twist {
            angular: Vector3::zeros(),
            linear: -self.base_gravity,
        };
        let mut ddq = JointVector::zeros();
        for (i, (link, joint)) in self.links.iter().zip(&joints).enumerate() {
            let mut next = link.twist(&acceleration, &joint.rotation, 0.0);
            next.angular += joint.drift.angular;
            next.linear += joint.drift.linear;
            ddq[i] =
                joint.mobility * (joint.torque - joint.column.along(&next.angular, &next.linear));
            acceleration = Twist {
                angular: next.angular + link.axis * ddq[i],
                linear: next.linear + link.lever * ddq[i],
            };
        }
        ddq
    }
}

impl Wrench {
    const ZERO: Self = Self {
        moment: Vector3::new(0.0, 0.0, 0.0),
        force: Vector3::new(0.0, 0.0, 0.0),
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::LWR_IV;
    use controller_core::joint::JointState;

    /// Two unit point masses on massless unit links with parallel axes, the
    /// textbook double pendulum; joints 3 to 7 carry nothing and are held by
    /// armature.
    #[test]
    fn double_pendulum() {
        let mut arm = LWR_IV;
        for link in &mut arm.links {
            (link.a, link.alpha, link.d) = (0.0, 0.0, 0.0);
            (link.mass, link.com, link.inertia) = (0.0, [0.0; 3], [0.0; 6]);
        }
        arm.gravity = [9.81, 0.0, 0.0];
        for link in &mut arm.links[..2] {
            (link.a, link.mass) = (1.0, 1.0);
        }
        let model = PlantModel::new(&arm);
        let mut armature = JointVector::from_element(1.0);
        armature.fixed_rows_mut::<2>(0).fill(0.0);
        let (q1, q2, w1, w2) = (0.7, -1.9, 1.3, 0.4);
        let state = JointState {
            q: JointVector::from([q1, q2, 0.0, 0.0, 0.0, 0.0, 0.0]),
            dq: JointVector::from([w1, w2, 0.0, 0.0, 0.0, 0.0, 0.0]),
        };
        let torque = JointVector::from([0.3, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let ddq = model.articulated_bodies(&state.q, &state.dq, &torque, &armature);

        let (s2, c2) = (libm::sin(q2), libm::cos(q2));
        let m = [[3.0 + 2.0 * c2, 1.0 + c2], [1.0 + c2, 1.0]];
        let weight = 9.81 * libm::sin(q1 + q2);
        let right = [
            torque[0] + s2 * (2.0 * w1 * w2 + w2 * w2) - 2.0 * 9.81 * libm::sin(q1) - weight,
            torque[1] - s2 * w1 * w1 - weight,
        ];
        for row in 0..2 {
            let left = m[row][0] * ddq[0] + m[row][1] * ddq[1];
            assert!((left - right[row]).abs() < 1e-13, "{left} {}", right[row]);
        }
    }

    #[test]
    fn armature_adds_to_the_diagonal() {
        let model = PlantModel::new(&LWR_IV);
        let q = JointVector::from([0.4, -0.9, 1.3, 0.6, -2.0, 1.1, 0.2]);
        let dq = JointVector::from([0.5, -0.3, 0.8, 1.0, -0.6, 0.2, 2.0]);
        let torque = JointVector::from([5.0, -20.0, 3.0, 10.0, 1.0, -0.5, 0.02]);
        let armature = JointVector::from([0.3, 0.1, 0.02, 0.2, 0.01, 0.05, 0.001]);
        let with = model.articulated_bodies(&q, &dq, &torque, &armature);
        // The same motion without it takes that much less torque.
        let reduced = torque - armature.component_mul(&with);
        let without = model.articulated_bodies(&q, &dq, &reduced, &JointVector::zeros());
        assert!((with - without).amax() < 1e-10 * with.amax());
    }
}
