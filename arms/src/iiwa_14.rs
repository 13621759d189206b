//! KUKA LBR iiwa 14 R820.
//!
//! Source: lbr-stack/lbr_fri_ros2_stack, commit 218d723f817c61314988833611effddc5333ca6c,
//! lbr_description/urdf/iiwa14/iiwa14_description.xacro, joint_limits.yaml; licence Apache-2.0.
//! Kind of numbers: geometry and limits of position and speed are the maker's. Masses, centres
//! and inertias are a guess, read from a CAD model by the authors of that stack: neither
//! identified nor the maker's. Torque limits as in that file, 200 Nm for every joint; the data
//! sheet has less for the outer ones.
//!
//! Unknown: rotor inertia, friction.

use core::f64::consts::FRAC_PI_2;

use controller_core::arm::{
    ArmParameters, Friction, Link, LinkParameters, LinkPoint, NamedPoint, Pose,
};

use crate::lwr_iv::LWR_IV_REALISTIC;
use crate::realistic::Realistic;

/// No limit of the arm that is published: a net, above what motion and contact need \[Nm/s\].
const TORQUE_RATE: f64 = 10e3;

/// Of braking: a full torque within a few milliseconds \[Nm/s\].
const BRAKE_RATE: f64 = 100e3;

const FLANGE: Pose = Pose::at([0.0, 0.0, 0.126]);

const POINTS: &[NamedPoint] = &[
    NamedPoint {
        name: "elbow",
        point: LinkPoint {
            link: Link::L3,
            offset: [0.0, 0.0, 0.0],
        },
    },
    NamedPoint {
        name: "wrist",
        point: LinkPoint {
            link: Link::L5,
            offset: [0.0, 0.0, 0.0],
        },
    },
    NamedPoint {
        name: "flange",
        point: LinkPoint {
            link: Link::L7,
            offset: FLANGE.shift,
        },
    },
];

/// KUKA LBR iiwa 14 R820 without tool, upright.
pub const IIWA_14: ArmParameters = ArmParameters {
    name: "iiwa_14",
    base: Pose::at([0.0, 0.0, 0.36]),
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "A1",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 5.289529,
            com: [0.0, 0.080096, -0.033795],
            inertia: [0.042462, 0.0, 0.0, 0.01587, -0.006341, 0.042838],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-170.0_f64.to_radians(), 170.0_f64.to_radians()],
            speed_limit: 85.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "A2",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 5.688888,
            com: [0.000136, 0.037548, 0.076322],
            inertia: [
                0.055181999999999995,
                -3.3e-5,
                5.6e-5,
                0.053983,
                0.010034,
                0.016523,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-120.0_f64.to_radians(), 120.0_f64.to_radians()],
            speed_limit: 85.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "A3",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.42,
            angle_offset: 0.0,
            mass: 3.461245,
            com: [0.0, -0.06889200000000009, -0.034912999999999986],
            inertia: [0.02172, 0.0, 0.0, 0.007701, 0.003845, 0.02073],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-170.0_f64.to_radians(), 170.0_f64.to_radians()],
            speed_limit: 100.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "A4",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 4.122995,
            com: [0.0, -0.029293, 0.086944],
            inertia: [0.03241, 0.0, 0.0, 0.030758, -0.006022, 0.009883],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-120.0_f64.to_radians(), 120.0_f64.to_radians()],
            speed_limit: 75.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "A5",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.4,
            angle_offset: 0.0,
            mass: 1.563756,
            com: [0.0, 0.11623300000000011, -0.029824],
            inertia: [0.008677, 0.0, 0.0, 0.003935, -0.002869, 0.007297],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-170.0_f64.to_radians(), 170.0_f64.to_radians()],
            speed_limit: 130.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "A6",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 2.457878,
            com: [0.0, 0.00032000000000000084, 0.00495],
            inertia: [0.007227, 0.0, 0.0, 0.006958, 0.000318, 0.004734],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-120.0_f64.to_radians(), 120.0_f64.to_radians()],
            speed_limit: 135.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "A7",
            a: 0.0,
            alpha: 0.0,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.265331,
            com: [3.0e-6, -2.0e-6, 0.10478199999999997],
            inertia: [0.000175, 0.0, 0.0, 0.000175, 0.0, 0.000306],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-175.0_f64.to_radians(), 175.0_f64.to_radians()],
            speed_limit: 135.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
    ],
    flange: FLANGE,
    points: POINTS,
    limits: None,
    damping_postures: &[],
};

/// A true iiwa 14: errors of its bodies are drawn. Its friction under torque control is not
/// published; that of the LWR IV+, its predecessor, stands in, which is chosen as well.
pub const IIWA_14_REALISTIC: Realistic = Realistic {
    friction: LWR_IV_REALISTIC.friction,
    ..Realistic::of_table(&IIWA_14)
};
