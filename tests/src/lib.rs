//! Helpers shared by the workspace tests.

use arms::LWR_IV;
use controller_core::arm::ArmModel;
use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::kinematics::Kinematics;
use controller_core::joint::{DOF, JointState, JointVector};
use controller_core::real::Real;
use controller_core::{Controller, ControllerConfig};

pub mod config;
pub mod golden;
pub mod oracle;
pub mod random;

/// The arm under test.
#[must_use]
pub fn lwr() -> ArmModel<f64> {
    ArmModel::new(&LWR_IV).expect("the built-in arm is valid")
}

/// A controller of the arm under test with the exact law, in either precision.
///
/// # Panics
/// A configuration that is refused.
#[must_use]
pub fn controller<T: Real>(config: &ControllerConfig) -> Controller<T> {
    Controller::exact(&LWR_IV, config).expect("a valid configuration")
}

/// The same with the law within limits.
///
/// # Panics
/// A configuration that is refused.
#[must_use]
pub fn limited_controller<T: Real>(config: &ControllerConfig) -> Controller<T> {
    Controller::new(&LWR_IV, config).expect("a valid configuration")
}

/// Kinematics and dynamics of the core at one state.
#[must_use]
pub fn evaluate<T: Real>(
    model: &ArmModel<T>,
    state: &JointState<T>,
) -> (Kinematics<T>, Dynamics<T>) {
    let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
    kinematics.update(model, state);
    dynamics.update(model, &kinematics, state);
    (kinematics, dynamics)
}

/// The unit vector of joint `i`, counted from 0.
#[must_use]
pub fn unit(i: usize) -> JointVector<f64> {
    JointVector::from_fn(|j, _| f64::from(u8::from(i == j)))
}

/// Largest entry of |a - b| relative to the largest of |b| (at least `floor`).
#[must_use]
pub fn relative<'a>(
    a: impl IntoIterator<Item = &'a f64>,
    b: impl IntoIterator<Item = &'a f64>,
    floor: f64,
) -> f64 {
    let (mut difference, mut scale) = (0.0f64, floor);
    for (a, b) in a.into_iter().zip(b) {
        difference = difference.max((a - b).abs());
        scale = scale.max(b.abs());
        if !(a.is_finite() && b.is_finite()) {
            return f64::INFINITY;
        }
    }
    difference / scale
}

/// Index of the joint count, for loops in tests.
pub const JOINTS: core::ops::Range<usize> = 0..DOF;
