//! Opaque storage of the caller, of constant size whatever the library computes in.

/// Storage of a controller in words of 8 bytes.
pub const STRATUM_CONTROLLER_WORDS: usize = 1100;
/// Storage of a state in words of 8 bytes.
pub const STRATUM_STATE_WORDS: usize = 3000;
/// sizeof(StratumController).
pub const STRATUM_CONTROLLER_SIZE: usize = STRATUM_CONTROLLER_WORDS * 8;
/// Alignment of a StratumController.
pub const STRATUM_CONTROLLER_ALIGN: usize = 8;
/// sizeof(StratumState).
pub const STRATUM_STATE_SIZE: usize = STRATUM_STATE_WORDS * 8;
/// Alignment of a StratumState.
pub const STRATUM_STATE_ALIGN: usize = 8;

const _: () = assert!(size_of::<StratumController>() == STRATUM_CONTROLLER_SIZE);
const _: () = assert!(align_of::<StratumController>() == STRATUM_CONTROLLER_ALIGN);
const _: () = assert!(size_of::<StratumState>() == STRATUM_STATE_SIZE);
const _: () = assert!(align_of::<StratumState>() == STRATUM_STATE_ALIGN);

/// Storage of the immutable part: arm, levels, gains, limits. One controller can
/// drive several states. It may be static, on a stack or copied.
#[repr(C)]
pub struct StratumController {
    /// Not to be read or written.
    pub opaque: [u64; STRATUM_CONTROLLER_WORDS],
}

/// Storage of what changes from cycle to cycle, with the references.
#[repr(C)]
pub struct StratumState {
    /// Not to be read or written.
    pub opaque: [u64; STRATUM_STATE_WORDS],
}
