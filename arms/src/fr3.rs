//! Franka Research 3.
//!
//! Source: frankarobotics/franka_description, commit 566ba44abc48be2fca16050c406562e22f85793b,
//! robots/fr3/{kinematics,inertials,joint_limits}.yaml; licence Apache-2.0.
//! Kind of numbers: the maker's, for bodies, ranges and speeds; the speed near the ends of a
//! range is bounded as the maker's documentation of the FCI says.
//!
//! Unknown: rotor inertia. Friction is 0: the robot compensates that of its motors.
//! M77 = 1.194e-4 kg m2, which bounds the damping of joint 7.

use core::f64::consts::FRAC_PI_2;

use controller_core::joint::DOF;

use controller_core::arm::{
    ArmParameters, EndApproach, Friction, Link, LinkParameters, LinkPoint, NamedPoint, Pose,
};

use crate::realistic::{Bodies, Body, Interface, Realistic};

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

/// Franka Research 3 without hand, upright.
pub const FR3: ArmParameters = ArmParameters {
    name: "fr3",
    base: Pose::at([0.0, 0.0, 0.333]),
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "joint1",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 2.9274653454,
            com: [4.128e-7, 0.03860359700000001, -0.018125132399999983],
            inertia: [
                0.02392731648510791,
                0.00011404774918616684,
                1.3317903455714132e-5,
                0.0063500982585300144,
                0.0019950320628240046,
                0.0224821613275756,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.7437, 2.7437],
            speed_limit: 2.62,
            end_approach: Some(EndApproach {
                margin: 0.3,
                deceleration: 6.0,
                ends: [-2.7501, 2.7501],
            }),
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
            mass: 2.9355370338,
            com: [
                0.003182886399999999,
                0.008814608399999889,
                0.07432216439999997,
            ],
            inertia: [
                0.041938946257609425,
                0.004077784227179924,
                -0.00020257331521090807,
                0.06170214472888839,
                0.004225215800656999,
                0.025145148850147236,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-1.7837, 1.7837],
            speed_limit: 2.62,
            end_approach: Some(EndApproach {
                margin: 0.2,
                deceleration: 2.585,
                ends: [-1.7918, 1.7918],
            }),
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
            mass: 2.2449013699,
            com: [-0.0417984314, -0.028973082299999998, 0.004820056500000013],
            inertia: [
                0.02410142547240885,
                -0.002856269270114314,
                -0.0024046945590421075,
                0.019044494482244823,
                0.002104212683891874,
                0.01974053266708178,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.9007, 2.9007],
            speed_limit: 2.62,
            end_approach: Some(EndApproach {
                margin: 0.2,
                deceleration: 3.5,
                ends: [-2.9065, 2.9065],
            }),
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
            mass: 2.6155955791,
            com: [0.03658990350000001, 0.008518786800000143, 0.063049296],
            inertia: [
                0.03452998321913202,
                -0.010151429984841136,
                0.013225522659828124,
                0.04125471171146641,
                0.0009762833870704607,
                0.028881621933049058,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-3.0421, -0.1518],
            speed_limit: 2.62,
            end_approach: Some(EndApproach {
                margin: 0.3,
                deceleration: 4.0,
                ends: [-3.0481, -0.1458],
            }),
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
            mass: 2.3271207594,
            com: [
                -0.0016039604999999995,
                -0.09729659899999998,
                -0.029253626199999952,
            ],
            inertia: [
                0.05161027846366289,
                -0.003567316762587211,
                0.005715173387783473,
                0.016423625579357247,
                -0.010673985108535972,
                0.04787729713371482,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.8065, 2.8065],
            speed_limit: 5.26,
            end_approach: Some(EndApproach {
                margin: 0.35,
                deceleration: 17.0,
                ends: [-2.8101, 2.8101],
            }),
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
            mass: 1.8170376524,
            com: [
                -0.028286877899999993,
                -0.01016927259999998,
                0.04102946660000001,
            ],
            inertia: [
                0.005412333594383447,
                0.0014219289306117624,
                -0.006193456360285835,
                0.016080817924212554,
                0.0013140753741120023,
                0.014058329545509979,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [0.5445, 4.5169],
            speed_limit: 4.18,
            end_approach: Some(EndApproach {
                margin: 0.35,
                deceleration: 5.5,
                ends: [0.54092, 4.5205],
            }),
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
            mass: 0.6271432862,
            com: [
                0.004522581699999997,
                0.008626192099999992,
                -0.016163325099999987,
            ],
            inertia: [
                0.00021092389150104718,
                -2.433299114461931e-5,
                4.564480393778983e-5,
                0.00017718568002411474,
                8.744070223226438e-5,
                5.993190599659971e-5,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-3.0159, 3.0159],
            speed_limit: 5.26,
            end_approach: Some(EndApproach {
                margin: 0.35,
                deceleration: 17.0,
                ends: [-3.0196, 3.0196],
            }),
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

/// Friction that Gaz and others identified on the Panda, their phi_1 and phi_2:
/// phi_1 / (1 + exp(-phi_2 dq)) - phi_1 / 2 is phi_1 / 2 tanh(phi_2 dq / 2).
const fn friction(phi_1: f64, phi_2: f64) -> Friction {
    Friction {
        coulomb: 0.5 * phi_1,
        viscous: 0.0,
        smoothing: 2.0 / phi_2,
    }
}

/// What `tests/golden/fr3_bodies.py` prints.
const TRUE_BODIES: [Body; DOF] = [
    Body {
        mass: 2.9274653,
        com: [4e-07, 0.0386036, -0.0184944],
        inertia: [
            0.023877978,
            0.00011298689,
            1.4337576e-05,
            0.006255347,
            0.0023030648,
            0.022436748,
        ],
    },
    Body {
        mass: 3.2167066,
        com: [0.0040007, 0.0106971, 0.0795788],
        inertia: [
            0.02569858,
            -0.0053578725,
            0.0019036138,
            0.032493503,
            0.0014124426,
            0.015680893,
        ],
    },
    Body {
        mass: 2.4845923,
        com: [-0.0287175, -0.0008941, -0.0332031],
        inertia: [
            0.042263407,
            0.0082106249,
            -0.0057496574,
            0.024112783,
            0.0025418338,
            0.030753171,
        ],
    },
    Body {
        mass: 2.7378616,
        com: [0.0178848, -0.0240795, 0.088615],
        inertia: [
            0.026688664,
            -0.0031476109,
            -0.0051605097,
            0.018238686,
            -0.0090172925,
            0.0154703,
        ],
    },
    Body {
        mass: 1.6003209,
        com: [-0.0052983, -0.0267773, -0.0386819],
        inertia: [
            0.031163421,
            -0.0013524362,
            0.0074356342,
            0.038870645,
            -0.01124142,
            0.02198425,
        ],
    },
    Body {
        mass: 1.9376278,
        com: [-0.0292249, -0.0078449, 0.0296384],
        inertia: [
            0.0098329878,
            0.0046599885,
            -0.0049871939,
            0.019463998,
            0.0045681827,
            0.021791661,
        ],
    },
    Body {
        mass: 0.5586887,
        com: [0.0092478, 0.0029547, 0.0145609],
        inertia: [
            0.010850835,
            -8.6021215e-05,
            -0.0020626822,
            0.011335663,
            -0.00020000784,
            0.00053199814,
        ],
    },
];

/// A true FR3, as far as the Panda tells.
///
/// Bodies: M departs from that of the table by the relative error, and g by the error, that the
/// closed form of the Panda has against the bodies identified on it
/// ([`PANDA`](crate::PANDA), [`PANDA_IDENTIFIED`](crate::PANDA_IDENTIFIED)); fitted by
/// `tests/golden/fr3_bodies.py` among bodies that can be. M is off by 3 % in the mean and 8 % at
/// worst (Frobenius norm), M55 is 2.0, M66 1.4, M77 4.9 times that of the table, g up to 0.2 Nm off.
///
/// Friction: RA-L 2019, supplementary table I, without its offsets phi_3. It was identified from
/// the torque sensors, behind the gears: what the robot's compensation of its motors leaves.
/// Assumed: an FR3 has that of a Panda.
///
/// Encoders: not published. Assumed is a step with which speeds, at 60 Hz in cycles of 1 ms, have a
/// noise of 1e-3 rad/s.
pub const FR3_REALISTIC: Realistic = Realistic {
    bodies: Bodies::Known(&TRUE_BODIES),
    friction: [
        friction(0.54615, 5.1181),
        friction(0.87224, 9.0657),
        friction(0.64068, 10.136),
        friction(1.2794, 5.5903),
        friction(0.83904, 8.3469),
        friction(0.30301, 17.133),
        friction(0.56489, 10.336),
    ],
    interface: Interface::Encoders { step: 5e-6 },
    dead_cycles: 0,
};
