//! KUKA LWR IV+: a physically consistent parameter set.
//!
//! Computed from the 43 dynamic coefficients that Gaz, Flacco and De Luca
//! identified for this arm (ICRA 2014; feasibility of parameters: ICRA 2016), by
//! a semidefinite programme that keeps every link's pseudo-inertia positive.
//! 41 coefficients are met to round-off; the two that no rigid body can have
//! (J3xx - J3zz + J4zz and J7xx - J7yy) are fitted. Against the literal
//! coefficients gravity is exact and the mass matrix differs by 0.5 % in the
//! mean and 1.2 % at worst (Frobenius norm).
//!
//! Only M(q), C(q, dq) and g(q) are meaningful: single masses and centres of
//! mass are not identified (27 free directions). There is no rotor inertia and
//! no joint elasticity; friction is chosen, not identified. M77 = 1.584e-4 kg m2,
//! which bounds the damping of joint 7 (see [`controller_core::law::sampling`]).

use core::f64::consts::FRAC_PI_2;

use controller_core::joint::DOF;

use controller_core::arm::{
    ArmParameters, Friction, JointLimits, Link, LinkParameters, LinkPoint, NamedPoint, Pose,
};

use crate::realistic::Realistic;

/// The flange of the LWR IV+: 0.078 m beyond the wrist along z7.
pub const LWR_IV_FLANGE: LinkPoint = LinkPoint {
    link: Link::L7,
    offset: FLANGE.shift,
};

const FLANGE: Pose = Pose::at([0.0, 0.0, 0.078]);

/// Null-space stiffness K_q \[Nm/rad\] of the reference experiments on this arm.
pub const LWR_IV_STIFFNESS: [f64; DOF] = [20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2];

/// Null-space damping D \[Nms/rad\] of the reference experiments on this arm.
pub const LWR_IV_DAMPING: [f64; DOF] = [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03];

/// No limit of the arm: a tighter one behind the law would take from it what it brakes with
/// near singularities \[Nm/s\].
const TORQUE_RATE: f64 = 10e3;

/// A limit of 176 Nm within two milliseconds \[Nm/s\].
const BRAKE_RATE: f64 = 100e3;

/// Chosen on many passes through singularities, hard pushes and violent motions of this arm;
/// the rule for arms without own numbers gives nearly the same. Joint 7 needs its large gain:
/// 0.05 Nm of friction are 300 rad/s2 on it.
const LIMITS: JointLimits = JointLimits {
    acceleration: [20.0, 20.0, 25.0, 25.0, 90.0, 90.0, 200.0],
    braking: [8.0, 8.0, 10.0, 10.0, 15.0, 15.0, 15.0],
    speed_gain: [25.0, 25.0, 25.0, 25.0, 60.0, 60.0, 200.0],
    position_gain: 12.0,
    margin: core::f64::consts::PI / 180.0,
    speed_share: 0.9,
};

/// Postures \[deg\] at which a null-space damping is checked: the worst one found for the
/// reference damping, for the damping of each single joint and for equal
/// damping of all, then folded and wrist-aligned ones for damping matrices of
/// other shapes. The first joint has no influence. `tests/tests/damping.rs`
/// confirms on random postures that none is worse.
const DAMPING_POSTURES_DEG: [[f64; DOF]; 12] = [
    [0.0, 0.03, -6.85, -0.91, 1.38, 1.99, -2.53],
    [0.0, 0.01, 0.72, 0.1, -0.3, -2.72, -2.35],
    [0.0, 0.03, 0.0, 0.11, -0.29, -2.77, -2.31],
    [0.0, 0.03, -7.87, -0.76, 3.01, -0.72, -170.0],
    [0.0, 2.71, 1.91, 0.09, -0.54, -1.36, -2.83],
    [0.0, -0.04, -7.19, -0.35, -4.01, 1.2, 32.66],
    [0.0, 2.77, 1.94, 0.2, -0.28, -2.46, -0.05],
    [0.0, -0.12, 2.3, 0.59, -3.15, 0.14, 6.17],
    [0.0; DOF],
    [0.0, 60.0, 0.0, 120.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, -90.0, 0.0, 90.0, 0.0],
    [0.0, 90.0, 90.0, 90.0, 90.0, 0.0, 90.0],
];

/// The same in \[rad\].
const DAMPING_POSTURES: [[f64; DOF]; 12] = {
    let mut postures = DAMPING_POSTURES_DEG;
    let mut n = 0;
    while n < postures.len() * DOF {
        let angle = &mut postures[n / DOF][n % DOF];
        *angle = angle.to_radians();
        n += 1;
    }
    postures
};

/// Points of the arm that tasks and contacts name. The elbow is 0.4 m from the
/// shoulder, `upper` 0.25 m along the upper arm, `forearm` 0.2 m along the
/// forearm; the wrist is the distal end of link 5.
const POINTS: &[NamedPoint] = &[
    NamedPoint {
        name: "upper",
        point: LinkPoint {
            link: Link::L3,
            offset: [0.0, 0.15, 0.0],
        },
    },
    NamedPoint {
        name: "elbow",
        point: LinkPoint {
            link: Link::L3,
            offset: [0.0, 0.0, 0.0],
        },
    },
    NamedPoint {
        name: "forearm",
        point: LinkPoint {
            link: Link::L5,
            offset: [0.0, -0.19, 0.0],
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
        point: LWR_IV_FLANGE,
    },
];

/// Plus and minus this angle \[deg\], in rad.
const fn range(deg: f64) -> [f64; 2] {
    [-deg.to_radians(), deg.to_radians()]
}

/// Friction of a joint from F_c \[Nm\] and F_v \[Nms/rad\].
const fn friction(coulomb: f64, viscous: f64) -> Friction {
    Friction {
        coulomb,
        viscous,
        smoothing: 0.02,
    }
}

/// KUKA LWR IV+ without tool, mounted upright.
pub const LWR_IV: ArmParameters = ArmParameters {
    name: "lwr_iv",
    base: Pose::at([0.0, 0.0, 0.3105]),
    gravity: [0.0, 0.0, -9.81],
    links: [
        LinkParameters {
            name: "joint 1",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 2.7197684562423485,
            com: [0.0, 0.0, 0.0],
            inertia: [0.009, 0.0, 0.0, 0.006600186160950106, 0.0, 0.009],
            rotor_inertia: 0.0,
            friction: friction(1.0, 0.8),
            position_range: range(170.0),
            speed_limit: 110.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 176.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint 2",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 2.808308725617543,
            com: [
                0.0012883198941054483,
                -0.022107750006488163,
                0.15422428361830162,
            ],
            inertia: [
                0.0046252621074435035,
                1.4164160483024881e-05,
                0.0002434834581281519,
                0.0036863553473252403,
                0.0001719256286668181,
                0.005796584477358507,
            ],
            rotor_inertia: 0.0,
            friction: friction(1.0, 0.8),
            position_range: range(120.0),
            speed_limit: 110.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 176.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint 3",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.4,
            angle_offset: 0.0,
            mass: 2.8083087444905304,
            com: [
                -0.0012883198854470538,
                0.1502251237407962,
                0.005320533344260088,
            ],
            inertia: [
                0.08367099294966752,
                -0.00022901449769689258,
                -0.00011482168963620119,
                0.0094842553724042,
                0.00492561877887486,
                0.092508433055912,
            ],
            rotor_inertia: 0.0,
            friction: friction(0.7, 0.6),
            position_range: range(170.0),
            speed_limit: 128.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 100.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint 4",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 2.8525641464100606,
            com: [
                -0.001268332564775182,
                -0.005237989243763584,
                0.19999999114721784,
            ],
            inertia: [
                0.0707486056264959,
                0.00011310104508414952,
                -0.00040904996797162026,
                0.07350349559331468,
                0.006758660069067309,
                0.004122932378740494,
            ],
            rotor_inertia: 0.0,
            friction: friction(0.7, 0.6),
            position_range: range(120.0),
            speed_limit: 128.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 100.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint 5",
            a: 0.0,
            alpha: FRAC_PI_2,
            d: 0.39,
            angle_offset: 0.0,
            mass: 1.8426012749630818,
            com: [
                -0.0009161504569315045,
                -0.22285308342713758,
                -0.004806426594253375,
            ],
            inertia: [
                0.0048770362124084254,
                0.0001863982901334235,
                -3.6626271267255394e-05,
                0.003748833268720572,
                -4.934004848413699e-05,
                0.00407010983651615,
            ],
            rotor_inertia: 0.0,
            friction: friction(0.3, 0.2),
            position_range: range(170.0),
            speed_limit: 204.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 100.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint 6",
            a: 0.0,
            alpha: -FRAC_PI_2,
            d: 0.0,
            angle_offset: 0.0,
            mass: 1.2434486281950472,
            com: [
                -0.00033326668316087995,
                0.022069807796761355,
                0.007468365047186638,
            ],
            inertia: [
                0.0035596962062430246,
                -1.1608728351141714e-05,
                -5.41789047661759e-06,
                0.0030811597136957245,
                0.0001348718940797564,
                0.004016260281124971,
            ],
            rotor_inertia: 0.0,
            friction: friction(0.2, 0.1),
            position_range: range(120.0),
            speed_limit: 184.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 38.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
        LinkParameters {
            name: "joint 7",
            a: 0.0,
            alpha: 0.0,
            d: 0.0,
            angle_offset: 0.0,
            mass: 0.22500002408139755,
            com: [0.0, 0.0, 0.004838540491991647],
            inertia: [
                0.001352479412979517,
                0.0,
                0.0,
                0.001204079415195977,
                0.0,
                0.0001583999999992258,
            ],
            rotor_inertia: 0.0,
            friction: friction(0.05, 0.02),
            position_range: range(170.0),
            speed_limit: 184.0_f64.to_radians(),
            end_approach: None,
            torque_limit: 38.0,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        },
    ],
    flange: FLANGE,
    points: POINTS,
    limits: Some(LIMITS),
    damping_postures: &DAMPING_POSTURES,
};

/// A true LWR IV+: errors of its bodies are drawn, friction is the one chosen above.
pub const LWR_IV_REALISTIC: Realistic = Realistic::of_table(&LWR_IV);
