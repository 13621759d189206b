//! Pointers that are none.

use std::ffi::c_char;
use std::ptr::{null, null_mut};

use stratum::*;

use super::{Bench, Q, ZERO, odd, plain, storage};

#[test]
fn every_pointer_of_every_function_is_checked() {
    let bench = &mut Bench::new();
    let c: *mut StratumController = &mut *bench.controller;
    let s: *mut StratumState = &mut *bench.state;
    let settings: *mut StratumSettings = &mut *bench.settings;
    let bc = &mut *bench.blank_controller;
    let bs = &mut *bench.blank_state;
    let q = Q.as_ptr();
    let mut torque = ZERO;
    let t = torque.as_mut_ptr();
    let mut text = [0 as c_char; STRATUM_TEXT_SIZE];
    let text = text.as_mut_ptr();
    let mut reference = StratumReference::default();
    let r: *mut StratumReference = &mut reference;
    // SAFETY: see `Bench::new`.
    unsafe {
        plain(|p| stratum_settings_default(STRATUM_ABI_VERSION, p));
        plain(|p| stratum_arm_preset(c"lwr_iv".as_ptr(), p));
        assert_eq!(stratum_arm_preset(null(), odd()), STRATUM_ERROR_NULL);
        assert_eq!(
            stratum_arm_preset(c"lwr".as_ptr(), null_mut()),
            STRATUM_ERROR_PRESET
        );
        let abi = STRATUM_ABI_VERSION;
        plain(|p| stratum_settings_of_arm(abi, c"fr3".as_ptr(), p));
        assert_eq!(
            stratum_settings_of_arm(abi, null(), odd()),
            STRATUM_ERROR_NULL
        );
        assert_eq!(
            stratum_settings_of_arm(abi, c"fr".as_ptr(), null_mut()),
            STRATUM_ERROR_PRESET
        );
        assert_eq!(
            stratum_settings_of_arm(abi - 1, c"fr3".as_ptr(), null_mut()),
            STRATUM_ERROR_ABI
        );
        plain(|p| stratum_settings_text(p, text, STRATUM_TEXT_SIZE));
        assert_eq!(
            stratum_settings_text(settings, null_mut(), 9),
            STRATUM_ERROR_NULL
        );
        assert_eq!(
            stratum_settings_text(settings, text, 0),
            STRATUM_ERROR_TEXT_SIZE
        );

        storage(bs, |p| stratum_reference_hold(p, c, q));
        storage(bc, |p| stratum_reference_hold(s, p, q));
        plain(|p| stratum_reference_hold(s, c, p));
        storage(bs, |p| stratum_reference_set(p, 1, r));
        plain(|p| stratum_reference_set(s, 1, p));
        storage(bs, |p| stratum_reference_get(p, 1, r));
        plain(|p| stratum_reference_get(s, 1, p));
        for level in [0, 2, u32::MAX] {
            assert_eq!(stratum_reference_set(s, level, r), STRATUM_ERROR_LEVEL);
            assert_eq!(stratum_reference_get(s, level, r), STRATUM_ERROR_LEVEL);
        }
        storage(bs, |p| stratum_posture_set(p, q));
        plain(|p| stratum_posture_set(s, p));
        storage(bc, |p| stratum_step(p, s, q, q, 0.002, t));
        storage(bs, |p| stratum_step(c, p, q, q, 0.002, t));
        plain(|p| stratum_step(c, s, p, q, 0.002, t));
        plain(|p| stratum_step(c, s, q, p, 0.002, t));
        plain(|p| stratum_step(c, s, q, q, 0.002, p));
        for vector in [stratum_residual, stratum_gravity, stratum_coriolis] {
            storage(bs, |p| vector(p, t));
            plain(|p| vector(s, p));
        }
        let mut status = StratumStatus::default();
        let status_at = &raw mut status;
        storage(bs, |p| stratum_status(p, status_at));
        plain(|p| stratum_status(s, p));
        storage(bs, |p| stratum_fault_text(p, text, 9));
        assert_eq!(stratum_fault_text(s, null_mut(), 9), STRATUM_ERROR_NULL);
        assert_eq!(stratum_fault_text(s, text, 0), STRATUM_ERROR_TEXT_SIZE);
        storage(bs, |p| stratum_applied(p, q));
        plain(|p| stratum_applied(s, p));
        storage(bs, |p| stratum_skip(p));
        storage(bs, |p| stratum_reset(p));

        // Last, because an error empties the storage.
        plain(|p| stratum_controller_init(p, settings));
        plain(|p| stratum_state_init(p, c, q));
        storage(bc, |p| stratum_state_init(s, p, q));
        plain(|p| stratum_state_init(s, c, p));
        plain(|p| stratum_controller_init(c, p));
        assert_eq!(stratum_reset(s), STRATUM_ERROR_UNINITIALISED);
        assert_eq!(stratum_state_init(s, c, q), STRATUM_ERROR_UNINITIALISED);
    }
}
