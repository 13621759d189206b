//! Franka Emika Panda.
//!
//! Source: the closed form of M(q) and g(q) that C. Gaz, M. Cognetti, A. Oliva, P. Robuffo
//! Giordano and A. De Luca published with RA-L 2019 (gravity rescaled to 9.81 m/s2), repository
//! marcocognetti/FrankaEmikaPandaDynModel; limits of the maker's documentation of the FCI.
//! Kind of numbers: identified. A physically consistent set of bodies fitted to the closed form
//! by a semidefinite programme: M differs by 0.9 % in the mean and 2.2 % at worst (Frobenius
//! norm), g by less than 0.005 Nm. Single masses and centres of mass are not identified.
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

/// Franka Emika Panda without hand, upright: the robot's own model.
pub const PANDA: ArmParameters = ArmParameters {
    name: "panda",
    base: Pose::IDENTITY,
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "joint1",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.333,
            angle_offset: 0.0,
            mass: 2.7999994112916067,
            com: [0.0, 0.333, 0.0],
            inertia: [
                5.747295218495732,
                0.0,
                0.0,
                4.000002317769139e-5,
                0.0,
                5.747295218495734,
            ],
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
            mass: 3.6836551278768077,
            com: [
                -0.0014574051718122252,
                -0.007545038331416146,
                0.09688640847652434,
            ],
            inertia: [
                0.010570831003590929,
                0.01835353833553805,
                0.0019033279625619895,
                0.033263274468464096,
                -0.001044718410215962,
                0.043197171494828275,
            ],
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
            mass: 2.66355515848694,
            com: [
                -0.07944434131182351,
                -0.2619288473081387,
                -0.0021952413033500557,
            ],
            inertia: [
                0.0873217369822496,
                -0.011289691512913027,
                0.0007992297373039453,
                0.001943091409717764,
                0.006147121756845708,
                0.08835450824074959,
            ],
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
            mass: 1.3347677247384793,
            com: [
                0.14254917610888254,
                0.013123578022622394,
                -0.0390112542149788,
            ],
            inertia: [
                0.006345426880425786,
                -0.00214784349956401,
                0.0007533895438388851,
                0.0015677914769871848,
                0.0018815383354279477,
                0.006572395436042358,
            ],
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
            mass: 5.046324611434625,
            com: [
                -0.0019028305276719525,
                -0.17405863926521817,
                -0.01634145246802821,
            ],
            inertia: [
                0.09383748345250795,
                -0.004239965329096973,
                0.00029749626382127436,
                0.0006959589661109109,
                0.006557086230529589,
                0.09357204407103958,
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
        LinkParameters {
            name: "joint6",
            a: 0.088,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 1.4401980300286483,
            com: [
                0.0018847719034711108,
                0.003705846605485301,
                0.05033203329727243,
            ],
            inertia: [
                0.0013955362354064736,
                0.0004253522333323198,
                0.0007489715931176854,
                0.0019719499457658673,
                -0.0005338984856528558,
                0.0011618968719928745,
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
            mass: 0.41164655938840816,
            com: [
                0.015157604963242352,
                -0.001272202288188635,
                -0.011669265036017257,
            ],
            inertia: [
                0.0031132992654005986,
                0.0003682598323672256,
                0.0016783094312389547,
                0.003974608345981281,
                -0.0006020388785156143,
                0.001178596319775904,
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
