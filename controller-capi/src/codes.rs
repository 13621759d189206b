//! What a function answers: one number, with a name and a text.

use core::ffi::CStr;

use controller_core::config::ConfigError;
use controller_core::fault::FaultKind;
use controller_core::model::ModelError;

/// What a function answers: STRATUM_OK, an argument error (1 to 31), a latched
/// fault (32 to 95) or a configuration error (from 128). The numbers are stable.
pub type StratumResult = i32;

/// Done.
pub const STRATUM_OK: StratumResult = 0;
/// A pointer is null.
pub const STRATUM_ERROR_NULL: StratumResult = 1;
/// A pointer is not aligned for what it points to.
pub const STRATUM_ERROR_MISALIGNED: StratumResult = 2;
/// The storage holds no controller, or no state, of this library.
pub const STRATUM_ERROR_UNINITIALISED: StratumResult = 3;
/// A number is infinite or NaN, or too large for the precision of the library.
pub const STRATUM_ERROR_NON_FINITE: StratumResult = 4;
/// The controller has no such level; levels count from 1.
pub const STRATUM_ERROR_LEVEL: StratumResult = 5;
/// The norm of a desired orientation is outside 0.5 to 2.
pub const STRATUM_ERROR_ORIENTATION: StratumResult = 6;
/// State and controller differ in their number of levels.
pub const STRATUM_ERROR_MISMATCH: StratumResult = 7;
/// Header and library are of different versions of the interface.
pub const STRATUM_ERROR_ABI: StratumResult = 8;
/// No arm of this name is built in.
pub const STRATUM_ERROR_PRESET: StratumResult = 9;
/// A text buffer of size 0.
pub const STRATUM_ERROR_TEXT_SIZE: StratumResult = 10;

/// Fault: a measurement or reference that cannot be true.
pub const STRATUM_FAULT_IMPLAUSIBLE: StratumResult = 32;
/// Fault: the law gave a torque that is not finite.
pub const STRATUM_FAULT_NON_FINITE_TORQUE: StratumResult = 33;

/// Settings: another error of the configuration, see stratum_settings_text.
pub const STRATUM_CONFIG_OTHER: StratumResult = 128;
/// Settings: level_count is above 7.
pub const STRATUM_CONFIG_LEVELS: StratumResult = 129;
/// Settings: a choice (task, axes, damping, posture) that does not exist.
pub const STRATUM_CONFIG_CHOICE: StratumResult = 130;
/// Settings: the levels have no rows, or more than 7 together.
pub const STRATUM_CONFIG_ROWS: StratumResult = 131;
/// Settings: a level without an axis.
pub const STRATUM_CONFIG_NO_AXIS: StratumResult = 132;
/// Settings: a point on a link that does not exist.
pub const STRATUM_CONFIG_POINT_LINK: StratumResult = 133;
/// Settings: a point offset that is not finite, or too far away.
pub const STRATUM_CONFIG_POINT_OFFSET: StratumResult = 134;
/// Settings: an entry of a gain matrix is not finite, or too large.
pub const STRATUM_CONFIG_GAIN_VALUE: StratumResult = 135;
/// Settings: a gain matrix is not symmetric.
pub const STRATUM_CONFIG_GAIN_SYMMETRY: StratumResult = 136;
/// Settings: a gain matrix is not positive definite.
pub const STRATUM_CONFIG_GAIN_DEFINITE: StratumResult = 137;
/// Settings: an observer gain is not above 0, or not finite.
pub const STRATUM_CONFIG_OBSERVER_GAIN: StratumResult = 138;
/// Settings: the nominal cycle is outside its range.
pub const STRATUM_CONFIG_CYCLE: StratumResult = 139;
/// Settings: too many cycles of dead time.
pub const STRATUM_CONFIG_DEAD_CYCLES: StratumResult = 140;
/// Settings: the rate of an inertia-shaped damping is not above 0, or not finite.
pub const STRATUM_CONFIG_INERTIA_DAMPING: StratumResult = 141;
/// Settings: the null-space damping is too strong for the cycle.
pub const STRATUM_CONFIG_DAMPING: StratumResult = 142;
/// Arm: a parameter is not finite.
pub const STRATUM_CONFIG_ARM_NON_FINITE: StratumResult = 160;
/// Arm: a parameter that must be above 0 is not.
pub const STRATUM_CONFIG_ARM_NOT_POSITIVE: StratumResult = 161;
/// Arm: an inertia that no body can have.
pub const STRATUM_CONFIG_ARM_INERTIA: StratumResult = 162;

/// Every code: number, name, text.
#[rustfmt::skip]
static TABLE: [(StratumResult, &CStr, &CStr); 31] = [
    (STRATUM_OK, c"STRATUM_OK", c"done"),
    (STRATUM_ERROR_NULL, c"STRATUM_ERROR_NULL", c"a pointer is null"),
    (STRATUM_ERROR_MISALIGNED, c"STRATUM_ERROR_MISALIGNED", c"a pointer is not aligned for what it points to"),
    (STRATUM_ERROR_UNINITIALISED, c"STRATUM_ERROR_UNINITIALISED", c"the storage holds no controller or state of this library: call its init function first"),
    (STRATUM_ERROR_NON_FINITE, c"STRATUM_ERROR_NON_FINITE", c"a number is infinite, NaN or too large for the precision of the library"),
    (STRATUM_ERROR_LEVEL, c"STRATUM_ERROR_LEVEL", c"the controller has no such level; levels count from 1"),
    (STRATUM_ERROR_ORIENTATION, c"STRATUM_ERROR_ORIENTATION", c"the norm of a desired orientation is outside 0.5 to 2"),
    (STRATUM_ERROR_MISMATCH, c"STRATUM_ERROR_MISMATCH", c"state and controller differ in their number of levels"),
    (STRATUM_ERROR_ABI, c"STRATUM_ERROR_ABI", c"header and library are of different versions of the interface"),
    (STRATUM_ERROR_PRESET, c"STRATUM_ERROR_PRESET", c"no arm of this name is built in; there is lwr_iv"),
    (STRATUM_ERROR_TEXT_SIZE, c"STRATUM_ERROR_TEXT_SIZE", c"the text buffer has size 0"),
    (STRATUM_FAULT_IMPLAUSIBLE, c"STRATUM_FAULT_IMPLAUSIBLE", c"fault: a measurement or reference cannot be true; the arm is held by gravity torque"),
    (STRATUM_FAULT_NON_FINITE_TORQUE, c"STRATUM_FAULT_NON_FINITE_TORQUE", c"fault: the law gave a torque that is not finite; the arm is held by gravity torque"),
    (STRATUM_CONFIG_OTHER, c"STRATUM_CONFIG_OTHER", c"settings: refused, see stratum_settings_text"),
    (STRATUM_CONFIG_LEVELS, c"STRATUM_CONFIG_LEVELS", c"settings: level_count is above 7"),
    (STRATUM_CONFIG_CHOICE, c"STRATUM_CONFIG_CHOICE", c"settings: a choice that does not exist"),
    (STRATUM_CONFIG_ROWS, c"STRATUM_CONFIG_ROWS", c"settings: the levels have no rows or more than 7 together"),
    (STRATUM_CONFIG_NO_AXIS, c"STRATUM_CONFIG_NO_AXIS", c"settings: a level has no axis"),
    (STRATUM_CONFIG_POINT_LINK, c"STRATUM_CONFIG_POINT_LINK", c"settings: a point is on a link that does not exist"),
    (STRATUM_CONFIG_POINT_OFFSET, c"STRATUM_CONFIG_POINT_OFFSET", c"settings: a point offset is not finite or too far away"),
    (STRATUM_CONFIG_GAIN_VALUE, c"STRATUM_CONFIG_GAIN_VALUE", c"settings: an entry of a gain matrix is not finite or too large"),
    (STRATUM_CONFIG_GAIN_SYMMETRY, c"STRATUM_CONFIG_GAIN_SYMMETRY", c"settings: a gain matrix is not symmetric"),
    (STRATUM_CONFIG_GAIN_DEFINITE, c"STRATUM_CONFIG_GAIN_DEFINITE", c"settings: a gain matrix is not positive definite"),
    (STRATUM_CONFIG_OBSERVER_GAIN, c"STRATUM_CONFIG_OBSERVER_GAIN", c"settings: an observer gain is not above 0 or not finite"),
    (STRATUM_CONFIG_CYCLE, c"STRATUM_CONFIG_CYCLE", c"settings: the nominal cycle is outside its range"),
    (STRATUM_CONFIG_DEAD_CYCLES, c"STRATUM_CONFIG_DEAD_CYCLES", c"settings: too many cycles of dead time"),
    (STRATUM_CONFIG_INERTIA_DAMPING, c"STRATUM_CONFIG_INERTIA_DAMPING", c"settings: the rate of an inertia-shaped damping is not above 0 or not finite"),
    (STRATUM_CONFIG_DAMPING, c"STRATUM_CONFIG_DAMPING", c"settings: the null-space damping is too strong for the cycle"),
    (STRATUM_CONFIG_ARM_NON_FINITE, c"STRATUM_CONFIG_ARM_NON_FINITE", c"arm: a parameter is not finite"),
    (STRATUM_CONFIG_ARM_NOT_POSITIVE, c"STRATUM_CONFIG_ARM_NOT_POSITIVE", c"arm: a parameter that must be above 0 is not"),
    (STRATUM_CONFIG_ARM_INERTIA, c"STRATUM_CONFIG_ARM_INERTIA", c"arm: an inertia that no body can have"),
];

/// The row of a code, if there is one.
fn row(code: StratumResult) -> Option<&'static (StratumResult, &'static CStr, &'static CStr)> {
    TABLE.iter().find(|row| row.0 == code)
}

pub(crate) fn name(code: StratumResult) -> &'static CStr {
    row(code).map_or(c"unknown", |row| row.1)
}

pub(crate) fn text(code: StratumResult) -> &'static CStr {
    row(code).map_or(c"no such code", |row| row.2)
}

pub(crate) fn of_model(error: &ModelError) -> StratumResult {
    match error {
        ModelError::NonFinite { .. } => STRATUM_CONFIG_ARM_NON_FINITE,
        ModelError::NotPositive { .. } => STRATUM_CONFIG_ARM_NOT_POSITIVE,
        ModelError::ImpossibleInertia { .. } => STRATUM_CONFIG_ARM_INERTIA,
        _ => STRATUM_CONFIG_OTHER,
    }
}

pub(crate) fn of_config(error: &ConfigError) -> StratumResult {
    match error {
        ConfigError::Model(error) => of_model(error),
        ConfigError::Rows { .. } => STRATUM_CONFIG_ROWS,
        ConfigError::NoAxis { .. } => STRATUM_CONFIG_NO_AXIS,
        ConfigError::PointLink { .. } => STRATUM_CONFIG_POINT_LINK,
        ConfigError::PointOffset { .. } => STRATUM_CONFIG_POINT_OFFSET,
        ConfigError::GainValue { .. } => STRATUM_CONFIG_GAIN_VALUE,
        ConfigError::GainSymmetry { .. } => STRATUM_CONFIG_GAIN_SYMMETRY,
        ConfigError::GainDefinite { .. } => STRATUM_CONFIG_GAIN_DEFINITE,
        ConfigError::ObserverGain { .. } => STRATUM_CONFIG_OBSERVER_GAIN,
        ConfigError::Cycle { .. } => STRATUM_CONFIG_CYCLE,
        ConfigError::DeadCycles { .. } => STRATUM_CONFIG_DEAD_CYCLES,
        ConfigError::InertiaDamping { .. } => STRATUM_CONFIG_INERTIA_DAMPING,
        ConfigError::Damping { .. } => STRATUM_CONFIG_DAMPING,
        _ => STRATUM_CONFIG_OTHER,
    }
}

/// Faults keep their own numbers, also those this file has no name for.
pub(crate) fn of_fault(kind: FaultKind) -> StratumResult {
    StratumResult::from(kind as u8)
}

// The two numbers of the header are the core's.
const _: () = assert!(STRATUM_FAULT_IMPLAUSIBLE == FaultKind::Implausible as i32);
const _: () = assert!(STRATUM_FAULT_NON_FINITE_TORQUE == FaultKind::NonFiniteTorque as i32);
