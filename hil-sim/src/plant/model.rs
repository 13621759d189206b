//! The plant's model: geometry, masses, energies, and points of the arm.
//!
//! What is of a link: `body` in DH frames, `segment` in joint frames.

use controller_core::arm::ArmParameters;
use controller_core::joint::{DOF, JointState, JointVector, Matrix3, Vector3};

use super::body::{Body, Twist};
use super::segment::Segment;

/// Equations of motion of one arm, M ddq + C dq + g = torque, from its tables.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantModel {
    pub(super) links: [Body; DOF],
    /// The same links for [`PlantModel::equations`].
    pub(super) segments: [Segment; DOF],
    /// Gravitational acceleration \[m/s2\], base-plate axes.
    gravity: Vector3<f64>,
    /// The same in axes of frame 0.
    pub(super) base_gravity: Vector3<f64>,
    /// Frame 0 in the base-plate frame.
    base_rotation: Matrix3<f64>,
    base_shift: Vector3<f64>,
}

/// Axes and origins of the joints below one link, and that link's frame, all in
/// the base-plate frame. Joints beyond the link have a zero axis: they do not
/// move it.
struct Chain {
    axes: [Vector3<f64>; DOF],
    origins: [Vector3<f64>; DOF],
    rotation: Matrix3<f64>,
    origin: Vector3<f64>,
}

impl Chain {
    fn point(&self, offset: &Vector3<f64>) -> Vector3<f64> {
        self.origin + self.rotation * offset
    }

    /// Velocity of `point` \[m\] per speed of joint `i`.
    fn column(&self, i: usize, point: &Vector3<f64>) -> Vector3<f64> {
        self.axes[i].cross(&(point - self.origins[i]))
    }
}

impl PlantModel {
    /// Model of the arm in `parameters`, which must describe bodies of positive
    /// mass and inertia.
    #[must_use]
    pub fn new(parameters: &ArmParameters) -> Self {
        // nalgebra takes columns.
        let base_rotation = Matrix3::from(parameters.base.rotation).transpose();
        let gravity = Vector3::from(parameters.gravity);
        let links = parameters.links.map(|link| Body::new(&link));
        Self {
            segments: Segment::of(&links),
            links,
            gravity,
            base_gravity: base_rotation.tr_mul(&gravity),
            base_rotation,
            base_shift: parameters.base.shift.into(),
        }
    }

    /// Position \[m\] and velocity \[m/s\], base-plate frame, of the point at
    /// `offset` \[m\] in the DH frame of `link` (1..=7; 0 is the fixed frame 0,
    /// above 7 counts as 7).
    #[must_use]
    pub fn point(
        &self,
        state: &JointState<f64>,
        link: usize,
        offset: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let chain = self.chain(&state.q, link);
        let point = chain.point(offset);
        let velocity = (0..DOF).fold(Vector3::zeros(), |sum, i| {
            sum + chain.column(i, &point) * state.dq[i]
        });
        (point, velocity)
    }

    /// Rotation from the DH frame of `link` (as in [`PlantModel::point`]) to the base-plate
    /// frame in the posture `q` \[rad\].
    #[must_use]
    pub fn orientation(&self, q: &JointVector<f64>, link: usize) -> Matrix3<f64> {
        self.chain(q, link).rotation
    }

    /// Joint torque J^T F \[Nm\], positive along +q, of the force `force` \[N\],
    /// base-plate axes, that acts on the arm at `offset` \[m\] in the DH frame of
    /// `link` (as in [`PlantModel::point`]).
    #[must_use]
    pub fn point_torque(
        &self,
        q: &JointVector<f64>,
        link: usize,
        offset: &Vector3<f64>,
        force: &Vector3<f64>,
    ) -> JointVector<f64> {
        let chain = self.chain(q, link);
        let point = chain.point(offset);
        JointVector::from_fn(|i, _| chain.column(i, &point).dot(force))
    }

    /// Kinetic energy \[J\].
    #[must_use]
    pub fn kinetic_energy(&self, state: &JointState<f64>) -> f64 {
        let mut twist = Twist::REST;
        let mut twice = 0.0;
        for (i, link) in self.links.iter().enumerate() {
            twist = link.twist(&twist, &link.rotation(state.q[i]), state.dq[i]);
            let (angular, linear) = link.momentum(&twist);
            twice += twist.angular.dot(&angular) + twist.linear.dot(&linear);
            twice += link.rotor_inertia * state.dq[i] * state.dq[i];
        }
        0.5 * twice
    }

    /// Potential energy of gravity \[J\], 0 with all mass at the mounting plate.
    #[must_use]
    pub fn potential_energy(&self, q: &JointVector<f64>) -> f64 {
        let mut rotation = self.base_rotation;
        let mut origin = self.base_shift;
        let mut energy = 0.0;
        for (i, link) in self.links.iter().enumerate() {
            rotation *= link.rotation(q[i]);
            origin += rotation * link.reach;
            energy -= link.mass * self.gravity.dot(&(origin + rotation * link.com));
        }
        energy
    }

    /// Gravity torque g(q) \[Nm\]: what the motors must give to hold the arm at
    /// `q` \[rad\].
    #[must_use]
    pub fn gravity_torque(&self, q: &JointVector<f64>) -> JointVector<f64> {
        let mut torque = JointVector::zeros();
        for (number, link) in (1..).zip(&self.links) {
            torque -= self.point_torque(q, number, &link.com, &(self.gravity * link.mass));
        }
        torque
    }

    /// The same arm where nothing has weight.
    pub(crate) fn weightless(&self) -> Self {
        Self {
            gravity: Vector3::zeros(),
            base_gravity: Vector3::zeros(),
            ..self.clone()
        }
    }

    fn chain(&self, q: &JointVector<f64>, link: usize) -> Chain {
        let mut chain = Chain {
            axes: [Vector3::zeros(); DOF],
            origins: [Vector3::zeros(); DOF],
            rotation: self.base_rotation,
            origin: self.base_shift,
        };
        for (i, link) in self.links.iter().enumerate().take(link) {
            chain.axes[i] = chain.rotation.column(2).into_owned();
            chain.origins[i] = chain.origin;
            let (s, c) = link.sine_cosine(q[i]);
            chain.origin += chain.rotation * Vector3::new(link.a * c, link.a * s, link.d);
            chain.rotation *= link.rotation(q[i]);
        }
        chain
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::LWR_IV;

    #[test]
    fn the_upright_arm_reaches_straight_up() {
        let model = PlantModel::new(&LWR_IV);
        let state = JointState {
            q: JointVector::zeros(),
            dq: JointVector::from([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        };
        let height = 0.3105 + 0.4 + 0.39 + 0.078;
        let (point, velocity) = model.point(&state, 7, &Vector3::new(0.0, 0.0, 0.078));
        assert!((point - Vector3::new(0.0, 0.0, height)).amax() < 1e-15);
        assert!(velocity.amax() < 1e-15);
        let (base, _) = model.point(&state, 0, &Vector3::zeros());
        assert_eq!(base, Vector3::new(0.0, 0.0, 0.3105));
    }

    #[test]
    fn geometry_with_a_dh_length_is_right() {
        // A planar arm of two unit links with parallel axes.
        let mut arm = LWR_IV;
        for link in &mut arm.links {
            (link.a, link.alpha, link.d) = (0.0, 0.0, 0.0);
        }
        arm.base = controller_core::arm::Pose::IDENTITY;
        arm.links[0].a = 1.0;
        arm.links[1].a = 1.0;
        let model = PlantModel::new(&arm);
        let mut state = JointState {
            q: JointVector::zeros(),
            dq: JointVector::zeros(),
        };
        state.q[1] = core::f64::consts::FRAC_PI_2;
        (state.dq[0], state.dq[1]) = (1.0, 2.0);
        let (point, velocity) = model.point(&state, 2, &Vector3::zeros());
        assert!((point - Vector3::new(1.0, 1.0, 0.0)).amax() < 1e-15);
        assert!((velocity - Vector3::new(-3.0, 1.0, 0.0)).amax() < 1e-15);
        let torque =
            model.point_torque(&state.q, 2, &Vector3::zeros(), &Vector3::new(1.0, 0.0, 0.0));
        assert!((torque[0] + 1.0).abs() < 1e-15 && (torque[1] + 1.0).abs() < 1e-15);
        // The velocity recursion of the dynamics agrees: m v^2 / 2 of a point mass.
        for link in &mut arm.links {
            (link.mass, link.com, link.inertia) = (0.0, [0.0; 3], [0.0; 6]);
        }
        arm.links[1].mass = 2.0;
        let energy = PlantModel::new(&arm).kinetic_energy(&state);
        assert!((energy - 10.0).abs() < 1e-14, "{energy}");
    }

    #[test]
    fn forces_and_velocities_are_dual() {
        let model = PlantModel::new(&LWR_IV);
        let state = JointState {
            q: JointVector::from([0.4, -0.9, 1.3, 0.6, -2.0, 1.1, 0.2]),
            dq: JointVector::from([0.5, -0.3, 0.8, 1.0, -0.6, 0.2, 2.0]),
        };
        let (offset, force) = (
            Vector3::new(0.1, -0.19, 0.05),
            Vector3::new(3.0, -7.0, 11.0),
        );
        for link in 1..=DOF {
            let (_, velocity) = model.point(&state, link, &offset);
            let torque = model.point_torque(&state.q, link, &offset, &force);
            assert!((torque.dot(&state.dq) - force.dot(&velocity)).abs() < 1e-13);
            assert!(torque.iter().skip(link).all(|&beyond| beyond == 0.0));
        }
    }
}
