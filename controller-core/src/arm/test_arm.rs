//! An arm for the tests inside this crate: uniform rods along the offsets of a
//! right-angled table, one of them with a length. Tables of real arms are in the crate
//! `arms`, which is built on this one.

use core::f64::consts::FRAC_PI_2;

use super::{ArmParameters, Friction, LinkParameters, Pose};

/// A rod of 0.2 m and 2 kg, its middle 0.1 m along y, that is displaced by `a` and `d`
/// \[m\] and twisted by `alpha` \[rad\]; its joint has a rotor and an offset of 0.2 rad.
const fn rod(a: f64, alpha: f64, d: f64) -> LinkParameters {
    LinkParameters {
        name: "joint",
        a,
        alpha,
        d,
        angle_offset: 0.2,
        mass: 2.0,
        com: [0.01, 0.1, -0.02],
        // m l2 / 12 across, a radius of 20 mm about its own axis.
        inertia: [0.0067, 0.0, 0.0, 0.0004, 0.0, 0.0067],
        rotor_inertia: 0.01,
        friction: Friction::NONE,
        position_range: [-2.5, 2.0],
        speed_limit: 2.0,
        end_approach: None,
        torque_limit: 100.0,
        torque_rate_limit: 1e4,
        brake_rate_limit: 1e5,
    }
}

/// Seven rods.
pub(crate) const RODS: ArmParameters = ArmParameters {
    name: "rods",
    base: Pose::at([0.0, 0.0, 0.3]),
    gravity: [0.0, 0.0, -9.81],
    links: [
        rod(0.0, FRAC_PI_2, 0.0),
        rod(0.0, -FRAC_PI_2, 0.0),
        rod(0.0, -FRAC_PI_2, 0.4),
        rod(0.0, FRAC_PI_2, 0.0),
        rod(0.0, FRAC_PI_2, 0.3),
        rod(0.08, -FRAC_PI_2, 0.0),
        rod(0.0, 0.0, 0.0),
    ],
    flange: Pose::at([0.0, 0.0, 0.1]),
    points: &[],
    limits: None,
    damping_postures: &[],
};
