//! Targets: kinds, numbers, jumps.

use controller_core::fault::FaultKind;
use stratum::*;

use super::{Bench, Q, ZERO, fault};

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
