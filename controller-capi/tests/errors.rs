//! Every error path of the interface, called as C calls it.

use std::ffi::{CStr, CString, c_char};
use std::ptr::{null, null_mut};

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_STIFFNESS};
use controller_core::arm::{ArmParameters, Pose, Tool};
use controller_core::fault::FaultKind;
use controller_core::joint::JointVector;
use controller_core::law::null_space::NullDamping;
use controller_core::real::Real;
use controller_core::{
    Axes, Controller, ControllerConfig, LinkPoint, Measurement, NullSpace, State, Task, TaskGains,
    TaskSet,
};
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

/// A state begins in a posture that a cycle would believe, or not at all.
#[test]
fn a_posture_that_the_arm_cannot_have_is_refused() {
    let bench = &mut Bench::new();
    let (c, s): (*const StratumController, *mut StratumState) =
        (&*bench.controller, &mut *bench.state);
    let mut far = Q;
    far[3] = 35.0;
    // SAFETY: see `Bench::new`.
    unsafe {
        let refused = fault(FaultKind::Implausible);
        assert_eq!(stratum_reference_hold(s, c, far.as_ptr()), refused);
        let mut torque = ZERO;
        let (q, zero, t) = (Q.as_ptr(), ZERO.as_ptr(), torque.as_mut_ptr());
        assert_eq!(stratum_step(c, s, q, zero, 0.002, t), STRATUM_OK);
        assert_eq!(stratum_state_init(s, c, far.as_ptr()), refused);
    }
}

/// A reference elsewhere is joined, flagged, and followed at once where that is asked for.
#[test]
fn a_reference_that_jumps_is_joined_unless_told_otherwise() {
    let torque = |at_once: bool| {
        let bench = &mut Bench::new();
        let (c, s): (*const StratumController, *mut StratumState) =
            (&*bench.controller, &mut *bench.state);
        // SAFETY: see `Bench::new`.
        unsafe {
            let mut reference = StratumReference::default();
            assert_eq!(stratum_reference_get(s, 1, &raw mut reference), STRATUM_OK);
            reference.x[1] += 0.1;
            assert_eq!(stratum_reference_set(s, 1, &reference), STRATUM_OK);
            if at_once {
                assert_eq!(stratum_follow_at_once(s), STRATUM_OK);
            }
            let mut torque = ZERO;
            let (q, zero, t) = (Q.as_ptr(), ZERO.as_ptr(), torque.as_mut_ptr());
            assert_eq!(stratum_step(c, s, q, zero, 0.002, t), STRATUM_OK);
            let mut status = StratumStatus::default();
            assert_eq!(stratum_status(s, &raw mut status), STRATUM_OK);
            assert_eq!(status.joining, u32::from(!at_once));
            torque
        }
    };
    let (joined, at_once) = (torque(false), torque(true));
    let step = joined.iter().zip(at_once).map(|(a, b)| (a - b).abs());
    // K_p of 400 /s2 times 0.1 m on some kilograms at a lever of some decimetres.
    assert!(step.fold(0.0, f64::max) > 5.0, "{joined:?} {at_once:?}");
}

#[test]
fn numbers_that_are_not_finite_change_nothing() {
    let bench = &mut Bench::new();
    let (c, s): (*const StratumController, *mut StratumState) =
        (&*bench.controller, &mut *bench.state);
    let bad = BAD.as_ptr();
    // SAFETY: see `Bench::new`.
    unsafe {
        let mut reference = StratumReference::default();
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
            assert_eq!(answer, fault(FaultKind::Implausible));
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
        assert_eq!(answer, fault(FaultKind::Implausible));
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

/// Level 1 tracks the flange's position, level 2 the last link's orientation.
fn position_and_orientation() -> Bench {
    let mut bench = Bench::new();
    bench.settings.level_count = 2;
    bench.settings.levels[1].task = STRATUM_TASK_ORIENTATION;
    // SAFETY: see `Bench::new`.
    unsafe {
        let c: *mut StratumController = &mut *bench.controller;
        assert_eq!(stratum_controller_init(c, &*bench.settings), STRATUM_OK);
        assert_eq!(
            stratum_state_init(&mut *bench.state, c, Q.as_ptr()),
            STRATUM_OK
        );
    }
    bench
}

impl Bench {
    fn get(&self, level: u32) -> StratumReference {
        let mut reference = StratumReference::default();
        // SAFETY: see `Bench::new`.
        let answer = unsafe { stratum_reference_get(&*self.state, level, &raw mut reference) };
        assert_eq!(answer, STRATUM_OK);
        reference
    }

    fn set(&mut self, level: u32, reference: &StratumReference) -> StratumResult {
        // SAFETY: see `Bench::new`.
        unsafe { stratum_reference_set(&mut *self.state, level, reference) }
    }

    fn step(&mut self, q: &[f64; 7]) -> (StratumResult, [f64; 7]) {
        let mut torque = ZERO;
        let (q, dq, t) = (q.as_ptr(), ZERO.as_ptr(), torque.as_mut_ptr());
        // SAFETY: see `Bench::new`.
        let answer = unsafe { stratum_step(&*self.controller, &mut *self.state, q, dq, 0.002, t) };
        (answer, torque)
    }
}

#[test]
fn a_target_of_another_kind_than_the_task_is_refused() {
    let bench = &mut position_and_orientation();
    let [position, orientation] = [bench.get(1), bench.get(2)];
    assert_eq!(position.kind, STRATUM_TARGET_POSITION);
    assert_eq!(orientation.kind, STRATUM_TARGET_ORIENTATION);
    assert_eq!(bench.set(2, &position), STRATUM_ERROR_WRONG_TARGET);
    assert_eq!(bench.set(1, &orientation), STRATUM_ERROR_WRONG_TARGET);
    for norm in [0.0, 0.4, 2.1] {
        let mut wrong = orientation;
        wrong.orientation = [norm, 0.0, 0.0, 0.0];
        assert_eq!(bench.set(2, &wrong), STRATUM_ERROR_ORIENTATION);
    }
    assert_eq!([bench.get(1), bench.get(2)], [position, orientation]);
    assert_eq!(bench.set(1, &position), STRATUM_OK);
    assert_eq!(bench.set(2, &orientation), STRATUM_OK);
    // What a position does not need.
    let mut bare = position;
    bare.orientation = [0.0; 4];
    assert_eq!(bench.set(1, &bare), STRATUM_OK);
    assert_eq!(bench.get(1), position);
}

/// Programs for version 1 know no kind: where they fill a reference from nothing the
/// kind is 0, or what happened to lie there.
#[test]
fn numbers_without_their_kind_are_refused() {
    let bench = &mut position_and_orientation();
    let set = [bench.get(1), bench.get(2)];
    let mut filled = StratumReference {
        x: [-0.5, 0.1, 0.4],
        orientation: [1.0, 0.0, 0.0, 0.0],
        ..StratumReference::default()
    };
    for kind in [STRATUM_TARGET_HOLD, 3, u32::MAX] {
        filled.kind = kind;
        assert_eq!(bench.set(1, &filled), STRATUM_ERROR_TARGET);
        assert_eq!(bench.set(2, &filled), STRATUM_ERROR_TARGET);
    }
    filled.kind = STRATUM_TARGET_POSITION;
    filled.reserved = 1;
    assert_eq!(bench.set(1, &filled), STRATUM_ERROR_TARGET);
    for part in 0..4 {
        let mut hold = StratumReference::default();
        *[
            &mut hold.x[0],
            &mut hold.dx[1],
            &mut hold.ddx[2],
            &mut hold.orientation[3],
        ][part] = 1e-300;
        assert_eq!(bench.set(1, &hold), STRATUM_ERROR_TARGET);
    }
    assert_eq!([bench.get(1), bench.get(2)], set);
}

#[test]
fn a_reference_of_zeros_holds_where_the_level_is() {
    let zeros = StratumReference::default();
    // SAFETY: numbers only.
    assert_eq!(zeros, unsafe { std::mem::zeroed() });
    let mut now = Q;
    now[1] += 0.1;
    now[5] -= 0.1;
    // What holds the arm in this posture.
    let rest = &mut position_and_orientation();
    // SAFETY: see `Bench::new`.
    unsafe {
        let s: *mut StratumState = &mut *rest.state;
        let answer = stratum_reference_hold(s, &*rest.controller, now.as_ptr());
        assert_eq!(answer, STRATUM_OK);
        assert_eq!(stratum_posture_set(s, Q.as_ptr()), STRATUM_OK);
    }
    let expected = rest.step(&now);
    let bench = &mut position_and_orientation();
    for level in [1, 2] {
        assert_eq!(bench.set(level, &zeros), STRATUM_OK);
        assert_eq!(bench.get(level), zeros);
    }
    assert_eq!(bench.step(&now), expected);
    // It stays there when the arm is pushed away.
    assert_eq!(bench.step(&Q), rest.step(&Q));
    assert_ne!(bench.step(&Q), expected);
}

#[test]
fn targets_of_another_controller_are_a_fault() {
    let bench = &mut position_and_orientation();
    bench.settings.levels[0].task = STRATUM_TASK_ORIENTATION;
    bench.settings.levels[1].task = STRATUM_TASK_POSITION;
    // SAFETY: see `Bench::new`.
    unsafe {
        let c: *mut StratumController = &mut *bench.controller;
        assert_eq!(stratum_controller_init(c, &*bench.settings), STRATUM_OK);
    }
    assert_eq!(bench.step(&Q).0, fault(FaultKind::WrongTarget));
    let mut status = StratumStatus::default();
    // SAFETY: see `Bench::new`.
    unsafe {
        let s: *mut StratumState = &mut *bench.state;
        assert_eq!(stratum_status(s, &raw mut status), STRATUM_OK);
        assert_eq!(status.fault, fault(FaultKind::WrongTarget));
        assert_eq!(status.fault_index, 1);
        assert_eq!(status.fault_value, f64::from(STRATUM_TARGET_POSITION));
        assert_eq!(status.fault_min, f64::from(STRATUM_TARGET_ORIENTATION));
        // Its own references end it.
        assert_eq!(
            stratum_reference_hold(s, &*bench.controller, Q.as_ptr()),
            STRATUM_OK
        );
        assert_eq!(stratum_reset(s), STRATUM_OK);
    }
    assert_eq!(bench.step(&Q).0, STRATUM_OK);
    assert_eq!(bench.get(1).kind, STRATUM_TARGET_ORIENTATION);
}

/// A change of the settings, its code, and what its text says.
type Case = (fn(&mut StratumSettings), StratumResult, &'static str);

#[test]
fn every_refusal_of_settings_names_thing_value_and_allowed() {
    #[rustfmt::skip]
    let cases: [Case; 32] = [
        (|s| s.abi = 1, STRATUM_ERROR_ABI, "settings.abi is 1; this library has 5"),
        (|s| s.level_count = 8, STRATUM_CONFIG_LEVELS, "level_count is 8; allowed 1 to 7"),
        (|s| s.level_count = 0, STRATUM_CONFIG_LEVELS, "level_count is 0; allowed 1 to 7"),
        (|s| s.levels[0].task = 2, STRATUM_CONFIG_CHOICE, "level 1: task is 2; allowed 0 to 1"),
        (|s| s.levels[0].axes = 9, STRATUM_CONFIG_CHOICE, "level 1: axes is 9; allowed 1 to 7"),
        (|s| s.damping = 2, STRATUM_CONFIG_CHOICE, "damping is 2; allowed 0 to 1"),
        (|s| s.posture = u32::MAX, STRATUM_CONFIG_CHOICE, "posture is 4294967295; allowed 0 to 2"),
        (|s| s.level_count = 3, STRATUM_CONFIG_ROWS, "9 rows together; allowed 1 to 7"),
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

/// Settings of a built-in arm.
fn settings_of(name: &str) -> Box<StratumSettings> {
    let name = CString::new(name).unwrap();
    let mut settings: Box<StratumSettings> = Box::default();
    // SAFETY: see `Bench::new`.
    let answer =
        unsafe { stratum_settings_of_arm(STRATUM_ABI_VERSION, name.as_ptr(), &mut *settings) };
    assert_eq!(answer, STRATUM_OK);
    settings
}

/// A controller of settings, and the torques of some cycles from a state at rest in the middle
/// of all ranges; in every cycle `settings(k)` are those of the controller.
fn torques(variants: &[&StratumSettings], exchanged: usize) -> Vec<[f64; 7]> {
    let bench = &mut Bench::new();
    let q = variants[0].arm.links.map(|link| {
        let [least, greatest] = link.position_range;
        0.4 * least + 0.6 * greatest
    });
    let mut torques = Vec::new();
    // SAFETY: see `Bench::new`.
    unsafe {
        let (c, s): (*mut StratumController, *mut StratumState) =
            (&mut *bench.controller, &mut *bench.state);
        assert_eq!(stratum_controller_init(c, variants[0]), STRATUM_OK);
        assert_eq!(stratum_state_init(s, c, q.as_ptr()), STRATUM_OK);
        for cycle in 0..20 {
            if cycle == exchanged {
                assert_eq!(stratum_controller_init(c, variants[1]), STRATUM_OK);
                assert_eq!(stratum_skip(s), STRATUM_OK);
            }
            let mut torque = ZERO;
            let t = torque.as_mut_ptr();
            let q = q.map(|q| q + 1e-4 * cycle as f64);
            let dq = [0.05; 7];
            assert_eq!(
                stratum_step(c, s, q.as_ptr(), dq.as_ptr(), 0.002, t),
                STRATUM_OK
            );
            torques.push(torque);
        }
    }
    torques
}

/// The same cycles through the core itself, from the tables of the crate.
fn core_torques(variants: &[(ArmParameters, LinkPoint)], exchanged: usize) -> Vec<[f64; 7]> {
    let controllers: Vec<_> = variants
        .iter()
        .map(|(arm, point)| {
            let gains = TaskGains::uniform(400.0, 40.0);
            let config = ControllerConfig {
                tasks: TaskSet::new(&[Task::position(*point, Axes::XYZ, gains)]).unwrap(),
                null_space: NullSpace {
                    damping: NullDamping::Inertia(20.0),
                    ..NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING)
                },
                observer_gain: [50.0; 7],
                cycle_s: 0.002,
                dead_cycles: 0,
            };
            Controller::<Scalar>::new(arm, &config).unwrap()
        })
        .collect();
    let vector = |values: [f64; 7]| JointVector::from(values.map(Scalar::from_f64));
    let q = variants[0].0.links.map(|link| {
        let [least, greatest] = link.position_range;
        0.4 * least + 0.6 * greatest
    });
    let reference = controllers[0].rest_reference(&vector(q));
    let mut state = State::new();
    let cycle = |cycle: usize| {
        if cycle == exchanged {
            state.resume_after_gap();
        }
        let measurement = Measurement {
            q: vector(q.map(|q| q + 1e-4 * cycle as f64)),
            dq: vector([0.05; 7]),
            interval_s: Scalar::from_f64(0.002),
        };
        let controller = &controllers[usize::from(cycle >= exchanged)];
        let step = controller.step(&mut state, &measurement, &reference);
        step.torque.map(Real::to_f64).into()
    };
    (0..20).map(cycle).collect()
}

/// Every table of the crate, its names and its bits: by its settings, by its preset, and
/// mounted elsewhere with a tool that is exchanged for another.
#[test]
fn every_arm_has_the_torques_of_the_core() {
    // SAFETY: a constant.
    let refusal = unsafe { CStr::from_ptr(stratum_error_text(STRATUM_ERROR_PRESET)) };
    let names = refusal
        .to_str()
        .unwrap()
        .split("there are ")
        .nth(1)
        .unwrap();
    let known = arms::ALL.map(|arm| arm.name);
    assert_eq!(names.split(", ").collect::<Vec<_>>(), known);

    for arm in arms::ALL {
        let mut settings = settings_of(arm.name);
        settings.damping = STRATUM_DAMPING_INERTIA;
        let label = |name: &[c_char; STRATUM_NAME_SIZE]| {
            assert_eq!(name[STRATUM_NAME_SIZE - 1], 0);
            // SAFETY: it ends within the array.
            let name = unsafe { CStr::from_ptr(name.as_ptr()) };
            name.to_str().unwrap().to_owned()
        };
        assert_eq!(label(&settings.arm.name), arm.name);
        for (link, table) in settings.arm.links.iter().zip(&arm.links) {
            assert_eq!(label(&link.name), table.name);
            let approach = table
                .end_approach
                .map_or(0.0, |approach| approach.deceleration);
            assert_eq!(link.end_approach.deceleration, approach);
            assert_eq!(link.friction.coulomb, table.friction.coulomb);
        }
        let bare = (*arm, arm.flange_point());
        assert_eq!(
            torques(&[&settings], 20),
            core_torques(&[bare], 20),
            "{}",
            arm.name
        );

        // On the ceiling, with one tool and then another.
        let tools = [0.5, 1.5].map(|mass| Tool {
            pose: Pose {
                rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
                shift: [0.0, 0.02, 0.1 * mass],
            },
            mass,
            com: [0.0, 0.0, 0.05],
            inertia: [0.002, 0.0, 0.0, 0.002, 0.0, 0.001],
        });
        let ceiling = Pose {
            rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
            shift: [0.0, 0.0, 2.0],
        };
        let hanging = ArmParameters {
            base: ceiling,
            ..*arm
        };
        let core = tools.map(|tool| (hanging.with_tool(&tool), hanging.tool_point(&tool)));
        let pose = |pose: &Pose| StratumPose {
            rotation: pose.rotation,
            shift: pose.shift,
        };
        settings.arm.base = pose(&ceiling);
        let settings = tools.map(|tool| {
            let mut settings = settings.clone();
            settings.tool = StratumTool {
                pose: pose(&tool.pose),
                mass: tool.mass,
                com: tool.com,
                inertia: tool.inertia,
            };
            settings
        });
        let c = torques(&[&settings[0], &settings[1]], 10);
        assert_eq!(c, core_torques(&core, 10), "{}", arm.name);
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
