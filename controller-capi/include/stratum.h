/* Stratum: strict-priority torque control of 7-joint arms. Link with libstratum.a.
 *
 * Generated from controller-capi by `controller-capi/check.sh header`; changed there.
 *
 * All storage is the caller's; nothing is allocated. Every function answers a
 * code and checks its pointers for null and alignment, and storage for having been
 * initialised. What it cannot check: other pointers point to objects of their
 * type, joint arrays have STRATUM_JOINTS entries, and no interrupt handler or thread
 * uses a storage during a call that changes it. A controller may be read by several at once.
 * Storage that was never initialised is recognised by its first 8 bytes: static
 * storage always. Joints, levels and links count from 1; SI units.
 */

#ifndef STRATUM_H
#define STRATUM_H

#include <stddef.h>
#include <stdint.h>

// What a function answers: STRATUM_OK, an argument error (1 to 31), a latched fault (32
// to 95) or a configuration error (from 128). The numbers are stable.
typedef int32_t StratumResult;
enum {
  // Done.
  STRATUM_OK = 0,
  // A pointer is null.
  STRATUM_ERROR_NULL = 1,
  // A pointer is not aligned for what it points to.
  STRATUM_ERROR_MISALIGNED = 2,
  // The storage holds no controller or state of this library: call its init function
  // first.
  STRATUM_ERROR_UNINITIALISED = 3,
  // A number is infinite, NaN or too large for the precision of the library.
  STRATUM_ERROR_NON_FINITE = 4,
  // The controller has no such level; levels count from 1.
  STRATUM_ERROR_LEVEL = 5,
  // The norm of a desired orientation is outside 0.5 to 2.
  STRATUM_ERROR_ORIENTATION = 6,
  // State and controller differ in their number of levels.
  STRATUM_ERROR_MISMATCH = 7,
  // Header and library are of different versions of the interface.
  STRATUM_ERROR_ABI = 8,
  // No arm of this name is built in; there are lwr_iv, iiwa_7, iiwa_14, panda,
  // panda_identified, fr3, gen3, openarm_v10_left, openarm_v10_right, openarm_v20_left,
  // openarm_v20_right.
  STRATUM_ERROR_PRESET = 9,
  // The text buffer has size 0.
  STRATUM_ERROR_TEXT_SIZE = 10,
  // A reference that is none: its kind does not exist, reserved is not 0, or a hold with
  // numbers other than 0.
  STRATUM_ERROR_TARGET = 11,
  // A position for a level that tracks an orientation, or the other way round.
  STRATUM_ERROR_WRONG_TARGET = 12,
  // The duration of a change is outside 0.05 to 60 s.
  STRATUM_ERROR_CHANGE_DURATION = 13,
  // The level is there, or another task is still leaving it.
  STRATUM_ERROR_LEVEL_TAKEN = 14,
  // The level is not there.
  STRATUM_ERROR_LEVEL_EMPTY = 15,
  // No such place among the levels; places count from 1.
  STRATUM_ERROR_PLACE = 16,
  // The levels would have more rows together than there is room for.
  STRATUM_ERROR_ROOM = 17,
  // An order that has not each level that is there once.
  STRATUM_ERROR_ORDER = 18,
  // Levels of the exact law are neither added, removed nor reordered.
  STRATUM_ERROR_EXACT_LAW = 19,
  // A null space whose damping or posture is of another kind than the controller's.
  STRATUM_ERROR_NULL_SPACE_KIND = 20,
  // Fault: a measurement or reference that cannot be true; the arm is braked and held.
  STRATUM_FAULT_IMPLAUSIBLE = 32,
  // Fault: the law gave a torque that is not finite; the arm is braked and held.
  STRATUM_FAULT_NON_FINITE_TORQUE = 33,
  // Fault: a target of another kind than the task of its level; the arm is braked and
  // held.
  STRATUM_FAULT_WRONG_TARGET = 34,
  // Settings: refused, see stratum_settings_text.
  STRATUM_CONFIG_OTHER = 128,
  // Settings: level_count is not 1 to 7.
  STRATUM_CONFIG_LEVELS = 129,
  // Settings: a choice (task, axes, absent, stale, damping, posture) that does not exist.
  STRATUM_CONFIG_CHOICE = 130,
  // Settings: the levels have more than 12 rows together, or with the exact law more than
  // 7.
  STRATUM_CONFIG_ROWS = 131,
  // Settings: a level has no axis.
  STRATUM_CONFIG_NO_AXIS = 132,
  // Settings: a level is on a link that does not exist.
  STRATUM_CONFIG_POINT_LINK = 133,
  // Settings: a point offset is not finite or too far away.
  STRATUM_CONFIG_POINT_OFFSET = 134,
  // Settings: an entry of a gain matrix is not finite or too large.
  STRATUM_CONFIG_GAIN_VALUE = 135,
  // Settings: a gain matrix is not symmetric.
  STRATUM_CONFIG_GAIN_SYMMETRY = 136,
  // Settings: a gain matrix is not positive definite.
  STRATUM_CONFIG_GAIN_DEFINITE = 137,
  // Settings: an observer gain is not above 0 or not finite.
  STRATUM_CONFIG_OBSERVER_GAIN = 138,
  // Settings: the nominal cycle is outside its range.
  STRATUM_CONFIG_CYCLE = 139,
  // Settings: too many cycles of dead time.
  STRATUM_CONFIG_DEAD_CYCLES = 140,
  // Settings: the rate of an inertia-shaped damping is not above 0 or not finite.
  STRATUM_CONFIG_INERTIA_DAMPING = 141,
  // Settings: the null-space damping is too strong for the cycle.
  STRATUM_CONFIG_DAMPING = 142,
  // Settings: the frame of a level has axes that are not orthogonal and of length 1.
  STRATUM_CONFIG_FRAME_ROTATION = 143,
  // Settings: a limit of a level is outside its range.
  STRATUM_CONFIG_LEVEL_LIMITS = 144,
  // Settings: an integrated posture needs the exact law.
  STRATUM_CONFIG_POSTURE = 145,
  // Settings: the age of a stale reference is outside its range.
  STRATUM_CONFIG_STALE_AGE = 146,
  // Arm or tool: a parameter is not finite.
  STRATUM_CONFIG_ARM_NON_FINITE = 160,
  // Arm: a parameter that must be above 0 is not.
  STRATUM_CONFIG_ARM_NOT_POSITIVE = 161,
  // Arm or tool: an inertia that no body can have.
  STRATUM_CONFIG_ARM_INERTIA = 162,
  // Arm or tool: a parameter is outside its range.
  STRATUM_CONFIG_ARM_RANGE = 163,
};

// What limited or degraded a cycle whose torque is valid, for logs: StratumStatus has a
// field for each. The numbers are stable and none is a StratumResult.
typedef int32_t StratumLimit;
enum {
  // Limit: torque of a joint cut to its limit.
  STRATUM_LIMIT_SATURATED = 96,
  // Limit: task row without acceleration: the rows above leave no motion for it.
  STRATUM_LIMIT_RANK = 97,
  // Limit: torque of a joint cut to its largest change per cycle.
  STRATUM_LIMIT_TORQUE_RATE = 98,
  // Limit: a level, or the posture, on its way to a reference that jumped.
  STRATUM_LIMIT_JOINING = 99,
  // Limit: a level near a singularity: along a direction it is driven less than it asks.
  STRATUM_LIMIT_DEGRADED = 100,
  // Limit: a level in a singularity: a direction is given to the levels below.
  STRATUM_LIMIT_RELEASED = 101,
  // Limit: command of a level shortened: its error, or a direction that it loses.
  STRATUM_LIMIT_SHAPED = 102,
  // Limit: a level, or the null space, gets a share of what it asks the joints for.
  STRATUM_LIMIT_SCALED = 103,
  // Limit: a joint at what its range or its speed limit allows.
  STRATUM_LIMIT_BOUNDED = 104,
  // Limit: bounds of the joints kept by a cut: too many at once to share out.
  STRATUM_LIMIT_UNRESOLVED = 105,
  // Limit: a level off its target in a singularity that no free motion leads out of.
  STRATUM_LIMIT_STUCK = 106,
  // Limit: a level, or the null space, on its way to tasks or gains that were changed.
  STRATUM_LIMIT_CHANGING = 107,
  // Limit: a level whose reference is too old: it comes to rest.
  STRATUM_LIMIT_STALE = 108,
};

// What a level tracks.
typedef uint32_t StratumTaskKind;
enum {
  // The position of the point.
  STRATUM_TASK_POSITION = 0,
  // The orientation of the frame; the offset is not read.
  STRATUM_TASK_ORIENTATION = 1,
};

// Axes that a level controls, base plate: a sum of at least one.
typedef uint32_t StratumAxes;
enum {
  // Along x, for an orientation about x.
  STRATUM_AXIS_X = 1,
  // Along y.
  STRATUM_AXIS_Y = 2,
  // Along z.
  STRATUM_AXIS_Z = 4,
};

// Damping of the null space.
typedef uint32_t StratumDampingKind;
enum {
  // A constant matrix: null_damping.
  STRATUM_DAMPING_JOINT = 0,
  // The mass matrix times null_damping_rate.
  STRATUM_DAMPING_INERTIA = 1,
};

// Posture towards which the null space is compliant.
typedef uint32_t StratumPostureKind;
enum {
  // The posture that was set.
  STRATUM_POSTURE_CONSTANT = 0,
  // The integral of the task motion, with coupling.
  STRATUM_POSTURE_INTEGRAL_COUPLED = 1,
  // The integral of the task motion, without coupling.
  STRATUM_POSTURE_INTEGRAL_UNCOUPLED = 2,
};

// What a level does that came to rest because its reference is too old.
typedef uint32_t StratumStaleKind;
enum {
  // It stays.
  STRATUM_STALE_HOLD = 0,
  // It goes until there is a fresh one.
  STRATUM_STALE_RELEASE = 1,
};

// What a cycle is part of; a fault is latched from STRATUM_MODE_BRAKING on.
typedef uint32_t StratumMode;
enum {
  // The law moves the arm.
  STRATUM_MODE_RUNNING = 0,
  // The law moves the arm, and a limit was active.
  STRATUM_MODE_LIMITED = 1,
  // A fault, and the arm moves: it is braked.
  STRATUM_MODE_BRAKING = 2,
  // A fault, and the arm rests: it is held by gravity torque.
  STRATUM_MODE_RESTING = 3,
  // A fault, and no measurement can be followed: the torque fades, the drives should
  // close their brakes.
  STRATUM_MODE_BLIND = 4,
  // The torque has faded to zero; only a reset leads out.
  STRATUM_MODE_STOPPED = 5,
};

// What a reference asks of its level.
typedef uint32_t StratumTargetKind;
enum {
  // Rest where the level is in the first cycle of holding; for every task.
  STRATUM_TARGET_HOLD = 0,
  // A position with velocity and acceleration: x, dx, ddx; for STRATUM_TASK_POSITION.
  STRATUM_TARGET_POSITION = 1,
  // An orientation with angular velocity and acceleration: orientation, dx, ddx; for
  // STRATUM_TASK_ORIENTATION.
  STRATUM_TARGET_ORIENTATION = 2,
};

// Storage of a controller in words of 8 bytes.
#define STRATUM_CONTROLLER_WORDS 1100

// Storage of a state in words of 8 bytes.
#define STRATUM_STATE_WORDS 3000

// sizeof(StratumController).
#define STRATUM_CONTROLLER_SIZE (STRATUM_CONTROLLER_WORDS * 8)

// Alignment of a StratumController.
#define STRATUM_CONTROLLER_ALIGN 8

// sizeof(StratumState).
#define STRATUM_STATE_SIZE (STRATUM_STATE_WORDS * 8)

// Alignment of a StratumState.
#define STRATUM_STATE_ALIGN 8

// A text buffer of this size holds every text.
#define STRATUM_TEXT_SIZE 512

// sizeof(StratumStatus).
#define STRATUM_STATUS_SIZE 96

// Joints of an arm.
#define STRATUM_JOINTS 7

// Bytes of a name, its end included.
#define STRATUM_NAME_SIZE 24

// sizeof(StratumReference).
#define STRATUM_REFERENCE_SIZE 112

// The version of the interface: numbers, structs and functions of this header.
#define STRATUM_ABI_VERSION 6

// Most levels.
#define STRATUM_LEVELS 7

// In the place of a link: what is on the tool, or without one on the flange.
#define STRATUM_ON_TOOL 8

// sizeof(StratumSettings).
#define STRATUM_SETTINGS_SIZE 5408

// Pose of a frame in a parent frame.
typedef struct StratumPose {
  // Takes axes of the frame to those of the parent: its columns are the frame's axes.
  double rotation[3][3];
  // Origin of the frame, axes of the parent, m.
  double shift[3];
} StratumPose;

// Friction of a joint: coulomb tanh(dq / smoothing) + viscous dq.
typedef struct StratumFriction {
  // Nm.
  double coulomb;
  // Nms/rad.
  double viscous;
  // Speed within which the Coulomb part changes its sign, rad/s; above 0.
  double smoothing;
} StratumFriction;

// What a data sheet allows near the ends of the range: towards an end at most
// -margin + sqrt(2 deceleration x the way to that end). None where the deceleration is 0.
typedef struct StratumEndApproach {
  // Speed that is taken off, rad/s.
  double margin;
  // rad/s2.
  double deceleration;
  // The ends, rad.
  double ends[2];
} StratumEndApproach;

// Tables of one link and of the joint that moves it, by the standard
// Denavit-Hartenberg convention.
typedef struct StratumLink {
  // The maker's name of the joint, for the caller's logs; not read.
  char name[STRATUM_NAME_SIZE];
  // Length along the new x axis, m.
  double a;
  // Twist about the new x axis, rad.
  double alpha;
  // Offset along the joint axis, m.
  double d;
  // Angle about the joint axis at q = 0, rad.
  double angle_offset;
  // Mass, kg.
  double mass;
  // Centre of mass in the link's frame, m.
  double com[3];
  // Inertia about the centre of mass, axes of the link's frame, kg m2:
  // Ixx Ixy Ixz Iyy Iyz Izz.
  double inertia[6];
  // Inertia of the rotor as the joint feels it, gear ratio squared, kg m2.
  double rotor_inertia;
  // Friction.
  struct StratumFriction friction;
  // Smallest and largest q, rad.
  double position_range[2];
  // Largest |dq| of the data sheet, rad/s.
  double speed_limit;
  // What the data sheet allows near the ends of the range.
  struct StratumEndApproach end_approach;
  // Largest |torque|, Nm.
  double torque_limit;
  // Largest change of the torque while the law runs, Nm/s.
  double torque_rate_limit;
  // The same while the arm is braked after a fault, Nm/s.
  double brake_rate_limit;
} StratumLink;

// How the law keeps joints within their ranges and speed limits. All zeros: a rule makes it
// from the rest of the tables.
typedef struct StratumJointLimits {
  // Largest acceleration that is asked of a joint, rad/s2.
  double acceleration[STRATUM_JOINTS];
  // Braking before the end of a range, rad/s2.
  double braking[STRATUM_JOINTS];
  // How fast the speed of a joint comes to what it may be, 1/s.
  double speed_gain[STRATUM_JOINTS];
  // How fast the last bit of the way to an end is gone, 1/s.
  double position_gain;
  // So far before the end of its range a joint stops, rad.
  double margin;
  // Share of the speed limit that a joint may use.
  double speed_share;
} StratumJointLimits;

// Tables of an arm and how it is mounted.
typedef struct StratumArm {
  // Its name, for the caller's logs; not read.
  char name[STRATUM_NAME_SIZE];
  // Pose of frame 0 in the base-plate frame: how the arm is mounted.
  struct StratumPose base;
  // Pose of the flange in frame 7.
  struct StratumPose flange;
  // Gravitational acceleration, base-plate axes, m/s2.
  double gravity[3];
  // Links, base to flange.
  struct StratumLink links[STRATUM_JOINTS];
  // What the law may do with the joints.
  struct StratumJointLimits limits;
} StratumArm;

// A tool, gripper or load fixed to the flange. Without mass and inertia it is only a frame.
typedef struct StratumTool {
  // Pose of the tool frame in the flange.
  struct StratumPose pose;
  // Mass, kg.
  double mass;
  // Centre of mass in the tool frame, m.
  double com[3];
  // Inertia about the centre of mass, axes of the tool frame, kg m2:
  // Ixx Ixy Ixz Iyy Iyz Izz.
  double inertia[6];
} StratumTool;

// What happens to a level near singularities and far from its target; orientations count at
// 0.1 m from their origin. All zeros: what the place of the level calls for.
typedef struct StratumLevelLimits {
  // Below this mobility a direction is driven less, 1/kg.
  double drive_mobility;
  // Below this mobility a direction is given to the levels below, 1/kg.
  double release_mobility;
  // No error calls for more speed than this, m/s.
  double error_speed;
  // No more speed is asked for along a direction that is lost, m/s.
  double lost_speed;
  // Where joints are at their bounds, a direction with this mobility resists them as much
  // again as the arm does, 1/kg.
  double stiff_mobility;
} StratumLevelLimits;

// One priority level.
typedef struct StratumLevel {
  // STRATUM_TASK_POSITION or STRATUM_TASK_ORIENTATION.
  StratumTaskKind task;
  // Link that is turned or carries the point, 1 to 7, or STRATUM_ON_TOOL.
  uint32_t link;
  // The point in the frame of the link or tool, m.
  double offset[3];
  // The frame of an orientation: takes its axes to those of the link or tool.
  double rotation[3][3];
  // Controlled axes: sum of STRATUM_AXIS_X, _Y and _Z.
  StratumAxes axes;
  // 1: the level is not there until stratum_level_add; else 0.
  uint32_t absent;
  // Stiffness of the error, 1/s2: acts on acceleration.
  double stiffness[3][3];
  // Damping of the error, 1/s.
  double damping[3][3];
  // What happens near singularities and far from the target.
  struct StratumLevelLimits limits;
  // Age from which on the level's reference is too old, s: it comes to rest then. 0: never.
  double stale_after_s;
  // STRATUM_STALE_HOLD or STRATUM_STALE_RELEASE: what follows once it rests.
  StratumStaleKind stale;
  // Always 0: completes the struct to whole words.
  uint32_t reserved;
} StratumLevel;

// Everything a controller is made of.
typedef struct StratumSettings {
  // Set by stratum_settings_default; not to be changed.
  uint32_t abi;
  // Levels in use, with those that are absent, 1 to 7; together at most 12 axes, with the exact
  // law 7.
  uint32_t level_count;
  // The arm with its limits, mounted as it is.
  struct StratumArm arm;
  // What it carries.
  struct StratumTool tool;
  // Levels, highest priority first.
  struct StratumLevel levels[STRATUM_LEVELS];
  // Null-space stiffness, symmetric positive definite, Nm/rad.
  double null_stiffness[STRATUM_JOINTS][STRATUM_JOINTS];
  // Null-space damping, symmetric positive definite, Nms/rad.
  double null_damping[STRATUM_JOINTS][STRATUM_JOINTS];
  // Rate of STRATUM_DAMPING_INERTIA, 1/s.
  double null_damping_rate;
  // STRATUM_DAMPING_JOINT or STRATUM_DAMPING_INERTIA.
  StratumDampingKind damping;
  // STRATUM_POSTURE_CONSTANT or one of the integrals.
  StratumPostureKind posture;
  // Bandwidth of the external-torque estimate, 1/s.
  double observer_gain[STRATUM_JOINTS];
  // Nominal cycle, s.
  double cycle_s;
  // Cycles between a measurement and the moment its torque acts.
  uint32_t dead_cycles;
  // Always 0.
  uint32_t reserved;
} StratumSettings;

// Storage of the immutable part: arm, levels, gains, limits. One controller can
// drive several states. It may be static, on a stack or copied.
typedef struct StratumController {
  // Not to be read or written.
  uint64_t opaque[STRATUM_CONTROLLER_WORDS];
} StratumController;

// Storage of what changes from cycle to cycle, with the references.
typedef struct StratumState {
  // Not to be read or written.
  uint64_t opaque[STRATUM_STATE_WORDS];
} StratumState;

// Desired motion of one level, base-plate axes. All of it 0 is a hold: a reference
// that nobody has filled moves nothing.
typedef struct StratumReference {
  // Position, m.
  double x[3];
  // Orientation quaternion w x y z, norm 0.5 to 2; not read for a position.
  double orientation[4];
  // Velocity, m/s, or angular velocity, rad/s.
  double dx[3];
  // Acceleration, m/s2, or angular acceleration, rad/s2.
  double ddx[3];
  // STRATUM_TARGET_POSITION or STRATUM_TARGET_ORIENTATION, as the level's task; or
  // STRATUM_TARGET_HOLD with 0 in all other fields.
  StratumTargetKind kind;
  // Always 0.
  uint32_t reserved;
} StratumReference;

// What limited or degraded the last cycle.
typedef struct StratumStatus {
  // The latched fault (STRATUM_FAULT_...), STRATUM_OK if there is none.
  StratumResult fault;
  // Joint or level of the fault, counted from 1; 0 where there is only one.
  uint32_t fault_index;
  // The value that made the fault.
  double fault_value;
  // Smallest value allowed.
  double fault_min;
  // Largest value allowed.
  double fault_max;
  // STRATUM_LIMIT_SATURATED: joints whose torque was cut to its limit, bit 0 is joint 1.
  uint32_t saturated;
  // STRATUM_LIMIT_RANK: task rows without acceleration, because the rows above them
  // leave no motion for them; bit 0 is the first row of level 1.
  uint32_t rank;
  // STRATUM_LIMIT_TORQUE_RATE: joints whose torque was cut to its largest change.
  uint32_t torque_rate;
  // What the cycle is part of, STRATUM_MODE_...
  StratumMode mode;
  // STRATUM_LIMIT_JOINING: levels on their way to a reference that jumped, bit 0 is
  // level 1; bit 7 is the posture.
  uint32_t joining;
  // STRATUM_LIMIT_DEGRADED: levels, bit 0 is level 1.
  uint32_t degraded;
  // STRATUM_LIMIT_RELEASED: levels.
  uint32_t released;
  // STRATUM_LIMIT_SHAPED: levels.
  uint32_t shaped;
  // STRATUM_LIMIT_SCALED: levels; bit 7 is the null space.
  uint32_t scaled;
  // STRATUM_LIMIT_BOUNDED: joints that may not go further down, bit 0 is joint 1.
  uint32_t at_least;
  // STRATUM_LIMIT_BOUNDED: joints that may not go further up.
  uint32_t at_greatest;
  // STRATUM_LIMIT_UNRESOLVED: 1 where it is so.
  uint32_t unresolved;
  // STRATUM_LIMIT_STUCK: levels.
  uint32_t stuck;
  // STRATUM_LIMIT_CHANGING: levels; bit 7 is the null space.
  uint32_t changing;
  // STRATUM_LIMIT_STALE: levels.
  uint32_t stale;
  // Exchanges that the projection onto the bounds of the joints took, 0 to 12.
  uint32_t pivots;
} StratumStatus;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the library, such as "0.1.0".
const char *stratum_version(void);

// Version of the library's interface: STRATUM_ABI_VERSION of its header.
uint32_t stratum_abi_version(void);

// Bits of the numbers the library computes in: 64 or 32.
uint32_t stratum_precision(void);

// Name of a code or limit, such as "STRATUM_ERROR_NULL"; never null.
const char *stratum_error_name(StratumResult result);

// Text of a code or limit; never null.
const char *stratum_error_text(StratumResult result);

// Tables of a built-in arm, such as "lwr_iv" or "fr3"; all names are in the text of
// STRATUM_ERROR_PRESET. To start from, or to change how it is mounted.
StratumResult stratum_arm_preset(const char *name, struct StratumArm *arm);

// Settings to start from: the LWR IV+ without tool, its flange in x, y, z as the one level
// (all seven are prepared alike), compliant null space, cycle of 2 ms. `abi` is
// STRATUM_ABI_VERSION of the header that the caller was compiled with.
StratumResult stratum_settings_default(uint32_t abi,
                                       struct StratumSettings *settings);

// The same of a built-in arm, as in stratum_arm_preset; the damping of another arm than the
// LWR IV+ is STRATUM_DAMPING_INERTIA. Apart from stratum_settings_default, so that a program
// which names no arm is linked with one table.
StratumResult stratum_settings_of_arm(uint32_t abi,
                                      const char *name,
                                      struct StratumSettings *settings);

// Says of settings what stratum_controller_init says, and why: thing, value and
// what is allowed, as a text of at most size - 1 characters; empty for good settings.
StratumResult stratum_settings_text(const struct StratumSettings *settings,
                                    char *text,
                                    size_t size);

// Validates the settings and makes a controller of them. After an error the
// storage holds no controller.
StratumResult stratum_controller_init(struct StratumController *controller,
                                      const struct StratumSettings *settings);

// The same with the exact law, which knows nothing of singularities, ranges and speed limits.
// A program that never calls stratum_controller_init is linked with this law alone.
StratumResult stratum_controller_init_exact(struct StratumController *controller,
                                            const struct StratumSettings *settings);

// Before the first cycle: nothing observed, no fault; the references keep every
// level and the null space at the posture `q` in rad, which must be one that the arm can
// have (STRATUM_FAULT_IMPLAUSIBLE).
StratumResult stratum_state_init(struct StratumState *state,
                                 const struct StratumController *controller,
                                 const double q[STRATUM_JOINTS]);

// Sets all references to rest where the posture `q` in rad puts them, one that the arm can
// have (STRATUM_FAULT_IMPLAUSIBLE).
StratumResult stratum_reference_hold(struct StratumState *state,
                                     const struct StratumController *controller,
                                     const double q[STRATUM_JOINTS]);

// Sets the reference of a level, from the next step on. One of another kind than the
// level's task is refused, and so is a hold with numbers.
StratumResult stratum_reference_set(struct StratumState *state,
                                    uint32_t level,
                                    const struct StratumReference *reference);

// The reference of a level as it is set: after stratum_state_init where the level
// is, to start a motion from.
StratumResult stratum_reference_get(const struct StratumState *state,
                                    uint32_t level,
                                    struct StratumReference *reference);

// Sets the posture in rad towards which the null space is compliant.
StratumResult stratum_posture_set(struct StratumState *state,
                                  const double posture[STRATUM_JOINTS]);

// One cycle: posture in rad, speeds in rad/s, time since the last measurement in s
// (the nominal cycle at first); torque in Nm, always finite and within limits.
// A measurement that cannot be true latches a fault: its number is answered, the
// torque brakes the arm and holds it, see STRATUM_MODE_BRAKING and behind, until
// stratum_reset. On an argument error the torque is zero and the state is as
// before. q, dq and torque may be the same array.
StratumResult stratum_step(const struct StratumController *controller,
                           struct StratumState *state,
                           const double q[STRATUM_JOINTS],
                           const double dq[STRATUM_JOINTS],
                           double interval_s,
                           double torque[STRATUM_JOINTS]);

// What limited or degraded the last cycle.
StratumResult stratum_status(const struct StratumState *state,
                             struct StratumStatus *status);

// The latched fault as a text of at most size - 1 characters: quantity, value, what
// is allowed; empty if there is none.
StratumResult stratum_fault_text(const struct StratumState *state,
                                 char *text,
                                 size_t size);

// Residual of the last cycle in Nm, tends to minus the torque that the arm exerts
// on its environment; zero while a fault is latched.
StratumResult stratum_residual(const struct StratumState *state,
                               double residual[STRATUM_JOINTS]);

// Gravity torque of the last cycle in Nm, contained in the torque: to be taken off
// for a robot that adds gravity itself.
StratumResult stratum_gravity(const struct StratumState *state,
                              double gravity[STRATUM_JOINTS]);

// Coriolis and centrifugal torque of the last cycle in Nm, contained in the torque.
StratumResult stratum_coriolis(const struct StratumState *state,
                               double coriolis[STRATUM_JOINTS]);

// Tells the observer that `torque` in Nm has acted since the last cycle instead of
// the one it assumes: for links that round, scale or lose torques.
StratumResult stratum_applied(struct StratumState *state,
                              const double torque[STRATUM_JOINTS]);

// The next cycle comes after a gap that is too long to be an interval, or is the first with
// a controller of the same arm with another tool: the observer keeps its residual and takes
// the momentum anew.
StratumResult stratum_skip(struct StratumState *state);

// The next references are followed as they are: a jump is not joined. For callers whose
// references start where the arm is, or who join them themselves.
StratumResult stratum_follow_at_once(struct StratumState *state);

// Clears a latched fault; the observer starts anew, the references stay.
StratumResult stratum_reset(struct StratumState *state);

// A level that is not there comes, in duration_s (0.05 to 60): the one of the settings with this
// number, at this place among those that are there (1: above all). Its reference is a hold until
// one is set. Between two steps; what cannot be changes nothing.
StratumResult stratum_level_add(const struct StratumController *controller,
                                struct StratumState *state,
                                const struct StratumSettings *settings,
                                uint32_t level,
                                uint32_t place,
                                double duration_s);

// A level that is there goes, in duration_s. The last one may, too: then all of the arm is
// compliant.
StratumResult stratum_level_remove(const struct StratumController *controller,
                                   struct StratumState *state,
                                   uint32_t level,
                                   double duration_s);

// A level that is there gets other gains, in duration_s.
StratumResult stratum_level_gains(const struct StratumController *controller,
                                  struct StratumState *state,
                                  uint32_t level,
                                  const double stiffness[9],
                                  const double damping[9],
                                  double duration_s);

// The levels that are there get another order: their numbers, highest priority first, count of
// them. A level that goes up goes and comes back, each in duration_s.
StratumResult stratum_level_order(const struct StratumController *controller,
                                  struct StratumState *state,
                                  const uint32_t *levels,
                                  uint32_t count,
                                  double duration_s);

// The null space gets the stiffness and damping of the settings, in duration_s. A damping matrix is
// searched through for its fastest mode, which takes far longer than a cycle.
StratumResult stratum_null_space(const struct StratumController *controller,
                                 struct StratumState *state,
                                 const struct StratumSettings *settings,
                                 double duration_s);

// Sets how old the reference of a level is, s, 0 unless said otherwise; what that means the
// settings say.
StratumResult stratum_reference_age(struct StratumState *state,
                                    uint32_t level,
                                    double age_s);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* STRATUM_H */

#ifdef __cplusplus
#define STRATUM_CHECK(condition) static_assert(condition, #condition)
#define STRATUM_ALIGNOF alignof
#else
#define STRATUM_CHECK(condition) _Static_assert(condition, #condition)
#define STRATUM_ALIGNOF _Alignof
#endif
STRATUM_CHECK(sizeof(StratumController) == STRATUM_CONTROLLER_SIZE);
STRATUM_CHECK(STRATUM_ALIGNOF(StratumController) == STRATUM_CONTROLLER_ALIGN);
STRATUM_CHECK(sizeof(StratumState) == STRATUM_STATE_SIZE);
STRATUM_CHECK(STRATUM_ALIGNOF(StratumState) == STRATUM_STATE_ALIGN);
STRATUM_CHECK(sizeof(StratumSettings) == STRATUM_SETTINGS_SIZE);
STRATUM_CHECK(sizeof(StratumReference) == STRATUM_REFERENCE_SIZE);
STRATUM_CHECK(sizeof(StratumStatus) == STRATUM_STATUS_SIZE);
#undef STRATUM_CHECK
#undef STRATUM_ALIGNOF
