//! Refusals of settings, versions and defaults.

use std::ffi::{CStr, c_char};
use std::ptr::null_mut;

use arms::LWR_IV;
use stratum::*;

use super::Bench;

/// A change of the settings, its code, and what its text says.
type Case = (fn(&mut StratumSettings), StratumResult, &'static str);

#[test]
fn every_refusal_of_settings_names_thing_value_and_allowed() {
    #[rustfmt::skip]
    let cases: [Case; 35] = [
        (|s| s.abi = 1, STRATUM_ERROR_ABI, "settings.abi is 1; this library has 6"),
        (|s| s.level_count = 8, STRATUM_CONFIG_LEVELS, "level_count is 8; allowed 1 to 7"),
        (|s| s.level_count = 0, STRATUM_CONFIG_LEVELS, "level_count is 0; allowed 1 to 7"),
        (|s| s.levels[0].task = 2, STRATUM_CONFIG_CHOICE, "level 1: task is 2; allowed 0 to 1"),
        (|s| s.levels[0].axes = 9, STRATUM_CONFIG_CHOICE, "level 1: axes is 9; allowed 1 to 7"),
        (|s| s.damping = 2, STRATUM_CONFIG_CHOICE, "damping is 2; allowed 0 to 1"),
        (|s| s.posture = u32::MAX, STRATUM_CONFIG_CHOICE, "posture is 4294967295; allowed 0 to 2"),
        (|s| s.level_count = 5, STRATUM_CONFIG_ROWS, "15 rows together; allowed 1 to 12"),
        (|s| s.levels[0].absent = 2, STRATUM_CONFIG_CHOICE, "level 1: absent is 2; allowed 0 to 1"),
        (|s| s.levels[0].stale = 2, STRATUM_CONFIG_CHOICE, "level 1: stale is 2; allowed 0 to 1"),
        (|s| s.levels[0].stale_after_s = -1.0, STRATUM_CONFIG_STALE_AGE, "level 1: age -1 s from which on a reference is stale; allowed 0.001 to 3600"),
        (|s| { s.level_count = 2; s.levels[1].axes = 0; }, STRATUM_CONFIG_NO_AXIS, "level 2: axes is 0; allowed 1 to 7"),
        (|s| s.levels[0].link = 9, STRATUM_CONFIG_POINT_LINK, "level 1: link is 9; allowed 1 to 8"),
        (|s| { s.levels[0].task = 1; s.levels[0].link = 0; }, STRATUM_CONFIG_POINT_LINK, "level 1: link is 0; allowed 1 to 8"),
        (|s| s.levels[0].offset[0] = f64::NAN, STRATUM_CONFIG_POINT_OFFSET, "NaN m; allowed -10 to 10"),
        (|s| s.null_stiffness[1][1] = f64::INFINITY, STRATUM_CONFIG_GAIN_VALUE, "entry inf; allowed -1e9 to 1e9"),
        (|s| s.null_stiffness[1][0] = 2.0, STRATUM_CONFIG_GAIN_SYMMETRY, "entry (2, 1) differs from (1, 2) by 2;"),
        (|s| s.levels[0].stiffness[2][2] = 0.0, STRATUM_CONFIG_GAIN_DEFINITE, "pivot 0 at row 3;"),
        (|s| s.observer_gain[6] = -1.0, STRATUM_CONFIG_OBSERVER_GAIN, "joint 7 is -1 1/s; it must be above 0"),
        (|s| s.cycle_s = 0.0, STRATUM_CONFIG_CYCLE, "cycle 0 s; allowed 0.0001 to 0.02"),
        (|s| s.dead_cycles = 9, STRATUM_CONFIG_DEAD_CYCLES, "dead time of 9 cycles; allowed 0 to 8"),
        (|s| s.dead_cycles = 300, STRATUM_CONFIG_DEAD_CYCLES, "dead_cycles is 300; allowed 0 to 8"),
        (|s| { s.damping = STRATUM_DAMPING_INERTIA; s.null_damping_rate = 0.0; }, STRATUM_CONFIG_INERTIA_DAMPING, "damping 0 1/s; it must be above 0"),
        (|s| s.null_damping[6][6] = 1.0, STRATUM_CONFIG_DAMPING, "joint 7 is too strong"),
        (|s| s.arm.gravity[2] = f64::NAN, STRATUM_CONFIG_ARM_NON_FINITE, "gravity = NaN; it must be finite"),
        (|s| s.arm.links[3].mass = 0.0, STRATUM_CONFIG_ARM_NOT_POSITIVE, "link 4: mass = 0; it must be above 0"),
        (|s| s.arm.links[0].inertia[0] = 9.0, STRATUM_CONFIG_ARM_INERTIA, "link 1: inertia"),
        (|s| { s.levels[0].task = 1; s.levels[0].rotation[0][0] = -1.0; }, STRATUM_CONFIG_FRAME_ROTATION, "level 1: rotation of the frame is distorted by 2e0; allowed 0 to 1e-9"),
        (|s| s.arm.gravity[2] = -31.0, STRATUM_CONFIG_ARM_RANGE, "arm: gravity [m/s2] = 31; allowed 0 to 30"),
        (|s| s.arm.base.rotation[2][2] = 1.1, STRATUM_CONFIG_ARM_RANGE, "arm: distortion of a rotation of base, flange or tool = 0.21"),
        (|s| s.arm.links[4].position_range = [1.0, -1.0], STRATUM_CONFIG_ARM_RANGE, "link 5: greatest position [rad] = -1; allowed 1 to"),
        (|s| s.arm.links[6].rotor_inertia = -0.5, STRATUM_CONFIG_ARM_RANGE, "link 7: rotor_inertia [kg m2] = -0.5; allowed 0 to inf"),
        (|s| s.tool.mass = -0.5, STRATUM_CONFIG_ARM_RANGE, "arm: tool.mass [kg] = -0.5; allowed 0 to inf"),
        (|s| s.tool.com[1] = f64::INFINITY, STRATUM_CONFIG_ARM_NON_FINITE, "arm: tool.com = inf; it must be finite"),
        (|s| { s.tool.mass = 1.0; s.tool.inertia[5] = 1.0; }, STRATUM_CONFIG_ARM_INERTIA, "tool: inertia gives a negative second moment of mass"),
    ];
    for (change, code, part) in cases {
        let bench = &mut Bench::new();
        change(&mut bench.settings);
        let mut text = [1 as c_char; STRATUM_TEXT_SIZE];
        // SAFETY: see `Bench::new`; the text ends within its buffer.
        unsafe {
            let size = text.len();
            let answer = stratum_settings_text(&*bench.settings, text.as_mut_ptr(), size);
            assert_eq!(answer, code, "{part}");
            let text = CStr::from_ptr(text.as_ptr()).to_str().unwrap();
            assert!(text.contains(part), "'{text}' does not say '{part}'");
            let c: *mut StratumController = &mut *bench.controller;
            assert_eq!(stratum_controller_init(c, &*bench.settings), code);
        }
    }
}

#[test]
fn versions_and_defaults_are_those_of_the_crate() {
    // SAFETY: a constant.
    let version = unsafe { CStr::from_ptr(stratum_version()) };
    assert_eq!(version.to_str().unwrap(), env!("CARGO_PKG_VERSION"));
    assert_eq!(stratum_abi_version(), STRATUM_ABI_VERSION);
    for other in [0, 1, STRATUM_ABI_VERSION + 1] {
        // SAFETY: null is checked; the version is looked at first.
        let answer = unsafe { stratum_settings_default(other, null_mut()) };
        assert_eq!(answer, STRATUM_ERROR_ABI);
    }
    let default = StratumSettings::default();
    let limits = default.arm.links.map(|link| link.torque_limit);
    assert_eq!(limits, LWR_IV.links.map(|link| link.torque_limit));
}
