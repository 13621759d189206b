//! Every error path of the interface, called as C calls it.

use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

use controller_core::model::{ArmModel, LWR_IV};
use stratum::*;

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
    let mut reference = StratumReference {
        x: [0.0; 3],
        orientation: [1.0, 0.0, 0.0, 0.0],
        dx: [0.0; 3],
        ddx: [0.0; 3],
    };
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

#[test]
fn numbers_that_are_not_finite_change_nothing() {
    let bench = &mut Bench::new();
    let (c, s): (*const StratumController, *mut StratumState) =
        (&*bench.controller, &mut *bench.state);
    let bad = BAD.as_ptr();
    // SAFETY: see `Bench::new`.
    unsafe {
        let mut reference = std::mem::zeroed::<StratumReference>();
        assert_eq!(stratum_reference_get(s, 1, &raw mut reference), 0);
        for part in 0..4 {
            let mut wrong = reference;
            *[
                &mut wrong.x[0],
                &mut wrong.dx[1],
                &mut wrong.ddx[2],
                &mut wrong.orientation[3],
            ][part] = f64::INFINITY;
            assert_eq!(
                stratum_reference_set(s, 1, &wrong),
                STRATUM_ERROR_NON_FINITE
            );
        }
        for norm in [0.4, 2.1] {
            let mut wrong = reference;
            wrong.orientation = [norm, 0.0, 0.0, 0.0];
            assert_eq!(
                stratum_reference_set(s, 1, &wrong),
                STRATUM_ERROR_ORIENTATION
            );
        }
        assert_eq!(stratum_posture_set(s, bad), STRATUM_ERROR_NON_FINITE);
        assert_eq!(stratum_reference_hold(s, c, bad), STRATUM_ERROR_NON_FINITE);
        assert_eq!(stratum_applied(s, bad), STRATUM_ERROR_NON_FINITE);
        let mut same = reference;
        assert_eq!(stratum_reference_get(s, 1, &raw mut same), 0);
        assert_eq!(same, reference);

        let mut torque = ZERO;
        let t = torque.as_mut_ptr();
        let (q, zero) = (Q.as_ptr(), ZERO.as_ptr());
        assert_eq!(stratum_step(c, s, q, zero, 0.002, t), STRATUM_OK);
        for (q, dq, interval_s) in [(bad, zero, 0.002), (q, bad, 0.002), (q, zero, f64::NAN)] {
            let answer = stratum_step(c, s, q, dq, interval_s, t);
            assert_eq!(answer, STRATUM_FAULT_IMPLAUSIBLE);
            assert!(torque.iter().all(|torque| torque.is_finite()));
            assert!(torque[1].abs() > 1.0, "gravity is carried");
            assert_eq!(stratum_reset(s), STRATUM_OK);
        }
        // Finite, but not times the stiffness.
        reference.x[0] = if stratum_precision() == 64 {
            1e308
        } else {
            3e38
        };
        assert_eq!(stratum_reference_set(s, 1, &reference), STRATUM_OK);
        let answer = stratum_step(c, s, q, zero, 0.002, t);
        assert_eq!(answer, STRATUM_FAULT_NON_FINITE_TORQUE);
        assert_eq!(stratum_state_init(s, c, bad), STRATUM_ERROR_NON_FINITE);
    }
}

#[test]
fn a_state_of_another_controller_is_refused() {
    let bench = &mut Bench::new();
    bench.settings.level_count = 2;
    bench.settings.levels[1].axes = STRATUM_AXIS_X;
    let mut torque = [1.0; 7];
    // SAFETY: see `Bench::new`.
    unsafe {
        let c: *mut StratumController = &mut *bench.controller;
        assert_eq!(stratum_controller_init(c, &*bench.settings), STRATUM_OK);
        let (q, t) = (Q.as_ptr(), torque.as_mut_ptr());
        let answer = stratum_step(c, &mut *bench.state, q, q, 0.002, t);
        assert_eq!(answer, STRATUM_ERROR_MISMATCH);
    }
    assert_eq!(torque, ZERO);
}

/// A change of the settings, its code, and what its text says.
type Case = (fn(&mut StratumSettings), StratumResult, &'static str);

#[test]
fn every_refusal_of_settings_names_thing_value_and_allowed() {
    #[rustfmt::skip]
    let cases: [Case; 22] = [
        (|s| s.abi = 7, STRATUM_ERROR_ABI, "settings.abi is 7; this library has 1"),
        (|s| s.level_count = 8, STRATUM_CONFIG_LEVELS, "level_count is 8; allowed 1 to 7"),
        (|s| s.levels[0].task = 2, STRATUM_CONFIG_CHOICE, "level 1: task is 2; allowed 0 to 1"),
        (|s| s.levels[0].axes = 9, STRATUM_CONFIG_CHOICE, "level 1: axes is 9; allowed 0 to 7"),
        (|s| s.damping = 2, STRATUM_CONFIG_CHOICE, "damping is 2; allowed 0 to 1"),
        (|s| s.posture = u32::MAX, STRATUM_CONFIG_CHOICE, "posture is 4294967295; allowed 0 to 2"),
        (|s| s.level_count = 3, STRATUM_CONFIG_ROWS, "9 rows together; allowed 1 to 7"),
        (|s| s.level_count = 0, STRATUM_CONFIG_ROWS, "0 rows together; allowed 1 to 7"),
        (|s| { s.level_count = 2; s.levels[1].axes = 0; }, STRATUM_CONFIG_NO_AXIS, "no axis; it needs 1 to 3"),
        (|s| s.levels[0].link = 8, STRATUM_CONFIG_POINT_LINK, "link 8; allowed 1 to 7"),
        (|s| s.levels[0].offset[0] = f64::NAN, STRATUM_CONFIG_POINT_OFFSET, "NaN m; allowed -10 to 10"),
        (|s| s.null_stiffness[1][1] = f64::INFINITY, STRATUM_CONFIG_GAIN_VALUE, "entry inf; allowed -1e9 to 1e9"),
        (|s| s.null_stiffness[1][0] = 2.0, STRATUM_CONFIG_GAIN_SYMMETRY, "entry (2, 1) differs from (1, 2) by 2;"),
        (|s| s.levels[0].stiffness[2][2] = 0.0, STRATUM_CONFIG_GAIN_DEFINITE, "pivot 0 at row 3;"),
        (|s| s.observer_gain[6] = -1.0, STRATUM_CONFIG_OBSERVER_GAIN, "joint 7 is -1 1/s; it must be above 0"),
        (|s| s.cycle_s = 0.0, STRATUM_CONFIG_CYCLE, "cycle 0 s; allowed 0.0001 to 0.02"),
        (|s| s.dead_cycles = 300, STRATUM_CONFIG_DEAD_CYCLES, "allowed 0 to 8"),
        (|s| { s.damping = STRATUM_DAMPING_INERTIA; s.null_damping_rate = 0.0; }, STRATUM_CONFIG_INERTIA_DAMPING, "damping 0 1/s; it must be above 0"),
        (|s| s.null_damping[6][6] = 1.0, STRATUM_CONFIG_DAMPING, "joint 7 is too strong"),
        (|s| s.arm.gravity[2] = f64::NAN, STRATUM_CONFIG_ARM_NON_FINITE, "gravity = NaN; it must be finite"),
        (|s| s.arm.links[3].mass = 0.0, STRATUM_CONFIG_ARM_NOT_POSITIVE, "link 4: mass = 0; it must be above 0"),
        (|s| s.arm.links[0].inertia[0] = 9.0, STRATUM_CONFIG_ARM_INERTIA, "link 1: inertia"),
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
fn every_code_has_a_name_and_a_text_of_its_own() {
    let word = |p| {
        // SAFETY: names and texts are constants.
        unsafe { CStr::from_ptr(p) }.to_str().unwrap()
    };
    let header = include_str!("../include/stratum.h");
    let mut texts = std::collections::HashSet::new();
    let mut count = 0;
    for line in header.lines() {
        let mut words = line.split(' ');
        let (Some("#define"), Some(name), Some(number)) =
            (words.next(), words.next(), words.next())
        else {
            continue;
        };
        let kinds = [
            "STRATUM_OK",
            "STRATUM_ERROR_",
            "STRATUM_FAULT_",
            "STRATUM_CONFIG_",
        ];
        if kinds.iter().any(|kind| name.starts_with(kind)) {
            let number = number.parse().unwrap();
            assert_eq!(word(stratum_error_name(number)), name);
            assert!(texts.insert(word(stratum_error_text(number))));
            count += 1;
        }
    }
    assert_eq!(count, 31);
    for number in [-1, 34, 127, i32::MAX, i32::MIN] {
        assert_eq!(word(stratum_error_name(number)), "unknown");
        assert_eq!(word(stratum_error_text(number)), "no such code");
    }
    assert_eq!(word(stratum_version()), env!("CARGO_PKG_VERSION"));
    assert_eq!(stratum_abi_version(), STRATUM_ABI_VERSION);
    let default = StratumSettings::default();
    // SAFETY: null is checked; the version is looked at first.
    let answer = unsafe { stratum_settings_default(STRATUM_ABI_VERSION + 1, null_mut()) };
    assert_eq!(answer, STRATUM_ERROR_ABI);
    let limits = *ArmModel::<f64>::new(&LWR_IV).unwrap().torque_limit();
    assert_eq!(
        default.arm.links.map(|link| link.torque_limit),
        <[f64; 7]>::from(limits)
    );
}
