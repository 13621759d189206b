//! KUKA LBR iiwa 7 R800.
//!
//! Source: lbr-stack/lbr_fri_ros2_stack, commit 218d723f817c61314988833611effddc5333ca6c,
//! lbr_description/urdf/iiwa7/iiwa7_description.xacro, joint_limits.yaml; licence Apache-2.0.
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

/// KUKA LBR iiwa 7 R800 without tool, upright.
pub const IIWA_7: ArmParameters = ArmParameters {
    name: "iiwa_7",
    base: Pose::at([0.0, 0.0, 0.34]),
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "A1",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 3.394011,
            com: [0.0, 0.06920099999999997, -0.034819],
            inertia: [0.021383, 0.0, 0.0, 0.007563, -0.003797, 0.020403],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-170.0_f64.to_radians(), 170.0_f64.to_radians()],
            speed_limit: 98.0_f64.to_radians(),
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
            mass: 4.031991,
            com: [0.0, 0.029293, 0.086944],
            inertia: [0.031697, 0.0, 0.0, 0.030080000000000003, 0.005889, 0.009666],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-120.0_f64.to_radians(), 120.0_f64.to_radians()],
            speed_limit: 98.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 200.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "A3",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.4,
            angle_offset: 0.0,
            mass: 3.394011,
            com: [0.0, -0.069201, -0.034819],
            inertia: [0.021383, 0.0, 0.0, 0.007563, 0.003797, 0.020403],
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
            mass: 4.031989,
            com: [0.0, -0.029293, 0.086944],
            inertia: [0.031695, 0.0, 0.0, 0.030079, -0.005889, 0.009665],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-120.0_f64.to_radians(), 120.0_f64.to_radians()],
            speed_limit: 130.0_f64.to_radians(),
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
            mass: 1.529239,
            com: [0.0, 0.11623300000000011, -0.029824],
            inertia: [0.008485, 0.0, 0.0, 0.003848, -0.002806, 0.007136],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-170.0_f64.to_radians(), 170.0_f64.to_radians()],
            speed_limit: 140.0_f64.to_radians(),
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
            mass: 2.403626,
            com: [0.0, 0.00032000000000000084, 0.00495],
            inertia: [0.007067, 0.0, 0.0, 0.006804, 0.000311, 0.004629],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-120.0_f64.to_radians(), 120.0_f64.to_radians()],
            speed_limit: 180.0_f64.to_radians(),
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
            mass: 0.259474,
            com: [3.0e-6, -2.0e-6, 0.10478199999999997],
            inertia: [0.000171, 0.0, 0.0, 0.000171, 0.0, 0.000299],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-175.0_f64.to_radians(), 175.0_f64.to_radians()],
            speed_limit: 180.0_f64.to_radians(),
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
