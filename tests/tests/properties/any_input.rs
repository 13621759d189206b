//! Whatever comes in, the torque is finite and within limits.

use std::cell::Cell;

use controller_core::controller::{Controller, ControllerState};
use controller_core::fault::Fault;
use controller_core::joint::Vector3;
use controller_core::measurement::{Measurement, Reference};
use controller_core::model::{ArmModel, LWR_IV};
use controller_core::real::Real;
use controller_core::task::{TaskKind, TaskReference};
use proptest::prelude::*;
use stratum_tests::oracle::sample::configuration;
use stratum_tests::random::States;

use super::{CASES, for_all, regular};

/// One wrong number somewhere: a slot and a value.
type Wrong = (usize, f64);

/// Slots: 0..7 q, 7..14 dq, 14 h, 15..22 q_d, 22 the number of references, then
/// 13 numbers per reference.
fn wrong() -> impl Strategy<Value = Wrong> {
    let special = vec![
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        1e300,
        -1e38,
        1e30,
        1e9,
        f64::MIN_POSITIVE,
        5e-324,
        1e-40,
        -0.0,
        0.0,
    ];
    let value = prop_oneof![
        prop::num::f64::ANY,
        prop::sample::select(special),
        -10.0..10.0f64,
        -1e-3..1e-3f64,
    ];
    (0..23 + 13 * 2usize, value)
}

fn replaced<T: Real>(
    measurement: &mut Measurement<T>,
    reference: &mut Reference<T>,
    (slot, value): Wrong,
) {
    let value = T::from_f64(value);
    match slot {
        0..7 => measurement.q[slot] = value,
        7..14 => measurement.dq[slot - 7] = value,
        14 => measurement.interval_s = value,
        15..22 => reference.posture[slot - 15] = value,
        22 => drop(reference.tasks.pop()),
        _ => {
            let Some(task) = reference.tasks.get_mut((slot - 23) / 13) else {
                return;
            };
            match (slot - 23) % 13 {
                axis @ 0..3 => task.x[axis] = value,
                axis @ 3..6 => task.dx[axis - 3] = value,
                axis @ 6..9 => task.ddx[axis - 6] = value,
                axis => task.orientation[axis - 9] = value,
            }
        }
    }
}

/// Whether a measurement can be true, written down once more.
fn believable<T: Real>(measurement: &Measurement<T>) -> bool {
    let limits = LWR_IV.links.iter().enumerate();
    let h = measurement.interval_s.to_f64();
    // Limits in T: a number within rounding of one may fall on either side, and
    // random numbers do not.
    limits.into_iter().all(|(i, link)| {
        measurement.q[i].to_f64().abs() <= link.position_limit + 0.2
            && measurement.dq[i].to_f64().abs() <= 3.0 * link.speed_limit
    }) && (0.001..=0.04).contains(&h)
}

/// Four cycles with wrong numbers: whatever comes in, the torque is finite and
/// within limits, a fault is latched with the torque it held, and it is there
/// exactly when something could not be true.
fn anything_in_good_torque_out<T: Real>() {
    let model = ArmModel::<T>::new(&LWR_IV).expect("the built-in arm is valid");
    let config = configuration::<T>(&[
        (TaskKind::Position, stratum_tests::config::FLANGE, "xyz"),
        (TaskKind::Orientation, stratum_tests::config::FLANGE, "xz"),
    ]);
    let controller = Controller::new(&model, &config).expect("a valid configuration");
    let (faults, clean) = (Cell::new(0u32), Cell::new(0u32));
    let cycle = prop::collection::vec(wrong(), 0..4);
    let sequence = (regular(), prop::array::uniform4(cycle));
    for_all(sequence, |((_, joints, seed), cycles)| {
        let mut state = ControllerState::new();
        let mut random = States::new(seed);
        let mut latched = None;
        for replacements in cycles {
            let mut measurement = Measurement {
                q: joints.q.map(T::from_f64),
                dq: joints.dq.map(T::from_f64),
                interval_s: T::from_f64(0.002),
            };
            let x = Vector3::from([random.signed(), random.signed(), 1.0]);
            let reference = TaskReference::rest(x.map(T::from_f64));
            let mut reference = Reference {
                tasks: [reference; 2].into_iter().collect(),
                posture: measurement.q,
            };
            for replacement in replacements {
                replaced(&mut measurement, &mut reference, replacement);
            }
            let step = controller.step(&mut state, &measurement, &reference);
            for (torque, limit) in step.torque.iter().zip(model.torque_limit()) {
                assert!(torque.finite() && torque.magnitude() <= *limit, "{torque}");
            }
            assert!(step.residual.iter().all(|r| r.finite()));
            // As text: a fault may hold a NaN, which equals nothing.
            let text = |fault: Option<Fault>| fault.map(|fault| fault.to_string());
            assert_eq!(text(step.status.fault), text(state.fault()));
            match latched {
                Some((fault, torque)) => {
                    assert_eq!(text(step.status.fault), text(Some(fault)), "latched");
                    assert_eq!(step.torque, torque, "held");
                }
                None if step.status.fault.is_some() => faults.set(faults.get() + 1),
                None => {
                    clean.set(clean.get() + 1);
                    assert!(believable(&measurement), "{measurement:?}");
                }
            }
            let mut numbers = (reference.tasks.iter())
                .flat_map(|task| task.x.iter().chain(&task.dx).chain(&task.ddx))
                .chain(&reference.posture);
            let moderate = numbers.all(|x| x.to_f64().abs() < 1e6);
            let oriented = reference.tasks.iter().all(|task| {
                let norm = task.orientation.map(T::to_f64).norm();
                (0.501..1.999).contains(&norm)
            });
            let fine = believable(&measurement) && moderate && oriented;
            if latched.is_none() && fine && reference.tasks.len() == 2 {
                assert_eq!(step.status.fault, None, "{measurement:?} {reference:?}");
            }
            latched = step.status.fault.map(|fault| (fault, step.torque));
        }
    });
    assert!(faults.get() > CASES / 4 && clean.get() > CASES / 4);
}

#[test]
fn any_input_gives_a_finite_torque_within_limits_in_double_precision() {
    anything_in_good_torque_out::<f64>();
}

#[test]
fn any_input_gives_a_finite_torque_within_limits_in_single_precision() {
    anything_in_good_torque_out::<f32>();
}
