//! What a function answers: one number, with a name and a text.

use core::ffi::CStr;

use controller_core::arm::ArmError;
use controller_core::fault::FaultKind;
use controller_core::{ChangeError, ConfigError};

use crate::constants::{Constant, c, constants};

/// What a function answers.
pub type StratumResult = i32;

constants! { ERRORS: StratumResult {
    STRATUM_OK = 0, "done";
    STRATUM_ERROR_NULL = 1, "a pointer is null";
    STRATUM_ERROR_MISALIGNED = 2, "a pointer is not aligned for what it points to";
    STRATUM_ERROR_UNINITIALISED = 3,
        "the storage holds no controller or state of this library: call its init function first";
    STRATUM_ERROR_NON_FINITE = 4,
        "a number is infinite, NaN or too large for the precision of the library";
    STRATUM_ERROR_LEVEL = 5, "the controller has no such level; levels count from 1";
    STRATUM_ERROR_ORIENTATION = 6, "the norm of a desired orientation is outside 0.5 to 2";
    STRATUM_ERROR_MISMATCH = 7, "state and controller differ in their number of levels";
    STRATUM_ERROR_ABI = 8, "header and library are of different versions of the interface";
    STRATUM_ERROR_PRESET = 9,
        "no arm of this name is built in; there are lwr_iv, iiwa_7, iiwa_14, panda, \
         panda_identified, fr3, gen3, openarm_v10_left, openarm_v10_right, openarm_v20_left, \
         openarm_v20_right";
    STRATUM_ERROR_TEXT_SIZE = 10, "the text buffer has size 0";
    STRATUM_ERROR_TARGET = 11,
        "a reference that is none: its kind does not exist, reserved is not 0, or a hold with \
         numbers other than 0";
    STRATUM_ERROR_WRONG_TARGET = 12,
        "a position for a level that tracks an orientation, or the other way round";
    STRATUM_ERROR_CHANGE_DURATION = 13, "the duration of a change is outside 0.05 to 60 s";
    STRATUM_ERROR_LEVEL_TAKEN = 14, "the level is there, or another task is still leaving it";
    STRATUM_ERROR_LEVEL_EMPTY = 15, "the level is not there";
    STRATUM_ERROR_PLACE = 16, "no such place among the levels; places count from 1";
    STRATUM_ERROR_ROOM = 17, "the levels would have more rows together than there is room for";
    STRATUM_ERROR_ORDER = 18, "an order that has not each level that is there once";
    STRATUM_ERROR_EXACT_LAW = 19, "levels of the exact law are neither added, removed nor reordered";
    STRATUM_ERROR_NULL_SPACE_KIND = 20,
        "a null space whose damping or posture is of another kind than the controller's";
}}

constants! { CONFIG_ERRORS: StratumResult {
    STRATUM_CONFIG_OTHER = 128, "settings: refused, see stratum_settings_text";
    STRATUM_CONFIG_LEVELS = 129, "settings: level_count is not 1 to 7";
    STRATUM_CONFIG_CHOICE = 130,
        "settings: a choice (task, axes, absent, stale, damping, posture) that does not exist";
    STRATUM_CONFIG_ROWS = 131,
        "settings: the levels have more than 12 rows together, or with the exact law more than 7";
    STRATUM_CONFIG_NO_AXIS = 132, "settings: a level has no axis";
    STRATUM_CONFIG_POINT_LINK = 133, "settings: a level is on a link that does not exist";
    STRATUM_CONFIG_POINT_OFFSET = 134, "settings: a point offset is not finite or too far away";
    STRATUM_CONFIG_GAIN_VALUE = 135,
        "settings: an entry of a gain matrix is not finite or too large";
    STRATUM_CONFIG_GAIN_SYMMETRY = 136, "settings: a gain matrix is not symmetric";
    STRATUM_CONFIG_GAIN_DEFINITE = 137, "settings: a gain matrix is not positive definite";
    STRATUM_CONFIG_OBSERVER_GAIN = 138, "settings: an observer gain is not above 0 or not finite";
    STRATUM_CONFIG_CYCLE = 139, "settings: the nominal cycle is outside its range";
    STRATUM_CONFIG_DEAD_CYCLES = 140, "settings: too many cycles of dead time";
    STRATUM_CONFIG_INERTIA_DAMPING = 141,
        "settings: the rate of an inertia-shaped damping is not above 0 or not finite";
    STRATUM_CONFIG_DAMPING = 142, "settings: the null-space damping is too strong for the cycle";
    STRATUM_CONFIG_FRAME_ROTATION = 143,
        "settings: the frame of a level has axes that are not orthogonal and of length 1";
    STRATUM_CONFIG_LEVEL_LIMITS = 144, "settings: a limit of a level is outside its range";
    STRATUM_CONFIG_POSTURE = 145, "settings: an integrated posture needs the exact law";
    STRATUM_CONFIG_STALE_AGE = 146, "settings: the age of a stale reference is outside its range";
    STRATUM_CONFIG_ARM_NON_FINITE = 160, "arm or tool: a parameter is not finite";
    STRATUM_CONFIG_ARM_NOT_POSITIVE = 161, "arm: a parameter that must be above 0 is not";
    STRATUM_CONFIG_ARM_INERTIA = 162, "arm or tool: an inertia that no body can have";
    STRATUM_CONFIG_ARM_RANGE = 163, "arm or tool: a parameter is outside its range";
}}

/// Faults and limits as the core numbers them.
macro_rules! registry {
    (
        faults { $($fault:ident = $fault_number:literal, $fault_name:literal, $fault_c:literal,
            $fault_meaning:literal;)* }
        limits { $($limit:ident = $limit_number:literal, $limit_name:literal, $limit_c:literal,
            $limit_meaning:literal;)* }
    ) => {
        /// The faults of the core.
        pub const FAULTS: &[Constant] = &[$(Constant {
            number: $fault_number,
            name: c(concat!("STRATUM_FAULT_", $fault_c, "\0")),
            text: c(concat!("fault: ", $fault_meaning, "; the arm is braked and held\0")),
        }),*];

        /// The limits of the core.
        pub const LIMITS: &[Constant] = &[$(Constant {
            number: $limit_number,
            name: c(concat!("STRATUM_LIMIT_", $limit_c, "\0")),
            text: c(concat!("limit: ", $limit_meaning, "\0")),
        }),*];
    };
}
controller_core::numbers!(registry);

/// Every code.
static TABLE: [&[Constant]; 4] = [ERRORS, FAULTS, LIMITS, CONFIG_ERRORS];

/// Whether all numbers are from `min` to `max` and rise.
const fn rise(list: &[Constant], min: i32, max: i32) -> bool {
    let mut i = 0;
    let mut least = min;
    while i < list.len() {
        if list[i].number < least || list[i].number > max {
            return false;
        }
        least = list[i].number + 1;
        i += 1;
    }
    true
}
// No number stands for two things. Of the core's numbers for limits, which go up to
// 159, those from 128 on are taken here.
const _: () = assert!(rise(ERRORS, 0, 31));
const _: () = assert!(rise(FAULTS, 32, 95));
const _: () = assert!(rise(LIMITS, 96, 127));
const _: () = assert!(rise(CONFIG_ERRORS, 128, i32::MAX - 1));

/// The row of a code, if there is one.
fn row(code: StratumResult) -> Option<&'static Constant> {
    let mut rows = TABLE.into_iter().flatten();
    rows.find(|row| row.number == code)
}

pub(crate) fn name(code: StratumResult) -> &'static CStr {
    row(code).map_or(c"unknown", |row| row.name)
}

pub(crate) fn text(code: StratumResult) -> &'static CStr {
    row(code).map_or(c"no such code", |row| row.text)
}

/// What a function answers by its result.
pub(crate) fn code(result: Result<(), StratumResult>) -> StratumResult {
    result.err().unwrap_or(STRATUM_OK)
}

pub(crate) fn of_config(error: &ConfigError) -> StratumResult {
    match error {
        ConfigError::Arm(ArmError::NonFinite { .. }) => STRATUM_CONFIG_ARM_NON_FINITE,
        ConfigError::Arm(ArmError::NotPositive { .. }) => STRATUM_CONFIG_ARM_NOT_POSITIVE,
        ConfigError::Arm(ArmError::ImpossibleInertia { .. }) => STRATUM_CONFIG_ARM_INERTIA,
        ConfigError::Arm(ArmError::OutOfRange { .. }) => STRATUM_CONFIG_ARM_RANGE,
        ConfigError::FrameRotation { .. } => STRATUM_CONFIG_FRAME_ROTATION,
        ConfigError::Levels { .. } => STRATUM_CONFIG_LEVELS,
        ConfigError::Rows { .. } | ConfigError::ExactRows { .. } => STRATUM_CONFIG_ROWS,
        ConfigError::PointOffset { .. } => STRATUM_CONFIG_POINT_OFFSET,
        ConfigError::GainValue { .. } => STRATUM_CONFIG_GAIN_VALUE,
        ConfigError::GainSymmetry { .. } => STRATUM_CONFIG_GAIN_SYMMETRY,
        ConfigError::GainDefinite { .. } => STRATUM_CONFIG_GAIN_DEFINITE,
        ConfigError::ObserverGain { .. } => STRATUM_CONFIG_OBSERVER_GAIN,
        ConfigError::Cycle { .. } => STRATUM_CONFIG_CYCLE,
        ConfigError::DeadCycles { .. } => STRATUM_CONFIG_DEAD_CYCLES,
        ConfigError::InertiaDamping { .. } => STRATUM_CONFIG_INERTIA_DAMPING,
        ConfigError::Damping { .. } => STRATUM_CONFIG_DAMPING,
        ConfigError::LevelLimits { .. } => STRATUM_CONFIG_LEVEL_LIMITS,
        ConfigError::IntegratedPosture => STRATUM_CONFIG_POSTURE,
        ConfigError::StaleAge { .. } => STRATUM_CONFIG_STALE_AGE,
        _ => STRATUM_CONFIG_OTHER,
    }
}

pub(crate) fn of_change(error: &ChangeError) -> StratumResult {
    match error {
        ChangeError::Config(error) => of_config(error),
        ChangeError::Duration { .. } => STRATUM_ERROR_CHANGE_DURATION,
        ChangeError::Slot { .. } => STRATUM_ERROR_LEVEL,
        ChangeError::SlotTaken { .. } => STRATUM_ERROR_LEVEL_TAKEN,
        ChangeError::SlotEmpty { .. } => STRATUM_ERROR_LEVEL_EMPTY,
        ChangeError::Place { .. } => STRATUM_ERROR_PLACE,
        ChangeError::Rows { .. } => STRATUM_ERROR_ROOM,
        ChangeError::Order { .. } => STRATUM_ERROR_ORDER,
        ChangeError::ExactLaw => STRATUM_ERROR_EXACT_LAW,
        ChangeError::DampingKind | ChangeError::Posture => STRATUM_ERROR_NULL_SPACE_KIND,
        _ => STRATUM_CONFIG_OTHER,
    }
}

/// Faults keep their own numbers.
pub(crate) fn of_fault(kind: FaultKind) -> StratumResult {
    StratumResult::from(kind.number())
}
