//! Joint friction of the realistic plant: Coulomb friction with a smooth
//! passage through zero speed, plus viscous friction,
//!
//! F(dq) = F_c tanh(dq / 0.02 rad/s) + F_v dq,
//!
//! which opposes the motion: the joint feels -F. Under a torque below F_c a joint
//! creeps instead of sticking; [`super::stiction`] is the law with which it sticks.

use controller_core::joint::JointVector;

/// Coulomb friction F_c \[Nm\] per joint.
pub const COULOMB: [f64; 7] = [1.0, 1.0, 0.7, 0.7, 0.3, 0.2, 0.05];

/// Viscous friction F_v \[Nms/rad\] per joint.
pub const VISCOUS: [f64; 7] = [0.8, 0.8, 0.6, 0.6, 0.2, 0.1, 0.02];

/// Speed \[rad/s\] over which Coulomb friction changes its sign.
pub const TRANSITION_SPEED: f64 = 0.02;

/// Friction at one speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// F(dq) \[Nm\], of the sign of dq.
    pub torque: JointVector<f64>,
    /// dF/d(dq) \[Nms/rad\], above 0.
    pub slope: JointVector<f64>,
}

impl Friction {
    /// Joints that turn freely.
    pub const NONE: Self = Self {
        torque: controller_core::joint::zeros(),
        slope: controller_core::joint::zeros(),
    };

    /// Friction at the joint speeds `dq` \[rad/s\].
    #[must_use]
    pub fn at(dq: &JointVector<f64>) -> Self {
        let sigmoid = dq.map(|speed| libm::tanh(speed / TRANSITION_SPEED));
        Self {
            torque: JointVector::from_fn(|i, _| COULOMB[i] * sigmoid[i] + VISCOUS[i] * dq[i]),
            slope: JointVector::from_fn(|i, _| {
                COULOMB[i] * (1.0 - sigmoid[i] * sigmoid[i]) / TRANSITION_SPEED + VISCOUS[i]
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn speeds() -> impl Iterator<Item = f64> {
        (-4000..=4000).map(|i| f64::from(i) * 1e-3)
    }

    #[test]
    fn friction_is_passive_odd_and_increasing() {
        for speed in speeds() {
            let friction = Friction::at(&JointVector::from_element(speed));
            let mirrored = Friction::at(&JointVector::from_element(-speed));
            for i in 0..7 {
                assert!(friction.torque[i] * speed >= VISCOUS[i] * speed * speed);
                assert!(friction.slope[i] >= VISCOUS[i]);
                assert_eq!(friction.torque[i], -mirrored.torque[i]);
            }
        }
    }

    #[test]
    fn the_slope_is_the_derivative() {
        const STEP: f64 = 1e-6;
        for speed in speeds().step_by(7) {
            let at = |speed| Friction::at(&JointVector::from_element(speed));
            let difference = (at(speed + STEP).torque - at(speed - STEP).torque) / (2.0 * STEP);
            let slope = at(speed).slope;
            assert!((difference - slope).amax() < 1e-6, "{speed}");
        }
    }
}
