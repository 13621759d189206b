//! Postures, numbers and states that do not fit.

use controller_core::fault::FaultKind;
use stratum::*;

use super::{BAD, Bench, Q, ZERO, fault};

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
