//! What is allowed: the bounds of a configuration and of what is believed, declared
//! once for validation, messages and documents.

use crate::joint::DOF;

/// Most task rows of all levels together: more than an arm with seven joints can serve, so
/// that a pose may stand above an elbow. What cannot be served is released from below.
pub const MAX_ROWS: usize = 12;

/// The same of the exact law, which releases nothing.
pub const EXACT_ROWS: usize = DOF;

/// Most priority levels.
pub const MAX_LEVELS: usize = 7;

/// Nominal cycle times that make sense \[s\].
pub const CYCLE_RANGE_S: [f64; 2] = [1e-4, 20e-3];

/// Most cycles of dead time.
pub const DEAD_CYCLES_MAX: u8 = 8;

/// Largest |gain| accepted: beyond it single precision overflows in the law.
pub const GAIN_MAX: f64 = 1e9;

/// Farthest point of a task from its link's frame \[m\].
pub const POINT_OFFSET_MAX_M: f64 = 10.0;

/// Largest entry of R^T R - 1 of a rotation: those printed with ten digits pass, those with
/// five do not.
pub const DISTORTION_MAX: f64 = 1e-9;

/// Largest h c of an inertia-shaped damping D = c M.
pub const INERTIA_DAMPING_BOUND: f64 = 0.5;

/// Largest |angle| \[rad\] of a joint, offset and margin included: 100 turns, which is as far as
/// [`Real::sine_cosine`](crate::real::Real::sine_cosine) is tested.
pub const ANGLE_MAX: f64 = 100.0 * core::f64::consts::TAU;

/// Largest gravitational acceleration \[m/s2\]: beyond it a unit is mistaken.
pub const GRAVITY_MAX: f64 = 30.0;

/// Least mass of a link \[kg\]: below it the mass matrix has no inverse in single precision.
pub const MASS_MIN: f64 = 1e-6;

/// How far beyond its range a measured joint position is still believed \[rad\].
pub const POSITION_MARGIN: f64 = 0.2;

/// Multiple of the data-sheet speed up to which a measured speed is believed.
pub const SPEED_FACTOR: f64 = 3.0;

/// Multiples of the nominal cycle between which a measured interval is believed.
pub const INTERVAL_FACTORS: [f64; 2] = [0.5, 20.0];

/// Norms between which a desired orientation is believed to be a quaternion.
pub const QUATERNION_NORMS: [f64; 2] = [0.5, 2.0];

/// c of the torque g - c M dq that brakes an arm with a fault \[1/s\].
pub const BRAKE_RATE: f64 = 60.0;

/// Largest h c of it, as a share of what the dead time allows
/// ([`sampling::bound`](crate::law::sampling::bound), 2 without): below 1/2 where h is all.
pub const BRAKE_DECAY_BOUND: f64 = 0.24;

/// An arm with a fault rests once every joint is slower \[rad/s\].
pub const RESTING_SPEED: f64 = 0.02;

/// An arm that rested moves again once a joint is faster \[rad/s\].
pub const MOVING_SPEED: f64 = 0.05;

/// Time in which the torque of an arm with a fault goes to zero when no measurement can be
/// followed any more \[s\]: the drives' own brakes close in less.
pub const BLIND_FADE_S: f64 = 0.5;

/// Farthest beyond the outstretched arm that a target may be \[m\]: nearer ones that cannot
/// be reached are served as far as can be.
pub const REACH_MARGIN_M: f64 = 0.5;

/// Largest |dx_d| \[m/s\] and |w_d| \[rad/s\].
pub const TARGET_SPEED_MAX: [f64; 2] = [20.0, 200.0];

/// Largest |ddx_d| \[m/s2\] and |dw_d| \[rad/s2\].
pub const TARGET_ACCELERATION_MAX: [f64; 2] = [500.0, 5000.0];

/// Multiple of the range of a joint, about its middle, within which q_d must be.
pub const POSTURE_FACTOR: f64 = 2.0;

/// From this on a target is elsewhere than the one before it leads to: position \[m\] and
/// orientation \[rad\].
pub const JUMP: [f64; 2] = [5e-3, 0.05];

/// The same of a joint of q_d between two cycles \[rad\].
pub const POSTURE_JUMP: f64 = 0.05;

/// Shortest time in which a jump is joined \[s\].
pub const JOIN_S: f64 = 0.3;

/// Mean speed at which a far jump is joined \[m/s\], \[rad/s\].
pub const JOIN_SPEED: [f64; 2] = [0.25, 0.5];

/// Time in which a level that holds comes to rest \[s\].
pub const HOLD_S: f64 = 0.2;

/// Time in which a task comes, goes or gets other gains, unless a change says otherwise \[s\].
pub const CHANGE_S: f64 = 0.5;

/// Times that a change may take \[s\]: below, what it does to the torque is a step.
pub const CHANGE_RANGE_S: [f64; 2] = [0.05, 60.0];

/// Largest change of a nearness in a cycle while levels come and go: a limit of a command that comes
/// in then cuts it over some cycles.
pub const PACE: f64 = 0.006;

/// Nearness between which that holds; at 1 commands get a limit.
pub const PACED_NEARNESS: [f64; 2] = [0.5, 1.2];

/// Least share of their rates with which levels come and go.
pub const SLOWEST_PACE: f64 = 0.03;

/// Ages after which a reference may be called stale \[s\].
pub const STALE_RANGE_S: [f64; 2] = [1e-3, 3600.0];

/// Largest h K of a resolver: the error of a level shrinks without changing its sign.
pub const RESOLVER_GAIN_BOUND: f64 = 1.0;

/// How far a position command of a resolver may be from the arm \[rad\]: an arm that does
/// not follow is not wound up.
pub const COMMAND_LEAD_MAX: f64 = 0.1;

/// ell \[m\]: at this distance from its origin a turn counts as a way, where mobilities, errors
/// and speeds of orientations are held against those of positions.
pub const ORIENTATION_LENGTH: f64 = 0.1;

/// Mobilities that thresholds may have \[1/kg\]: below, single precision has nothing left of
/// its rows; above, an ordinary arm is always at a threshold.
pub const MOBILITY_RANGE: [f64; 2] = [1e-4, 1.0];

/// Speeds that a level may be held to \[m/s\].
pub const LEVEL_SPEED_RANGE: [f64; 2] = [1e-3, 20.0];

/// Accelerations \[rad/s2\] and gains \[1/s\] that a joint may be limited with.
pub const JOINT_LIMIT_RANGE: [f64; 2] = [1e-2, 1e5];

/// kappa \[1/s\]: how fast null-space motion decays where a direction is fully released.
pub const RELEASE_DAMPING: f64 = 20.0;

/// Acceleration that bends a straight arm \[rad/s2\]: where it comes and goes the torque of an
/// elbow changes by less than 1 Nm, and against kappa it reaches 0.025 rad/s: a degree, from
/// where on a level drives by itself, in 0.7 s.
pub const BEND_ACCELERATION: f64 = 0.5;

/// From this error along a lost direction on \[m\] a straight arm is bent, fully so from twice
/// that: below, friction and the last bit of the way to a target at the reach of the arm.
pub const BEND_ERROR: f64 = 5e-3;

/// Least that bending a joint must bring a level nearer \[m/rad2\]: below, it is rounding or a
/// joint that does not bend the arm.
pub const BEND_CURVATURE_MIN: f64 = 0.01;

/// Least room of a joint on the side that it is bent to \[rad\]: with less the arm stays where its
/// level is released.
pub const BEND_ROOM_MIN: f64 = 0.1;

/// So far to a side of the straight posture q_d decides \[rad\], or the room in the range.
pub const BEND_TOWARDS: f64 = 0.0175;

/// An arm that is bent twice so far to the side that is not preferred goes on there \[rad\].
pub const BEND_PREFERRED: f64 = 0.0044;

/// c: share of what it would give by itself that a direction of a level below the first gives at
/// bounds of joints, at least.
pub const GIVE_BELOW: f64 = 0.003;

/// dev0 \[m/s2\]: a level that the bounds of the joints disturb by so much gives way twice as far.
pub const SOFTENING_DISTURBANCE: f64 = 2.0;

/// beta: share by which the remembered disturbance of a level follows that of a cycle.
pub const DISTURBANCE_SMOOTHING: f64 = 0.2;

/// Most exchanges of the projection onto the bounds of the joints in one cycle.
pub const PIVOTS: u8 = 12;
