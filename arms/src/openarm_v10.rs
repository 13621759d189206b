//! OpenArm 1.0.
//!
//! Source: enactic/openarm_description, commit af6f03580664c2ee21a0f353fe5dfa9149f0eea0,
//! config/arm/v10/*.yaml, urdf/arm/openarm_arm.xacro (right arm, reflect = 1); licence Apache-2.0.
//! Kind of numbers: the maker's CAD. Friction: the maker's compensation law
//! Fv dq + Fc tanh(0.1 k dq), openarm_teleop, commit eb2d493, config/follower.yaml, without its
//! constant part; no measurement near zero speed. Rotor inertia: table of the motors' maker,
//! times gear ratio squared.
//!
//! The left arm is the right one mirrored in the plane between them (x-z of the robot), but for
//! link 4, the same part on both sides.
//!
//! Unknown: how far rotor inertia differs from motor to motor; the motors report it.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use controller_core::arm::{ArmParameters, Friction, LinkParameters, Pose};

use crate::openarm::{self, DM4310, DM4340, DM8009};
use crate::realistic::{Interface, Realistic};

/// No limit of the arm that is published: a net, above what motion and contact need \[Nm/s\].
const TORQUE_RATE: f64 = 10e3;

/// Of braking: a full torque within a few milliseconds \[Nm/s\].
const BRAKE_RATE: f64 = 100e3;

const FLANGE_RIGHT: Pose = Pose {
    rotation: [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    shift: [0.0, -1.0e-6, 0.0205],
};

/// Right arm without gripper on the body, whose side the base plate is on.
pub const OPENARM_V10_RIGHT: ArmParameters = ArmParameters {
    name: "openarm_v10_right",
    base: Pose {
        rotation: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        shift: [0.0, 0.0, 0.1225],
    },
    gravity: [0.0, -9.81, 0.0],
    links: [
        LinkParameters {
            name: "J1",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 1.1416684646202298,
            com: [
                -3.319987657026362e-5,
                -0.0060471561926374595,
                -0.0011467657911800769,
            ],
            inertia: [0.001273, -1.0e-6, -1.0e-6, 0.001016, 2.9e-5, 0.001567],
            rotor_inertia: 0.0158,
            friction: Friction {
                coulomb: 0.306,
                viscous: 0.063,
                smoothing: 0.3519,
            },
            position_range: [-1.396263, 3.490659],
            speed_limit: 16.754666,
            end_approach: None,
            torque_limit: 40.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J2",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: FRAC_PI_2,
            mass: 0.2775092746011571,
            com: [
                -2.0145102027597523e-8,
                0.02170370817648057,
                0.03256649300522363,
            ],
            inertia: [0.000376, -1.0e-6, 1.0e-6, 0.000359, 0.000109, 0.000232],
            rotor_inertia: 0.0158,
            friction: Friction {
                coulomb: 0.306,
                viscous: 0.063,
                smoothing: 0.3519,
            },
            position_range: [-0.17453267320510335, 3.3161253267948965],
            speed_limit: 16.754666,
            end_approach: None,
            torque_limit: 40.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J3",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.22,
            angle_offset: FRAC_PI_2,
            mass: 1.073863338202347,
            com: [
                0.002104752099628911,
                -0.06527529454278039,
                0.0005549085042607548,
            ],
            inertia: [0.004372, -1.1e-5, -1.0e-6, 0.000661, -3.6e-5, 0.004319],
            rotor_inertia: 0.032,
            friction: Friction {
                coulomb: 0.4,
                viscous: 0.604,
                smoothing: 0.3441,
            },
            position_range: [-FRAC_PI_2, FRAC_PI_2],
            speed_limit: 5.445426,
            end_approach: None,
            torque_limit: 27.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J4",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.5598534566833373,
            com: [
                0.0029006831074562967,
                -0.0011942417336533243,
                0.06339637422196212,
            ],
            inertia: [0.000623, -1.0e-6, 1.9e-5, 0.000511, -3.8e-5, 0.000334],
            rotor_inertia: 0.032,
            friction: Friction {
                coulomb: 0.166,
                viscous: 0.813,
                smoothing: 0.0769,
            },
            position_range: [0.0, 2.443461],
            speed_limit: 5.445426,
            end_approach: None,
            torque_limit: 27.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J5",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.216,
            angle_offset: FRAC_PI_2,
            mass: 0.5506588026168502,
            com: [
                -0.0008866902457326625,
                0.07742019697501906,
                -0.003049665024221911,
            ],
            inertia: [0.000445, -6.0e-6, 8.0e-6, 0.000324, -6.0e-6, 0.000423],
            rotor_inertia: 0.0018,
            friction: Friction {
                coulomb: 0.05,
                viscous: 0.029,
                smoothing: 0.0659,
            },
            position_range: [-FRAC_PI_2, FRAC_PI_2],
            speed_limit: 20.943946,
            end_approach: None,
            torque_limit: 7.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J6",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: FRAC_PI_2,
            mass: 0.385202773187987,
            com: [
                9.498374522309838e-5,
                -0.0003634129945525935,
                0.00033230528343419053,
            ],
            inertia: [0.000159, 1.0e-6, -1.0e-6, 0.000143, -1.0e-6, 0.000157],
            rotor_inertia: 0.0018,
            friction: Friction {
                coulomb: 0.093,
                viscous: 0.072,
                smoothing: 0.0413,
            },
            position_range: [-FRAC_PI_4, FRAC_PI_4],
            speed_limit: 20.943946,
            end_approach: None,
            torque_limit: 7.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J7",
            a: 0.0,
            alpha: 0.0,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.3859771327380578,
            com: [
                -0.06951945409987448,
                -6.875510271106056e-5,
                0.01266175250761268,
            ],
            inertia: [0.000342, 1.0e-6, -8.9e-5, 0.000639, -1.0e-6, 0.000497],
            rotor_inertia: 0.0018,
            friction: Friction {
                coulomb: 0.172,
                viscous: 0.084,
                smoothing: 1.2677,
            },
            position_range: [-FRAC_PI_2, FRAC_PI_2],
            speed_limit: 20.943946,
            end_approach: None,
            torque_limit: 7.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
    ],
    flange: FLANGE_RIGHT,
    points: &openarm::points(&FLANGE_RIGHT),
    limits: None,
    damping_postures: &[],
};

/// Left arm, the mirror image.
pub const OPENARM_V10_LEFT: ArmParameters = openarm::mirrored(
    &OPENARM_V10_RIGHT,
    "openarm_v10_left",
    &openarm::points(&openarm::pose(&FLANGE_RIGHT)),
    &[(4, [1.0, -1.0, -1.0])],
);

/// A true arm: errors of its bodies are drawn, friction is the maker's compensation law, and
/// everything passes through frames of the motors' bus, which takes a cycle.
pub const OPENARM_V10_REALISTIC: Realistic = Realistic {
    interface: Interface::Frames([DM8009, DM8009, DM4340, DM4340, DM4310, DM4310, DM4310]),
    dead_cycles: 1,
    ..Realistic::of_table(&OPENARM_V10_RIGHT)
};
