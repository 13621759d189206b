//! What a robot is: its version, what it watches, what is mounted on it.

use crate::reply::CartesianLimit;
use crate::request::{CollisionBehavior, Load};
use crate::robot::pose::IDENTITY;
use crate::state::{DOF, Pose};
use crate::version::Version;

/// Virtual walls that a robot has at most.
pub const WALLS: usize = 8;

/// Virtual walls by their number.
pub(super) type Walls = [Option<CartesianLimit>; WALLS];

/// Cycles in a row without a command, of which the last one ends the motion.
pub const LOST_MAX: u32 = 20;

/// How far the torque may go in a cycle \[Nm\].
pub const TORQUE_STEP_MAX: f64 = 1.0;

/// Which motions a robot takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motions {
    /// Torque of the client: controller *external* without generator, or beside joint speeds, as
    /// the vendor's client asks for it up to version 9.
    #[default]
    Torque,
    /// All that the interface has but the asynchronous one: the caller has the robot's own
    /// controllers, or does not need them.
    All,
}

/// How near to the end of its range a joint may be how fast: v + offset at most the root of
/// 2 deceleration (end - q), and at the other end likewise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// \[rad/s\].
    pub offset: f64,
    /// \[rad/s2\].
    pub deceleration: f64,
    /// Where the speed must be 0 at the latest: lower and upper \[rad\].
    pub ends: [f64; 2],
}

/// What a robot watches while a motion runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Lower and upper end of each joint's range \[rad\].
    pub position: [[f64; 2]; DOF],
    /// Joint speeds \[rad/s\].
    pub speed: [f64; DOF],
    /// Less of it near the ends of the range.
    pub approach: [Option<Approach>; DOF],
    /// Speed of the end effector \[m/s\], \[rad/s\].
    pub cartesian_speed: [f64; 2],
    /// Torque without gravity \[Nm\]: commands beyond are cut.
    pub torque: [f64; DOF],
    /// Range of the torque sensors \[Nm\]; a choice of this crate, the vendor does not say it.
    pub sensor: [f64; DOF],
}

const TORQUE: [f64; DOF] = [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0];
const SENSOR: [f64; DOF] = [100.0, 100.0, 100.0, 100.0, 15.0, 15.0, 15.0];

impl Limits {
    /// Of the Panda, from the vendor's documentation.
    pub const PANDA: Self = Self {
        position: [
            [-2.8973, 2.8973],
            [-1.7628, 1.7628],
            [-2.8973, 2.8973],
            [-3.0718, -0.0698],
            [-2.8973, 2.8973],
            [-0.0175, 3.7525],
            [-2.8973, 2.8973],
        ],
        speed: [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61],
        approach: [None; DOF],
        cartesian_speed: [1.7, 2.5],
        torque: TORQUE,
        sensor: SENSOR,
    };

    /// Of the FR3, from the vendor's documentation.
    pub const FR3: Self = Self {
        position: [
            [-2.7437, 2.7437],
            [-1.7837, 1.7837],
            [-2.9007, 2.9007],
            [-3.0421, -0.1518],
            [-2.8065, 2.8065],
            [0.5445, 4.5169],
            [-3.0159, 3.0159],
        ],
        speed: [2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26],
        approach: [
            approach(0.30, 6.0, [-2.7501, 2.7501]),
            approach(0.20, 2.585, [-1.7918, 1.7918]),
            approach(0.20, 3.5, [-2.9065, 2.9065]),
            approach(0.30, 4.0, [-3.0481, -0.1458]),
            approach(0.35, 17.0, [-2.8101, 2.8101]),
            approach(0.35, 5.5, [0.54092, 4.5205]),
            approach(0.35, 17.0, [-3.0196, 3.0196]),
        ],
        cartesian_speed: [3.0, 2.5],
        torque: TORQUE,
        sensor: SENSOR,
    };
}

const fn approach(offset: f64, deceleration: f64, ends: [f64; 2]) -> Option<Approach> {
    Some(Approach {
        offset,
        deceleration,
        ends,
    })
}

/// What is mounted on the flange for good, as the vendor's web interface sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndEffector {
    /// Mass \[kg\].
    pub m_ee: f64,
    /// Centre of mass in the flange frame \[m\].
    pub f_x_cee: [f64; 3],
    /// Inertia about it \[kg m2\], column by column.
    pub i_ee: [f64; 9],
    /// The nominal end effector in the flange frame \[m\].
    pub f_t_ne: Pose,
}

impl EndEffector {
    /// The bare flange.
    pub const NONE: Self = Self {
        m_ee: 0.0,
        f_x_cee: [0.0; 3],
        i_ee: [0.0; 9],
        f_t_ne: IDENTITY,
    };
}

/// What a robot is.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Of the interface.
    pub version: Version,
    /// What it watches.
    pub limits: Limits,
    /// Which motions it takes.
    pub motions: Motions,
    /// What is on its flange.
    pub end_effector: EndEffector,
    /// The load before a client sets one.
    pub load: Load,
    /// The end effector in the nominal one before a client sets it \[m\].
    pub ne_t_ee: Pose,
    /// The stiffness frame in the end effector before a client sets it \[m\].
    pub ee_t_k: Pose,
    /// Thresholds before a client sets them.
    pub collision: CollisionBehavior,
    /// Virtual walls by their number; they are told, and not watched.
    pub walls: [Option<CartesianLimit>; WALLS],
    /// How long a recovery takes \[cycles\].
    pub recovery_cycles: u32,
    /// Share of the new in the filtered external torque, 0 to 1: 1 filters nothing.
    pub external_gain: f64,
    /// `message_id` of the state before the first.
    pub message_id: u64,
}

impl Settings {
    /// A robot with nothing on its flange, that takes torque alone. What the vendor does not say is
    /// chosen: 20 Nm and N as thresholds, as in the vendor's examples; 50 ms for a recovery; a pole
    /// at 30 Hz for the external torque.
    #[must_use]
    pub const fn new(version: Version, limits: Limits) -> Self {
        let (torque, force) = ([20.0; DOF], [20.0; 6]);
        Self {
            version,
            limits,
            motions: Motions::Torque,
            end_effector: EndEffector::NONE,
            load: Load {
                m_load: 0.0,
                f_x_cload: [0.0; 3],
                i_load: [0.0; 9],
            },
            ne_t_ee: IDENTITY,
            ee_t_k: IDENTITY,
            collision: CollisionBehavior {
                lower_torque_acceleration: torque,
                upper_torque_acceleration: torque,
                lower_torque_nominal: torque,
                upper_torque_nominal: torque,
                lower_force_acceleration: force,
                upper_force_acceleration: force,
                lower_force_nominal: force,
                upper_force_nominal: force,
            },
            walls: [None; WALLS],
            recovery_cycles: 50,
            // 1 - exp(-2 pi 30 Hz 1 ms).
            external_gain: 0.171_796,
            message_id: 0,
        }
    }
}
