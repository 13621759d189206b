//! What the library says besides a code.

use crate::codes::StratumResult;
use crate::constants::StratumMode;

/// A text buffer of this size holds every text.
pub const STRATUM_TEXT_SIZE: usize = 512;

/// What limited or degraded the last cycle.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StratumStatus {
    /// The latched fault (STRATUM_FAULT_...), STRATUM_OK if there is none.
    pub fault: StratumResult,
    /// Joint or level of the fault, counted from 1; 0 where there is only one.
    pub fault_index: u32,
    /// The value that made the fault.
    pub fault_value: f64,
    /// Smallest value allowed.
    pub fault_min: f64,
    /// Largest value allowed.
    pub fault_max: f64,
    /// STRATUM_LIMIT_SATURATED: joints whose torque was cut to its limit, bit 0 is joint 1.
    pub saturated: u32,
    /// STRATUM_LIMIT_RANK: task rows without acceleration, because the rows above them
    /// leave no motion for them; bit 0 is the first row of level 1.
    pub rank: u32,
    /// STRATUM_LIMIT_TORQUE_RATE: joints whose torque was cut to its largest change.
    pub torque_rate: u32,
    /// What the cycle is part of, STRATUM_MODE_...
    pub mode: StratumMode,
    /// STRATUM_LIMIT_JOINING: levels on their way to a reference that jumped, bit 0 is
    /// level 1; bit 7 is the posture.
    pub joining: u32,
    /// STRATUM_LIMIT_DEGRADED: levels, bit 0 is level 1.
    pub degraded: u32,
    /// STRATUM_LIMIT_RELEASED: levels.
    pub released: u32,
    /// STRATUM_LIMIT_SHAPED: levels.
    pub shaped: u32,
    /// STRATUM_LIMIT_SCALED: levels; bit 7 is the null space.
    pub scaled: u32,
    /// STRATUM_LIMIT_BOUNDED: joints that may not go further down, bit 0 is joint 1.
    pub at_least: u32,
    /// STRATUM_LIMIT_BOUNDED: joints that may not go further up.
    pub at_greatest: u32,
    /// STRATUM_LIMIT_UNRESOLVED: 1 where it is so.
    pub unresolved: u32,
    /// STRATUM_LIMIT_STUCK: levels.
    pub stuck: u32,
    /// STRATUM_LIMIT_CHANGING: levels; bit 7 is the null space.
    pub changing: u32,
    /// STRATUM_LIMIT_STALE: levels.
    pub stale: u32,
    /// Exchanges that the projection onto the bounds of the joints took, 0 to 12.
    pub pivots: u32,
}

/// sizeof(StratumStatus).
pub const STRATUM_STATUS_SIZE: usize = 96;
const _: () = assert!(size_of::<StratumStatus>() == STRATUM_STATUS_SIZE);
