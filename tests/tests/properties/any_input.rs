//! Whatever comes in, the torque is finite and within limits.

use std::cell::Cell;

use arms::LWR_IV;
use controller_core::fault::{FaultKind, Mode};
use controller_core::joint::{JointVector, Vector3};
use controller_core::real::Real;
use controller_core::task::{Tracked, orientation};
use controller_core::{Controller, Fault, Link, Measurement, Reference, State, Target};
use proptest::prelude::*;
use stratum_tests::config::FLANGE;
use stratum_tests::oracle::sample::configuration;
use stratum_tests::random::States;
use stratum_tests::{controller, limited_controller};

use super::{CASES, for_all, regular};

/// One wrong number somewhere: a slot and a value.
type Wrong = (usize, f64);

/// Slots: 0..7 q, 7..14 dq, 14 h, 15..22 q_d, 22 the number of targets, 23 and 24 the
/// kind of the target of a level, 25 and 26 whether it holds, then the numbers of the
/// targets: 9 of a position, 10 of an orientation.
const SLOTS: usize = 27 + 9 + 10;

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
    (0..SLOTS, value)
}

fn replaced<T: Real>(
    measurement: &mut Measurement<T>,
    reference: &mut Reference<T>,
    (slot, value): Wrong,
) {
    let value = T::from_f64(value);
    let posture = reference.posture;
    let targets = reference.targets_mut();
    match slot {
        0..7 => measurement.q[slot] = value,
        7..14 => measurement.dq[slot - 7] = value,
        14 => measurement.interval_s = value,
        15..22 => reference.posture[slot - 15] = value,
        22 => {
            let fewer = &targets[..targets.len().saturating_sub(1)];
            *reference = Reference::from_targets(fewer, posture).expect("fewer");
        }
        23 | 24 => {
            if let Some(target) = targets.get_mut(slot - 23) {
                *target = match target {
                    Target::Orientation { .. } => Target::position([T::ONE; 3]),
                    _ => Target::orientation(orientation::identity()),
                };
            }
        }
        25 | 26 => {
            if let Some(target) = targets.get_mut(slot - 25) {
                *target = Target::Hold;
            }
        }
        _ => {
            if let Some(number) = targets.iter_mut().flat_map(numbers).nth(slot - 27) {
                *number = value;
            }
        }
    }
}

/// The numbers of a target.
fn numbers<T: Real>(target: &mut Target<T>) -> Vec<&mut T> {
    match target {
        Target::Hold => Vec::new(),
        Target::Position { x, dx, ddx } => x.iter_mut().chain(dx).chain(ddx).collect(),
        Target::Orientation { q, w, dw } => q.iter_mut().chain(w).chain(dw).collect(),
    }
}

/// Whether every number is so small that no bound of a vector of three is met.
fn moderate<T: Real>(target: &Target<T>) -> bool {
    let below = |vector: &Vector3<T>, most: f64| vector.iter().all(|x| x.to_f64().abs() < most);
    match target {
        Target::Hold => true,
        // Within 1.04 m of the base and 0.31 m more of the shoulder.
        Target::Position { x, dx, ddx } => below(x, 0.6) && below(dx, 10.0) && below(ddx, 250.0),
        Target::Orientation { w, dw, .. } => below(w, 100.0) && below(dw, 2500.0),
    }
}

/// Whether the target of each level is of its kind.
fn fitting<T: Real>(targets: &[Target<T>]) -> bool {
    (targets.iter().enumerate()).all(|(level, target)| match target {
        Target::Hold => true,
        Target::Position { .. } => level == 0,
        Target::Orientation { .. } => level == 1,
    })
}

/// Whether a measurement can be true, written down once more.
fn believable<T: Real>(measurement: &Measurement<T>) -> bool {
    let limits = LWR_IV.links.iter().enumerate();
    let h = measurement.interval_s.to_f64();
    // Limits in T: a number within rounding of one may fall on either side, and
    // random numbers do not.
    limits.into_iter().all(|(i, link)| {
        measurement.q[i].to_f64().abs() <= link.position_range[1] + 0.2
            && measurement.dq[i].to_f64().abs() <= 3.0 * link.speed_limit
    }) && (0.001..=0.04).contains(&h)
}

/// Four cycles with wrong numbers: whatever comes in, the torque is finite and
/// within limits, a fault is latched and the arm braked, and it is there
/// exactly when something could not be true.
fn anything_in_good_torque_out<T: Real>() {
    let configuration = configuration(&[
        (Tracked::Position(FLANGE), "xyz"),
        (Tracked::Orientation(Link::L7.frame()), "xz"),
    ]);
    anything_into(&controller::<T>(&configuration));
    anything_into(&limited_controller::<T>(&configuration));
}

fn anything_into<T: Real>(controller: &Controller<T>) {
    let limits = controller.arm().torque_limit();
    let (faults, clean, kinds) = (Cell::new(0u32), Cell::new(0u32), Cell::new(0u32));
    let cycle = prop::collection::vec(wrong(), 0..4);
    let sequence = (regular(), prop::array::uniform4(cycle));
    for_all(sequence, |((_, joints, seed), cycles)| {
        let mut state = State::new();
        let mut random = States::new(seed);
        let mut latched = None;
        for replacements in cycles {
            let mut measurement = Measurement {
                q: joints.q.map(T::from_f64),
                dq: joints.dq.map(T::from_f64),
                interval_s: T::from_f64(0.002),
            };
            let x = Vector3::from([random.signed(), random.signed(), 1.0]) * 0.5;
            let targets = [
                Target::position(x.map(T::from_f64)),
                Target::orientation(orientation::identity()),
            ];
            let mut reference = Reference::new(targets, measurement.q);
            for replacement in replacements {
                replaced(&mut measurement, &mut reference, replacement);
            }
            let step = controller.step(&mut state, &measurement, &reference);
            for (torque, limit) in step.torque.iter().zip(limits) {
                assert!(torque.finite() && torque.magnitude() <= *limit, "{torque}");
            }
            assert!(step.residual.iter().all(|r| r.finite()));
            // As text: a fault may hold a NaN, which equals nothing.
            let text = |fault: Option<Fault>| fault.map(|fault| fault.to_string());
            assert_eq!(text(step.status.fault), text(state.fault()));
            match latched {
                Some((fault, torque)) => {
                    assert_eq!(text(step.status.fault), text(Some(fault)), "latched");
                    // 1e5 Nm/s in 2 ms, and the rounding of a sum of such torques.
                    let change: JointVector<T> = step.torque - torque;
                    let most = T::from_f64(200.0001);
                    assert!(change.iter().all(|c| c.magnitude() <= most), "{change}");
                    assert!(step.status.mode as u8 >= Mode::Braking as u8);
                }
                None if step.status.fault.is_some() => {
                    faults.set(faults.get() + 1);
                    let kind = step.status.fault.map(|fault| fault.kind);
                    if kind == Some(FaultKind::WrongTarget) {
                        kinds.set(kinds.get() + 1);
                        assert!(!fitting(reference.targets()), "{reference:?}");
                    }
                }
                None => {
                    clean.set(clean.get() + 1);
                    assert!(believable(&measurement), "{measurement:?}");
                    assert!(fitting(reference.targets()), "{reference:?}");
                    assert_eq!(reference.targets().len(), 2);
                }
            }
            let moderate = reference.targets().iter().all(moderate)
                && reference.posture.iter().all(|x| x.to_f64().abs() < 4.0);
            let oriented = reference.targets().iter().all(|target| match target {
                Target::Orientation { q, .. } => (0.501..1.999).contains(&q.map(T::to_f64).norm()),
                _ => true,
            });
            let fine = believable(&measurement) && moderate && oriented;
            let fits = fitting(reference.targets()) && reference.targets().len() == 2;
            if latched.is_none() && fine && fits {
                assert_eq!(step.status.fault, None, "{measurement:?} {reference:?}");
            }
            latched = step.status.fault.map(|fault| (fault, step.torque));
        }
    });
    assert!(faults.get() > CASES / 4 && clean.get() > CASES / 4);
    assert!(kinds.get() > CASES / 20, "{}", kinds.get());
}

#[test]
fn any_input_gives_a_finite_torque_within_limits_in_double_precision() {
    anything_in_good_torque_out::<f64>();
}

#[test]
fn any_input_gives_a_finite_torque_within_limits_in_single_precision() {
    anything_in_good_torque_out::<f32>();
}
