//! References that do not fit the levels: a fault that names the level, and an arm
//! that stays where it is.

use controller_core::cycle::observer::external_torque;
use controller_core::fault::{FaultKind, Mode, ORIENTATION_CODE, POSITION_CODE, Quantity};
use controller_core::joint::{JointVector, Vector3};
use controller_core::ranges::QUATERNION_NORMS;
use controller_core::real::Real;
use controller_core::task::orientation::{Quaternion, about_axis};
use controller_core::{
    Axes, Controller, ControllerConfig, Fault, Link, Measurement, Reference, State, Target, Task,
};
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, with_tasks};
use stratum_tests::controller;
use stratum_tests::oracle::closed_loop::{ClosedLoop, no_contact};

use super::{at, resting, start};

/// The flange along x and z, then its orientation about y.
fn mixed() -> ControllerConfig {
    with_tasks(&[
        Task::position(FLANGE, Axes::X | Axes::Z, REFERENCE_GAINS),
        Task::orientation(Link::L7.frame(), Axes::Y, REFERENCE_GAINS),
    ])
}

fn some_rotation() -> Quaternion<f64> {
    about_axis(&Vector3::from([0.0, 0.6, 0.8]), 0.7)
}

/// The fault of the first cycle towards a reference that has changed.
fn fault<T: Real>(
    controller: &Controller<T>,
    change: impl FnOnce(&mut Reference<T>),
) -> Option<Fault> {
    let mut reference = resting(controller, &start());
    change(&mut reference);
    let step = controller.step(&mut State::new(), &at(start()), &reference);
    step.status.fault
}

/// Target of the wrong kind, for either level, in `T`: named by number, level and
/// kinds.
fn named<T: Real>() {
    let controller = controller::<T>(&mixed());
    let position = Target::position([T::ONE; 3]);
    let rotation = Target::orientation(some_rotation().map(T::from_f64));
    for (level, wrong, codes, line) in [
        (
            1,
            rotation,
            [ORIENTATION_CODE, POSITION_CODE],
            "wrong_target: kind of target of level 1 is an orientation; allowed hold or a position",
        ),
        (
            2,
            position,
            [POSITION_CODE, ORIENTATION_CODE],
            "wrong_target: kind of target of level 2 is a position; allowed hold or an orientation",
        ),
    ] {
        let fault = fault(&controller, |reference| {
            reference.targets_mut()[level as usize - 1] = wrong;
        });
        let fault = fault.expect("a wrong kind");
        assert_eq!(
            (fault.kind.number(), fault.kind.name()),
            (34, "wrong_target")
        );
        assert_eq!((fault.quantity, fault.index), (Quantity::TargetKind, level));
        let [given, allowed] = codes;
        assert_eq!(
            (fault.value, fault.min, fault.max),
            (given, allowed, allowed)
        );
        assert_eq!(fault.to_string(), line);
    }
}

#[test]
fn a_target_of_the_wrong_kind_is_a_fault_that_names_level_and_kinds() {
    named::<f64>();
    named::<f32>();
}

/// The arm falls onto nothing: gravity torque of the last plausible posture to the
/// bit, residual zero, for as long as it is not reset, whatever comes; the ideal arm
/// stays. Targets of the right kind move it again.
#[test]
fn a_target_of_the_wrong_kind_holds_the_arm_until_the_reset() {
    let config = mixed();
    let mut closed = ClosedLoop::<f64>::new(&config, start(), &[]);
    let right = closed.reference();
    let mut swapped = right.clone();
    swapped.targets_mut().swap(0, 1);
    for _ in 0..10 {
        let seen = closed.step_towards(&right, no_contact);
        assert!(seen.step.status.is_clear(), "{:?}", seen.step.status);
    }
    let posture = closed.plant.state().q;
    let gravity = closed.state.data().dynamics.gravity;
    let before = format!("{:?}", closed.state.data().rows);
    for cycle in 0..500 {
        let reference = if cycle % 7 == 3 { &right } else { &swapped };
        let seen = closed.step_towards(reference, no_contact);
        let fault = seen.step.status.fault.expect("a wrong kind, then latched");
        assert_eq!(
            (fault.kind, fault.index),
            (FaultKind::WrongTarget, 1),
            "the first level that is wrong"
        );
        // At rest the brake is gravity.
        assert!((seen.step.torque - gravity).amax() < 1e-12);
        assert!((seen.step.gravity - gravity).amax() < 1e-12);
        assert_eq!(seen.step.status.mode, Mode::Resting);
        assert_eq!(seen.step.residual, JointVector::zeros());
    }
    assert_eq!(
        before,
        format!("{:?}", closed.state.data().rows),
        "a refused cycle computes no task"
    );
    let moved = (closed.plant.state().q - posture).amax();
    // Rounding of the gravity torque, 1e-14 Nm, on 1.6e-4 kg m2 for one second.
    assert!(moved < 1e-9, "{moved:e}");

    closed.state.reset();
    let Target::Position { x, .. } = right.targets()[0] else {
        panic!("a position level");
    };
    let mut moving = right.clone();
    moving.targets_mut()[0] = Target::position(x + Vector3::from([0.02, 0.0, 0.0]));
    closed.state.follow_at_once();
    for _ in 0..500 {
        let seen = closed.step_towards(&moving, no_contact);
        assert!(seen.step.status.is_clear(), "{:?}", seen.step.status);
    }
    let residual = closed.state.data().residual();
    assert!(external_torque(residual).amax() < 0.01, "{residual}");
    assert!((closed.plant.state().q - posture).amax() > 1e-3);
}

/// The first cycle of all holds, too: the measurement is believed, the reference is not.
#[test]
fn a_wrong_kind_in_the_first_cycle_holds_the_arm() {
    let controller = controller::<f64>(&mixed());
    let mut reference = resting(&controller, &start());
    reference.targets_mut().swap(0, 1);
    let step = controller.step(&mut State::new(), &at(start()), &reference);
    assert_eq!(step.torque, step.gravity);
    assert!(step.torque.amax() > 30.0);
    assert_eq!(step.status.mode, Mode::Resting);
    assert!(step.status.fault.is_some());
}

/// As many targets as levels. More than the most levels of all cannot be given: from
/// an array they do not compile, from a slice there is no reference.
#[test]
fn a_reference_has_a_target_per_level() {
    let controller = controller::<f64>(&mixed());
    for count in [0, 1, 3, 7] {
        let fault = fault(&controller, |reference| {
            *reference = Reference::hold(count, reference.posture);
        });
        assert_eq!(
            fault.expect("a wrong count").to_string(),
            format!("implausible: number of targets is {count}; allowed 2 to 2")
        );
    }
    let hold = fault(&controller, |reference| {
        *reference = Reference::hold(2, reference.posture);
    });
    assert_eq!(hold, None);
    let targets = [Target::<f64>::Hold; 8];
    assert_eq!(Reference::from_targets(&targets, start()), None);
    for count in 0..=7 {
        let reference = Reference::from_targets(&targets[..count], start());
        assert_eq!(reference.expect("up to seven").targets().len(), count);
    }
    assert_eq!(Reference::hold(8, start()).targets().len(), 7);
}

/// Norms of 0.5 to 2, bounds included; the fault shows the square.
#[test]
fn a_quaternion_without_a_direction_is_refused() {
    let controller = controller::<f64>(&mixed());
    let with = |q: Quaternion<f64>| {
        fault(&controller, |reference| {
            reference.targets_mut()[1] = Target::orientation(q);
        })
    };
    for norm in [0.0, 0.499, 2.001, 3.0, 1e200] {
        let fault = with(Quaternion::from([0.0, norm, 0.0, 0.0])).expect("no quaternion");
        assert_eq!(
            (fault.kind, fault.quantity, fault.index),
            (FaultKind::Implausible, Quantity::Orientation, 2)
        );
        assert_eq!(
            (fault.value, fault.min, fault.max),
            (norm * norm, 0.25, 4.0)
        );
    }
    assert_eq!(
        with(Quaternion::from([3.0, 0.0, 0.0, 0.0])).map(|fault| fault.to_string()),
        Some("implausible: squared quaternion norm of level 2 is 9; allowed 0.25 to 4".into())
    );
    assert!(with(Quaternion::from([f64::NAN, 1.0, 0.0, 0.0])).is_some());
    assert_eq!(QUATERNION_NORMS, [0.5, 2.0]);
    for norm in [-2.0, -0.5, 0.5, 1.0, 2.0] {
        assert_eq!(
            with(Quaternion::from([0.0, 0.0, norm, 0.0])),
            None,
            "{norm}"
        );
    }
}

/// Every number must be finite, along axes that the task does not control as well.
#[test]
fn every_number_of_a_target_must_be_finite() {
    let controller = controller::<f64>(&mixed());
    let zero = Vector3::zeros();
    for axis in 0..3 {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut wrong = zero;
            wrong[axis] = value;
            let position = |x, dx, ddx| (0, Target::Position { x, dx, ddx });
            let orientation = |w, dw| {
                let q = some_rotation();
                (1, Target::Orientation { q, w, dw })
            };
            for ((level, target), quantity) in [
                (position(wrong, zero, zero), Quantity::TargetDistance),
                (position(zero, wrong, zero), Quantity::TargetSpeed),
                (position(zero, zero, wrong), Quantity::TargetAcceleration),
                (orientation(wrong, zero), Quantity::TargetAngularSpeed),
                (
                    orientation(zero, wrong),
                    Quantity::TargetAngularAcceleration,
                ),
            ] {
                let fault = fault(&controller, |reference| {
                    reference.targets_mut()[level] = target;
                });
                let fault = fault.expect("not finite");
                assert_eq!(
                    (fault.quantity, usize::from(fault.index)),
                    (quantity, level + 1)
                );
                assert!(!fault.value.is_finite() && fault.max.is_finite(), "{fault}");
            }
        }
    }
}

/// What is wrong first is named: the measurement, then the number of targets, then the
/// levels in their order, then the posture.
#[test]
fn what_is_wrong_first_is_named() {
    let controller = controller::<f64>(&mixed());
    let measurement = at(start());
    let mut reference = resting(&controller, &start());
    reference.posture[2] = f64::NAN;
    reference.targets_mut()[1] = Target::position([0.0; 3]);
    let first = |measurement: &Measurement<f64>, reference: &Reference<f64>| {
        let step = controller.step(&mut State::new(), measurement, reference);
        step.status.fault.expect("something is wrong").quantity
    };
    assert_eq!(first(&measurement, &reference), Quantity::TargetKind);
    reference.targets_mut()[0] = Target::position([f64::NAN; 3]);
    assert_eq!(first(&measurement, &reference), Quantity::TargetDistance);
    let few = Reference::from_targets(&reference.targets()[..1], reference.posture);
    let few = few.expect("one target");
    assert_eq!(first(&measurement, &few), Quantity::TargetCount);
    let mut fast = measurement;
    fast.dq[6] = 1e3;
    assert_eq!(first(&fast, &few), Quantity::Speed);
    let right = resting(&controller, &start());
    let mut posture = right.clone();
    posture.posture[2] = f64::INFINITY;
    assert_eq!(first(&at(start()), &posture), Quantity::PostureReference);
}

/// q, -q and 2 q are the same orientation, to the last bit of the torque.
#[test]
fn sign_and_length_of_a_quaternion_do_not_matter() {
    let controller = controller::<f64>(&mixed());
    let torque = |factor: f64| {
        let mut reference = resting(&controller, &start());
        reference.targets_mut()[1] = Target::orientation(some_rotation() * factor);
        let step = controller.step(&mut State::new(), &at(start()), &reference);
        assert_eq!(step.status.fault, None);
        step.torque
    };
    let [one, ..] = [1.0, -1.0, 0.5, -0.5].map(torque);
    for factor in [-1.0, 0.5, -0.5] {
        assert_eq!(torque(factor), one, "{factor}");
    }
    // Another length rounds.
    assert!((torque(1.7) - one).amax() < 1e-10);
}
