//! OpenArm 2.0.
//!
//! Source: enactic/openarm_mujoco, commit 396c88d87fc7eb485e4497ac043c4d95f526139e,
//! v2/openarm_bimanual.xml (left arm, gripper fingers locked at 0); speed limits: openarm_description v2.0 joint_limits.yaml; licence Apache-2.0.
//! Kind of numbers: the maker's; link 7 has the closed gripper in it. Friction: values of the
//! maker's simulator. Rotor inertia: table of the motors' maker, times gear ratio squared.
//!
//! The right arm is the left one mirrored in the plane between them (x-z of the robot), but for
//! links 3 and 4, the same parts on both sides.
//!
//! Unknown: how far rotor inertia differs from motor to motor; the motors report it.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use controller_core::arm::{ArmParameters, Friction, LinkParameters, Pose};

use crate::openarm::{self, DM3507, DM4310, DM4340, DM8009};
use crate::openarm_v10::OPENARM_V10_REALISTIC;
use crate::realistic::{Interface, Realistic};

/// No limit of the arm that is published: a net, above what motion and contact need \[Nm/s\].
const TORQUE_RATE: f64 = 10e3;

/// Of braking: a full torque within a few milliseconds \[Nm/s\].
const BRAKE_RATE: f64 = 100e3;

const FLANGE_LEFT: Pose = Pose {
    rotation: [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
    shift: [0.0, 0.0, 0.0],
};

/// Left arm with gripper on the body.
pub const OPENARM_V20_LEFT: ArmParameters = ArmParameters {
    name: "openarm_v20_left",
    base: Pose {
        rotation: [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        shift: [0.0, 0.1225, 0.0],
    },
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "J1",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 1.14167,
            com: [2.88441e-5, -0.015534, -0.00090035],
            inertia: [
                0.0006706590536717542,
                -6.667535391538138e-8,
                -4.5342751152997875e-8,
                0.0007591993243388566,
                9.416377008473691e-6,
                0.0010943256219893892,
            ],
            rotor_inertia: 0.0158,
            friction: Friction {
                coulomb: 0.2,
                viscous: 1.0,
                smoothing: 0.02,
            },
            position_range: [-3.4907, 1.3963],
            speed_limit: 16.755,
            end_approach: None,
            torque_limit: 40.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J2",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: FRAC_PI_2,
            mass: 0.277509,
            com: [-7.60578e-8, -0.0247185, 0.0312643],
            inertia: [
                0.00011306199999669479,
                2.9442535835578693e-10,
                3.758140891362489e-10,
                0.000153589167615701,
                -5.21058392185653e-6,
                8.229993238760421e-5,
            ],
            rotor_inertia: 0.0158,
            friction: Friction {
                coulomb: 0.2,
                viscous: 1.0,
                smoothing: 0.02,
            },
            position_range: [-3.3161, 0.17453],
            speed_limit: 16.755,
            end_approach: None,
            torque_limit: 40.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J3",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.22,
            angle_offset: FRAC_PI_2,
            mass: 1.07386,
            com: [-0.00300862, 0.04438199999999999, 0.000514813],
            inertia: [
                0.0012893932664960865,
                -6.761587880408298e-5,
                2.2997162826952685e-7,
                0.0005597657350186756,
                1.0626046254291207e-5,
                0.0011401919984852383,
            ],
            rotor_inertia: 0.032,
            friction: Friction {
                coulomb: 0.1,
                viscous: 0.9,
                smoothing: 0.02,
            },
            position_range: [-FRAC_PI_2, FRAC_PI_2],
            speed_limit: 5.4454,
            end_approach: None,
            torque_limit: 27.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J4",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.634853,
            com: [-0.00310326, 0.00136539, 0.0574601],
            inertia: [
                0.00046900387761768963,
                -5.636288527921002e-6,
                1.7787994452870447e-6,
                0.00043392643812077263,
                3.4177051757981436e-6,
                0.00024521168426153774,
            ],
            rotor_inertia: 0.032,
            friction: Friction {
                coulomb: 0.1,
                viscous: 0.9,
                smoothing: 0.02,
            },
            position_range: [0.0, 2.4435],
            speed_limit: 5.4454,
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
            angle_offset: 0.0,
            mass: 0.615659,
            com: [-0.000737189, 0.0734062, -0.000412407],
            inertia: [
                0.00027965371599553715,
                7.680976054202303e-7,
                3.3174249437991876e-6,
                0.00017666292139277375,
                -1.499338705823106e-7,
                0.000334599362611689,
            ],
            rotor_inertia: 0.0018,
            friction: Friction {
                coulomb: 0.04,
                viscous: 0.9,
                smoothing: 0.02,
            },
            position_range: [-FRAC_PI_2, FRAC_PI_2],
            speed_limit: 20.944,
            end_approach: None,
            torque_limit: 7.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "J6",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: FRAC_PI_2,
            mass: 0.475203,
            com: [5.44e-5, 0.000686496, 2.27438e-5],
            inertia: [
                0.00013534024648229564,
                3.3255242524401916e-8,
                -3.371043018785817e-8,
                0.00013624788013837224,
                6.586873452057612e-8,
                0.00017927587337933208,
            ],
            rotor_inertia: 0.0018,
            friction: Friction {
                coulomb: 0.04,
                viscous: 0.9,
                smoothing: 0.02,
            },
            position_range: [-FRAC_PI_4, FRAC_PI_4],
            speed_limit: 20.944,
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
            mass: 0.768019,
            com: [
                -0.07000140119931929,
                0.006061511180673917,
                0.005095034960202808,
            ],
            inertia: [
                0.00043187232066357255,
                -4.9818893791503127e-5,
                -0.00014068278467123152,
                0.0005471629749910107,
                -3.104595697813138e-5,
                0.0005850830259381591,
            ],
            rotor_inertia: 0.00043,
            friction: Friction {
                coulomb: 0.01,
                viscous: 0.01,
                smoothing: 0.02,
            },
            position_range: [-FRAC_PI_2, FRAC_PI_2],
            speed_limit: 20.944,
            end_approach: None,
            torque_limit: 7.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
    ],
    flange: FLANGE_LEFT,
    points: &openarm::points(&FLANGE_LEFT),
    limits: None,
    damping_postures: &[],
};

/// Right arm, the mirror image.
pub const OPENARM_V20_RIGHT: ArmParameters = openarm::mirrored(
    &OPENARM_V20_LEFT,
    "openarm_v20_right",
    &openarm::points(&openarm::pose(&FLANGE_LEFT)),
    &[(3, [1.0; 3]), (4, [1.0; 3])],
);

/// A true arm: errors of its bodies are drawn, and everything passes through frames of the motors'
/// bus, which takes a cycle. Motors 1 to 6 are those of version 1.0 and have the friction of the
/// maker's compensation law for it, which is far from that of the simulator in the table; motor 7
/// is another one and keeps the table's.
pub const OPENARM_V20_REALISTIC: Realistic = {
    let mut friction = OPENARM_V10_REALISTIC.friction;
    friction[6] = OPENARM_V20_LEFT.links[6].friction;
    Realistic {
        friction,
        interface: Interface::Frames([DM8009, DM8009, DM4340, DM4340, DM4310, DM4310, DM3507]),
        ..OPENARM_V10_REALISTIC
    }
};
