//! Every error path of the interface, called as C calls it.

mod arms_by_name;
mod pointers;
mod references;
mod settings;
mod states;

use std::ptr::null_mut;

use controller_core::fault::FaultKind;
use stratum::*;

fn fault(kind: FaultKind) -> StratumResult {
    kind.number().into()
}

/// Storages, initialised unless they are blank.
struct Bench {
    settings: Box<StratumSettings>,
    controller: Box<StratumController>,
    state: Box<StratumState>,
    blank_controller: Box<StratumController>,
    blank_state: Box<StratumState>,
}

const Q: [f64; 7] = [0.0, 0.5, 0.0, -1.5, 0.5, 1.0, 0.0];
const ZERO: [f64; 7] = [0.0; 7];
const BAD: [f64; 7] = [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0];

impl Bench {
    fn new() -> Self {
        let mut bench = Self {
            settings: Box::default(),
            controller: Box::new(StratumController {
                opaque: [0; STRATUM_CONTROLLER_WORDS],
            }),
            state: Box::new(StratumState {
                opaque: [0; STRATUM_STATE_WORDS],
            }),
            blank_controller: Box::new(StratumController {
                opaque: [0x0123_4567_89ab_cdef; STRATUM_CONTROLLER_WORDS],
            }),
            blank_state: Box::new(StratumState {
                opaque: [0x0123_4567_89ab_cdef; STRATUM_STATE_WORDS],
            }),
        };
        // SAFETY: here and below, pointers are null, misaligned, or to live objects.
        unsafe {
            let Self {
                settings,
                controller,
                state,
                ..
            } = &mut bench;
            assert_eq!(
                stratum_settings_default(STRATUM_ABI_VERSION, &mut **settings),
                STRATUM_OK
            );
            assert_eq!(stratum_controller_init(&mut **controller, &**settings), 0);
            assert_eq!(
                stratum_state_init(&mut **state, &**controller, Q.as_ptr()),
                0
            );
        }
        bench
    }
}

/// A pointer that is aligned for nothing and never read.
fn odd<T>() -> *mut T {
    std::ptr::without_provenance_mut(0x1001)
}

/// The three answers to a pointer: null, misaligned, not initialised.
fn storage<S>(blank: &mut S, call: impl Fn(*mut S) -> StratumResult) {
    assert_eq!(call(null_mut()), STRATUM_ERROR_NULL);
    assert_eq!(call(odd()), STRATUM_ERROR_MISALIGNED);
    assert_eq!(call(blank), STRATUM_ERROR_UNINITIALISED);
}

/// The two answers to a pointer that is only read or written.
fn plain<S>(call: impl Fn(*mut S) -> StratumResult) {
    assert_eq!(call(null_mut()), STRATUM_ERROR_NULL);
    assert_eq!(call(odd()), STRATUM_ERROR_MISALIGNED);
}
