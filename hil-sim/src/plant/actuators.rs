//! Noise and elasticity of the joints' drives.
//!
//! Tables of arms have no numbers for them. Those here are chosen for drives of a certain
//! size and scaled to others in proportion to the torque limit of the joint: springs then
//! give way by the same angle under full torque, motors swing on them at the same
//! frequency, and noise is the same share of full torque.

use controller_core::arm::{ArmParameters, LinkParameters};
use controller_core::joint::{DOF, JointVector};

/// Torque limits of the drives that the chosen values are for \[Nm\].
pub const SIZE: [f64; DOF] = [176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0];

/// Standard deviation of their torque noise \[Nm\]. Chosen.
pub const TORQUE_NOISE: [f64; DOF] = [0.1, 0.1, 0.1, 0.1, 0.05, 0.03, 0.01];

/// Their K \[Nm/rad\]. Chosen.
pub const STIFFNESS: [f64; DOF] = [1e4, 1e4, 1e4, 1e4, 5e3, 3e3, 5e2];

/// Their D \[Nms/rad\]. Chosen.
pub const DAMPING: [f64; DOF] = [3.0, 3.0, 3.0, 3.0, 1.5, 0.8, 0.1];

/// Their B \[kg m2\], behind the gear and the torque loop. Chosen.
pub const MOTOR_INERTIA: [f64; DOF] = [0.02, 0.02, 0.02, 0.02, 0.01, 0.005, 0.002];

/// The drives of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuators {
    /// Standard deviation \[Nm\] of the torque noise, of one draw per cycle that holds for the
    /// cycle.
    pub torque_noise: JointVector<f64>,
    /// K of elastic joints \[Nm/rad\].
    pub stiffness: JointVector<f64>,
    /// D of elastic joints \[Nms/rad\].
    pub damping: JointVector<f64>,
    /// B of elastic joints \[kg m2\]: the rotor inertia of the table where it has one.
    pub motor_inertia: JointVector<f64>,
}

impl Actuators {
    /// Of an arm with these tables.
    #[must_use]
    pub fn of(arm: &ArmParameters) -> Self {
        let each = |value: fn(&LinkParameters) -> f64| {
            JointVector::from_fn(|joint, _| value(&arm.links[joint]))
        };
        let scale = each(|link| link.torque_limit).component_div(&JointVector::from(SIZE));
        let scaled = |values: [f64; DOF]| JointVector::from(values).component_mul(&scale);
        let (rotor, chosen) = (each(|link| link.rotor_inertia), scaled(MOTOR_INERTIA));
        Self {
            torque_noise: scaled(TORQUE_NOISE),
            stiffness: scaled(STIFFNESS),
            damping: scaled(DAMPING),
            motor_inertia: rotor.zip_map(&chosen, |own, chosen| match own > 0.0 {
                true => own,
                false => chosen,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drives_of_any_size_give_way_by_the_same_angle_and_swing_at_the_same_rate() {
        for arm in arms::ALL {
            let drives = Actuators::of(arm);
            for joint in 0..DOF {
                let full = arm.links[joint].torque_limit;
                let angle = full / drives.stiffness[joint];
                assert!((angle * STIFFNESS[joint] / SIZE[joint] - 1.0).abs() < 1e-14);
                let noise = drives.torque_noise[joint] / full;
                assert!((noise * SIZE[joint] / TORQUE_NOISE[joint] - 1.0).abs() < 1e-14);
                let rotor = arm.links[joint].rotor_inertia;
                if rotor > 0.0 {
                    assert_eq!(drives.motor_inertia[joint], rotor);
                    continue;
                }
                let square = drives.stiffness[joint] / drives.motor_inertia[joint];
                assert!((square * MOTOR_INERTIA[joint] / STIFFNESS[joint] - 1.0).abs() < 1e-14);
            }
        }
    }
}
