//! Kinova Gen3, 7 joints.
//!
//! Source: Kinovarobotics/ros2_kortex, commit 1fdbef345954b326627dc3792981e18e2221450b,
//! kortex_description/arms/gen3/7dof/urdf/gen3_macro.xacro; licence BSD-3-Clause.
//! Kind of numbers: the maker's. Right angles are exact here; the file prints 1.5708 and 3.1416,
//! which moves M by up to 1.1e-5 kg m2, g by 5.8e-5 Nm and points by 6.4e-6 m.
//!
//! Unknown: rotor inertia, friction. Joints 1, 3, 5 and 7 are continuous; here they may turn
//! once to either side.

use core::f64::consts::{FRAC_PI_2, TAU};

use controller_core::arm::{
    ArmParameters, Friction, Link, LinkParameters, LinkPoint, NamedPoint, Pose,
};

/// No limit of the arm that is published: a net, above what motion and contact need \[Nm/s\].
const TORQUE_RATE: f64 = 10e3;

/// Of braking: a full torque within a few milliseconds \[Nm/s\].
const BRAKE_RATE: f64 = 100e3;

const FLANGE: Pose = Pose {
    rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
    shift: [0.0, 0.0, -0.167455],
};

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

/// Kinova Gen3 without gripper, upright.
pub const GEN3: ArmParameters = ArmParameters {
    name: "gen3",
    base: Pose {
        rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        shift: [0.0, 0.0, 0.28481],
    },
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "Actuator1",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 1.3773,
            com: [
                -2.2999999999998245e-5,
                0.05502005781220398,
                0.010363797900112758,
            ],
            inertia: [
                0.00457,
                1.9999963267813548e-6,
                -1.0000073464034322e-6,
                0.001408996708854399,
                -0.00044798743028004646,
                0.0048310032911456045,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-TAU, TAU],
            speed_limit: 1.3963,
            end_approach: None,
            torque_limit: 39.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "Actuator2",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: -0.011750773,
            angle_offset: 0.0,
            mass: 1.1636,
            com: [
                -4.400000000003226e-5,
                0.006902593008827951,
                -0.09957997464603202,
            ],
            inertia: [
                0.011088,
                -1.83660257194343e-11,
                4.999999999969187e-6,
                0.011254994923493163,
                0.0006910374042289239,
                0.0010720050765068469,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.24, 2.24],
            speed_limit: 1.3963,
            end_approach: None,
            torque_limit: 39.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "Actuator3",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: -0.420760023,
            angle_offset: 0.0,
            mass: 1.1636,
            com: [
                -4.399999999999783e-5,
                0.09248804780981366,
                0.006640660272475562,
            ],
            inertia: [
                0.010931999999999999,
                -6.99999999995288e-6,
                2.571243575794046e-11,
                0.0010429955482114729,
                -0.0006059629593833828,
                0.011127004451788535,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-TAU, TAU],
            speed_limit: 1.3963,
            end_approach: None,
            torque_limit: 39.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "Actuator4",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: -0.012750766,
            angle_offset: 0.0,
            mass: 0.9302,
            com: [
                -1.800000000000847e-5,
                0.008630511639976843,
                -0.07547796829886975,
            ],
            inertia: [
                0.008147,
                3.673205071771761e-12,
                -9.999999999927754e-7,
                0.008315996326691218,
                0.0005000282285677295,
                0.0006310036733087935,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.57, 2.57],
            speed_limit: 1.3963,
            end_approach: None,
            torque_limit: 39.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "Actuator5",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: -0.314360001,
            angle_offset: 0.0,
            mass: 0.6781,
            com: [
                1.0000000000789286e-6,
                0.04204703528838154,
                0.009431845552679022,
            ],
            inertia: [
                0.0015960000000000002,
                0.0,
                0.0,
                0.00039899811933528657,
                -0.0002559955627613272,
                0.0016070018806647172,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-TAU, TAU],
            speed_limit: 1.2218,
            end_approach: None,
            torque_limit: 9.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "Actuator6",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: -0.000350489,
            angle_offset: 0.0,
            mass: 0.6781,
            com: [
                1.0000000000058267e-6,
                0.009474727965707192,
                -0.0454829651976878,
            ],
            inertia: [
                0.001641,
                0.0,
                0.0,
                0.0016409979576813567,
                0.0002780045217079813,
                0.00041000204231864747,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-2.09, 2.09],
            speed_limit: 1.2218,
            end_approach: None,
            torque_limit: 9.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "Actuator7",
            a: 0.0,
            alpha: 0.0,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.5,
            com: [
                0.00028100000000000065,
                0.011402000000000016,
                -0.1357280000007149,
            ],
            inertia: [
                0.000587,
                2.9999999999999916e-6,
                2.999999999999997e-6,
                0.000369000000000001,
                -0.0001180000000000003,
                0.0006090000000000013,
            ],
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            position_range: [-TAU, TAU],
            speed_limit: 1.2218,
            end_approach: None,
            torque_limit: 9.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
    ],
    flange: FLANGE,
    points: POINTS,
    limits: None,
    damping_postures: &[],
};
