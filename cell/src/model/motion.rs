//! Dynamics of a chain without any table: Newton and Euler in axes of the base, every joint a turn
//! about its line. It shares no formula with the core and the plant, and no frame.

use controller_core::joint::{DOF, JointMatrix, JointVector, Matrix3, Vector3};

use super::chain::Chain;
use super::frame::Frame;

/// What a chain does at one state.
#[derive(Clone, Debug)]
pub struct Motion {
    /// M \[kg m2\].
    pub mass_matrix: JointMatrix<f64>,
    /// C dq \[Nm\].
    pub coriolis: JointVector<f64>,
    /// g \[Nm\].
    pub gravity: JointVector<f64>,
    /// The last link, in the base.
    pub tip: Frame,
}

/// A joint and its body at a posture.
#[derive(Clone, Copy)]
struct Place {
    axis: Vector3<f64>,
    point: Vector3<f64>,
    mass: f64,
    com: Vector3<f64>,
    inertia: Matrix3<f64>,
}

impl Chain {
    /// At the posture `q` \[rad\] and the speed `dq` \[rad/s\] under `gravity` \[m/s2\].
    #[must_use]
    pub fn motion(
        &self,
        q: &JointVector<f64>,
        dq: &JointVector<f64>,
        gravity: &Vector3<f64>,
    ) -> Motion {
        let (places, carried) = self.places(q);
        let (rest, none) = (JointVector::zeros(), Vector3::zeros());
        let column = |joint: usize| {
            let mut ddq = JointVector::zeros();
            ddq[joint] = 1.0;
            torque(&places, &rest, &ddq, &none)
        };
        let columns: [JointVector<f64>; DOF] = std::array::from_fn(column);
        Motion {
            mass_matrix: JointMatrix::from_columns(&columns),
            coriolis: torque(&places, dq, &rest, &none),
            gravity: torque(&places, &rest, &rest, gravity),
            tip: carried.carrying(&self.tip),
        }
    }

    /// Joints and bodies at a posture, and what was at the base carried by all joints.
    fn places(&self, q: &JointVector<f64>) -> ([Place; DOF], Frame) {
        let mut carried = Frame::identity();
        let places = std::array::from_fn(|i| {
            let (joint, body) = (&self.joints[i], &self.bodies[i]);
            let (axis, point) = (carried.rotation * joint.axis, carried.place(&joint.point));
            carried = carried.carrying(&Frame::turn(&joint.axis, &joint.point, q[i]));
            let body = body.carried(&carried);
            Place {
                axis,
                point,
                mass: body.mass,
                com: body.com,
                inertia: body.inertia,
            }
        });
        (places, carried)
    }
}

/// Torque \[Nm\] that the motion takes: outward the accelerations, inward the moments.
fn torque(
    places: &[Place; DOF],
    dq: &JointVector<f64>,
    ddq: &JointVector<f64>,
    gravity: &Vector3<f64>,
) -> JointVector<f64> {
    let (mut spin, mut spin_rate) = (Vector3::zeros(), Vector3::zeros());
    // Of the material point of the link that is where `origin` is; a base that accelerates
    // upwards is gravity.
    let (mut acceleration, mut origin) = (-gravity, Vector3::zeros());
    let mut wrenches = [(Vector3::zeros(), Vector3::zeros()); DOF];
    for (i, place) in places.iter().enumerate() {
        let way = place.point - origin;
        acceleration += spin_rate.cross(&way) + spin.cross(&spin.cross(&way));
        origin = place.point;
        spin_rate += place.axis * ddq[i] + spin.cross(&place.axis) * dq[i];
        spin += place.axis * dq[i];
        let lever = place.com - origin;
        let force =
            (acceleration + spin_rate.cross(&lever) + spin.cross(&spin.cross(&lever))) * place.mass;
        let moment = place.inertia * spin_rate + spin.cross(&(place.inertia * spin));
        // About the base, where all of them can be added.
        wrenches[i] = (force, moment + place.com.cross(&force));
    }
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    let mut torque = JointVector::zeros();
    for (i, place) in places.iter().enumerate().rev() {
        force += wrenches[i].0;
        moment += wrenches[i].1;
        torque[i] = place.axis.dot(&(moment - place.point.cross(&force)));
    }
    torque
}
