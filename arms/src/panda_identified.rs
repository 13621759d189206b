//! Franka Emika Panda, another set of bodies.
//!
//! Source: C. Gaz, M. Cognetti, A. Oliva, P. Robuffo Giordano and A. De Luca, RA-L 2019,
//! supplementary table VIII; limits of the maker's documentation of the FCI.
//! Kind of numbers: identified bodies, as URDFs and simulators copy them. The wrist is far from
//! the robot's own model, M77 3.9 times it: [`PANDA`](crate::PANDA) is the better table of a
//! controller, this one a true arm for a plant.
//!
//! Unknown: rotor inertia (in the bodies as far as it acts on M). Friction is 0: the robot
//! compensates that of its motors, and what is left is not published.

use core::f64::consts::FRAC_PI_2;

use controller_core::arm::{
    ArmParameters, Friction, Link, LinkParameters, LinkPoint, NamedPoint, Pose,
};

/// What the robot allows, 1 Nm per millisecond \[Nm/s\].
const TORQUE_RATE: f64 = 1e3;

/// The robot allows no more while braking \[Nm/s\].
const BRAKE_RATE: f64 = 1e3;

const FLANGE: Pose = Pose::at([0.0, 0.0, 0.107]);

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

/// Franka Emika Panda without hand, upright: retrieved bodies.
pub const PANDA_IDENTIFIED: ArmParameters = ArmParameters {
    name: "panda_identified",
    base: Pose::IDENTITY,
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "joint1",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.333,
            angle_offset: 0.0,
            mass: 4.970684,
            com: [0.003875, 0.0476, 0.002081],
            inertia: [0.70337, -0.006772, -0.000139, 0.009117, -0.019169, 0.70661],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.8973, 2.8973],
            speed_limit: 2.175,
            end_approach: None,
            torque_limit: 87.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint2",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.646926,
            com: [-0.003141, 0.003495, 0.02872],
            inertia: [0.007962, 0.010254, 0.003925, 0.025995, -0.000704, 0.02811],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-1.7628, 1.7628],
            speed_limit: 2.175,
            end_approach: None,
            torque_limit: 87.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint3",
            a: 0.0825,
            alpha: FRAC_PI_2,
            d: 0.316,
            angle_offset: 0.0,
            mass: 3.228604,
            com: [-0.054982, -0.066502, -0.039252],
            inertia: [0.037242, -0.011396, 0.004761, 0.01083, 0.012805, 0.036155],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.8973, 2.8973],
            speed_limit: 2.175,
            end_approach: None,
            torque_limit: 87.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint4",
            a: -0.0825,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 3.587895,
            com: [0.029330000000000002, -0.027454, 0.104419],
            inertia: [0.025853, 0.001332, 0.007796, 0.028323, -0.008641, 0.019552],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-3.0718, -0.0698],
            speed_limit: 2.175,
            end_approach: None,
            torque_limit: 87.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint5",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.384,
            angle_offset: 0.0,
            mass: 1.225946,
            com: [-0.011953, -0.038437, -0.041065],
            inertia: [0.035549, -0.004037, 0.002117, 0.008627, -0.000229, 0.029474],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.8973, 2.8973],
            speed_limit: 2.61,
            end_approach: None,
            torque_limit: 12.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint6",
            a: 0.088,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 1.666555,
            com: [-0.027850999999999994, -0.010517, 0.014117],
            inertia: [
                0.001964, -0.001158, -0.000109, 0.005433, -0.000341, 0.004354,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-0.0175, 3.7525],
            speed_limit: 2.61,
            end_approach: None,
            torque_limit: 12.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint7",
            a: 0.0,
            alpha: 0.0,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.735522,
            com: [0.010517, -0.004252, 0.061597],
            inertia: [
                0.012516, -0.000428, -0.001196, 0.010027, -0.000741, 0.004815,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.8973, 2.8973],
            speed_limit: 2.61,
            end_approach: None,
            torque_limit: 12.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
    ],
    flange: FLANGE,
    points: POINTS,
    limits: None,
    damping_postures: &[],
};
