//! What the robot knows of itself: kinematics and dynamics from the nominal
//! tables. It shares no method with the controller's model.

use controller_core::arm::{ArmParameters, Pose};
use controller_core::joint::{DOF, JointMatrix, JointState, JointVector, Vector3};
use nalgebra::{SMatrix, SVector};

use crate::arm_points::angular_velocity;
use crate::plant::PlantModel;

/// Rows X Y Z of the flange's velocity, then its turning about Z, Y, X.
pub type Jacobian = SMatrix<f64, 6, DOF>;

/// Upper three rows of a homogeneous matrix, row by row.
pub type Frame = [f64; 12];

/// The nominal arm.
#[derive(Clone, Debug)]
pub struct RobotModel {
    arm: PlantModel,
    weightless: PlantModel,
    flange: Pose,
}

impl RobotModel {
    /// From the tables that everyone believes.
    #[must_use]
    pub fn new(parameters: &ArmParameters) -> Self {
        let arm = PlantModel::new(parameters);
        Self {
            weightless: arm.weightless(),
            arm,
            flange: parameters.flange,
        }
    }

    /// g(q) \[Nm\]: what holds the arm.
    #[must_use]
    pub fn gravity(&self, q: &JointVector<f64>) -> JointVector<f64> {
        self.arm.gravity_torque(q)
    }

    /// M(q) \[kg m2\] and g(q) \[Nm\].
    #[must_use]
    pub fn at_rest(&self, q: &JointVector<f64>) -> (JointMatrix<f64>, JointVector<f64>) {
        let equations = self.arm.equations(q, &JointVector::zeros());
        (equations.mass_matrix(), equations.bias())
    }

    /// C dq \[Nm\], of a weightless arm.
    #[must_use]
    pub fn coriolis(&self, state: &JointState<f64>) -> JointVector<f64> {
        self.weightless.equations(&state.q, &state.dq).bias()
    }

    /// Flange velocity per joint speed, base-plate axes.
    #[must_use]
    pub fn jacobian(&self, q: &JointVector<f64>) -> Jacobian {
        let mut jacobian = Jacobian::zeros();
        for joint in 0..DOF {
            let mut state = JointState {
                q: *q,
                dq: JointVector::zeros(),
            };
            state.dq[joint] = 1.0;
            let (_, v) = self.arm.point(&state, DOF, &self.flange.shift.into());
            let w = angular_velocity(&self.arm, &state, DOF);
            let column = SVector::<f64, 6>::new(v.x, v.y, v.z, w.z, w.y, w.x);
            jacobian.set_column(joint, &column);
        }
        jacobian
    }

    /// Flange frame in the base-plate frame \[m\].
    #[must_use]
    pub fn frame(&self, q: &JointVector<f64>) -> Frame {
        let state = JointState {
            q: *q,
            dq: JointVector::zeros(),
        };
        let at = |offset: Vector3<f64>| {
            let place = self.flange.place(offset.into());
            self.arm.point(&state, DOF, &place.into()).0
        };
        let origin = at(Vector3::zeros());
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| at(axis) - origin);
        std::array::from_fn(|i| [x, y, z, origin][i % 4][i / 4])
    }

    /// The wrench at the flange that explains a joint torque best: Fx Fy Fz \[N\],
    /// Tz Ty Tx \[Nm\]. Damped, so that it stays bounded in stretched postures.
    #[must_use]
    pub fn flange_wrench(jacobian: &Jacobian, torque: &JointVector<f64>) -> SVector<f64, 6> {
        const DAMPING: f64 = 1e-6;
        let square = jacobian * jacobian.transpose() + SMatrix::<f64, 6, 6>::identity() * DAMPING;
        square
            .cholesky()
            .map_or_else(SVector::zeros, |factor| factor.solve(&(jacobian * torque)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::LWR_IV;

    const STATE: JointState<f64> = JointState {
        q: JointVector::from_array_storage(nalgebra::ArrayStorage([[
            0.2, 0.6, -0.3, -1.4, 0.4, 0.9, 0.1,
        ]])),
        dq: JointVector::from_array_storage(nalgebra::ArrayStorage([[
            0.5, -0.3, 0.4, 0.2, -0.6, 0.8, 0.3,
        ]])),
    };

    #[test]
    fn the_mass_matrix_gives_the_kinetic_energy() {
        let model = RobotModel::new(&LWR_IV);
        let (mass, gravity) = model.at_rest(&STATE.q);
        let energy = 0.5 * STATE.dq.dot(&(mass * STATE.dq));
        assert!((energy - model.arm.kinetic_energy(&STATE)).abs() < 1e-10);
        // Gravity by virtual work.
        assert!((gravity - model.gravity(&STATE.q)).amax() < 1e-12);
        // M ddq + C dq + g is the torque.
        let torque = JointVector::from([1.0, -20.0, 2.0, 9.0, 0.3, -0.2, 0.01]);
        let none = JointVector::zeros();
        let ddq = model
            .arm
            .articulated_bodies(&STATE.q, &STATE.dq, &torque, &none);
        let sum = mass * ddq + model.coriolis(&STATE) + gravity;
        assert!((sum - torque).amax() < 1e-9);
    }

    #[test]
    fn jacobian_and_frame_agree() {
        let model = RobotModel::new(&LWR_IV);
        let jacobian = model.jacobian(&STATE.q);
        let h = 1e-6;
        let difference = |sign: f64| model.frame(&(STATE.q + STATE.dq * (sign * h)));
        let (ahead, behind) = (difference(1.0), difference(-1.0));
        let rate: Vec<_> = (0..12)
            .map(|i| (ahead[i] - behind[i]) / (2.0 * h))
            .collect();
        let frame = model.frame(&STATE.q);
        let twist = jacobian * STATE.dq;
        let w = Vector3::new(twist[5], twist[4], twist[3]);
        for row in 0..3 {
            assert!((twist[row] - rate[4 * row + 3]).abs() < 1e-8);
        }
        for column in 0..3 {
            let axis = |values: &[f64]| {
                Vector3::new(values[column], values[4 + column], values[8 + column])
            };
            assert!((w.cross(&axis(&frame)) - axis(&rate)).amax() < 1e-8);
        }
    }

    #[test]
    fn a_wrench_at_the_flange_is_found_from_its_torque() {
        let model = RobotModel::new(&LWR_IV);
        let jacobian = model.jacobian(&STATE.q);
        let wrench = SVector::<f64, 6>::new(10.0, -5.0, 20.0, 0.5, -1.0, 0.2);
        let found = RobotModel::flange_wrench(&jacobian, &(jacobian.transpose() * wrench));
        assert!((found - wrench).amax() < 1e-2, "{found}");
    }
}
