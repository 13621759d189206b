//! Joint friction of the realistic plant: Coulomb friction with a smooth
//! passage through zero speed, plus viscous friction,
//!
//! F(dq) = F_c tanh(dq / v) + F_v dq,
//!
//! which opposes the motion: the joint feels -F. The numbers are those of the true arm
//! ([`super::mismatch::true_arm`]).
//! Under a torque below F_c a joint creeps instead of sticking; [`super::stiction`] is the
//! law with which it sticks.

use controller_core::arm::{self, ArmParameters};
use controller_core::joint::JointVector;

/// Friction of all joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionLaw {
    /// F_c \[Nm\].
    pub coulomb: JointVector<f64>,
    /// F_v \[Nms/rad\].
    pub viscous: JointVector<f64>,
    /// v \[rad/s\].
    pub smoothing: JointVector<f64>,
}

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
}

impl FrictionLaw {
    /// Of an arm with these tables.
    #[must_use]
    pub fn of(arm: &ArmParameters) -> Self {
        let each = |value: fn(&arm::Friction) -> f64| {
            JointVector::from_fn(|joint, _| value(&arm.links[joint].friction))
        };
        Self {
            coulomb: each(|friction| friction.coulomb),
            viscous: each(|friction| friction.viscous),
            smoothing: each(|friction| friction.smoothing),
        }
    }

    /// Friction at the joint speeds `dq` \[rad/s\].
    #[must_use]
    pub fn at(&self, dq: &JointVector<f64>) -> Friction {
        let Self {
            coulomb,
            viscous,
            smoothing,
        } = self;
        let sigmoid = dq.zip_map(smoothing, |speed, smoothing| libm::tanh(speed / smoothing));
        Friction {
            torque: JointVector::from_fn(|i, _| coulomb[i] * sigmoid[i] + viscous[i] * dq[i]),
            slope: JointVector::from_fn(|i, _| {
                coulomb[i] * (1.0 - sigmoid[i] * sigmoid[i]) / smoothing[i] + viscous[i]
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::LWR_IV;

    fn speeds() -> impl Iterator<Item = f64> {
        (-4000..=4000).map(|i| f64::from(i) * 1e-3)
    }

    #[test]
    fn friction_is_passive_odd_and_increasing() {
        let law = FrictionLaw::of(&LWR_IV);
        for speed in speeds() {
            let friction = law.at(&JointVector::from_element(speed));
            let mirrored = law.at(&JointVector::from_element(-speed));
            for i in 0..7 {
                assert!(law.coulomb[i] > 0.0 && law.viscous[i] > 0.0);
                assert!(friction.torque[i] * speed >= law.viscous[i] * speed * speed);
                assert!(friction.slope[i] >= law.viscous[i]);
                assert_eq!(friction.torque[i], -mirrored.torque[i]);
            }
        }
    }

    #[test]
    fn the_slope_is_the_derivative() {
        const STEP: f64 = 1e-6;
        let law = FrictionLaw::of(&LWR_IV);
        for speed in speeds().step_by(7) {
            let at = |speed| law.at(&JointVector::from_element(speed));
            let difference = (at(speed + STEP).torque - at(speed - STEP).torque) / (2.0 * STEP);
            let slope = at(speed).slope;
            assert!((difference - slope).amax() < 1e-6, "{speed}");
        }
    }
}
