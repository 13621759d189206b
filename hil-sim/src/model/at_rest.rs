//! An arm at rest in a posture.

use controller_core::arm::ArmModel;
use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::kinematics::Kinematics;
use controller_core::joint::{DOF, JointState, JointVector};

/// Its kinematics and dynamics at `q` \[rad\].
#[must_use]
pub fn at_rest(model: &ArmModel<f64>, q: &[f64; DOF]) -> (Kinematics<f64>, Dynamics<f64>) {
    let state = JointState {
        q: (*q).into(),
        dq: JointVector::zeros(),
    };
    let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
    kinematics.update(model, &state);
    dynamics.update(model, &kinematics, &state);
    (kinematics, dynamics)
}
