//! Measurements and references that cannot be true.

use controller_core::fault::{FaultKind, Quantity};
use controller_core::joint::Vector3;
use controller_core::ranges::{INTERVAL_FACTORS, POSITION_MARGIN, SPEED_FACTOR};
use controller_core::real::Real;
use controller_core::{Fault, Measurement, Reference, State, Target};
use stratum_tests::config::two_level;
use stratum_tests::controller;

use super::{at, resting, start};

/// Exactly at its bound a number is believed; the next larger one is not, and the
/// fault says what, where, how much and what would be allowed. In `T`.
fn bounds_are_exact<T: Real>(next_up: fn(T) -> T) {
    let controller = controller::<T>(&two_level());
    let model = controller.arm();
    let reference = resting(&controller, &start());
    let check = |measurement: Measurement<T>| {
        let step = controller.step(&mut State::new(), &measurement, &reference);
        step.status.fault
    };
    let refused = |measurement, quantity, index, value: T, bound: T| {
        let fault: Fault = check(measurement).expect("beyond the bound");
        assert_eq!(
            (fault.kind, fault.quantity, fault.index),
            (FaultKind::Implausible, quantity, index)
        );
        assert_eq!(fault.value, value.to_f64());
        assert!(
            fault.max == bound.magnitude().to_f64() || fault.min == bound.to_f64(),
            "{fault}"
        );
    };
    for joint in 0..7 {
        let position = model.position_range()[1][joint] + T::from_f64(POSITION_MARGIN);
        let speed = model.speed_limit()[joint] * T::from_f64(SPEED_FACTOR);
        let number = joint as u8 + 1;
        for sign in [T::ONE, -T::ONE] {
            let mut measurement = at(start());
            measurement.q[joint] = position * sign;
            assert_eq!(check(measurement), None, "joint {number}");
            let beyond = next_up(position) * sign;
            measurement.q[joint] = beyond;
            refused(
                measurement,
                Quantity::Position,
                number,
                beyond,
                position * sign,
            );

            let mut measurement = at(start());
            measurement.dq[joint] = speed * sign;
            assert_eq!(check(measurement), None, "joint {number}");
            let beyond = next_up(speed) * sign;
            measurement.dq[joint] = beyond;
            refused(measurement, Quantity::Speed, number, beyond, speed * sign);
        }
    }
    let [shortest, longest] = INTERVAL_FACTORS.map(|f| T::from_f64(f) * T::from_f64(0.002));
    for interval_s in [shortest, longest, T::from_f64(0.002)] {
        assert_eq!(
            check(Measurement {
                interval_s,
                ..at(start())
            }),
            None
        );
    }
    let beyond = next_up(longest);
    let measurement = Measurement {
        interval_s: beyond,
        ..at(start())
    };
    refused(measurement, Quantity::Interval, 0, beyond, longest);
    // 1e-6 is beyond the rounding of either precision.
    let below = shortest * T::from_f64(1.0 - 1e-6);
    let measurement = Measurement {
        interval_s: below,
        ..at(start())
    };
    refused(measurement, Quantity::Interval, 0, below, shortest);
    assert!(
        check(Measurement {
            interval_s: T::ZERO,
            ..at(start())
        })
        .is_some()
    );
}

#[test]
fn measurements_are_believed_up_to_their_bounds_and_no_further() {
    bounds_are_exact::<f64>(f64::next_up);
    bounds_are_exact::<f32>(f32::next_up);
    assert_eq!(
        (POSITION_MARGIN, SPEED_FACTOR, INTERVAL_FACTORS),
        (0.2, 3.0, [0.5, 20.0])
    );
}

#[test]
fn each_wrong_reference_is_named() {
    let controller = controller::<f64>(&two_level());
    let line = |change: fn(&mut Reference<f64>)| {
        let mut reference = resting(&controller, &start());
        change(&mut reference);
        let step = controller.step(&mut State::new(), &at(start()), &reference);
        step.status.fault.expect("a fault").to_string()
    };
    fn position(reference: &mut Reference<f64>) -> [&mut Vector3<f64>; 3] {
        match &mut reference.targets_mut()[0] {
            Target::Position { x, dx, ddx } => [x, dx, ddx],
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(
        line(|reference| *position(reference)[0] = Vector3::from([-2.0, 0.0, 0.3105])),
        "implausible: distance [m] from the shoulder of the target of level 1 is 2; \
         allowed 0 to 1.3679999999999999"
    );
    assert_eq!(
        line(|reference| position(reference)[1].z = f64::INFINITY),
        "implausible: desired speed [m/s] of level 1 is inf; allowed 0 to 20"
    );
    assert_eq!(
        line(|reference| position(reference)[2].y = f64::NAN),
        "implausible: desired acceleration [m/s2] of level 1 is NaN; allowed 0 to 500"
    );
    assert_eq!(
        line(|reference| reference.posture[1] = f64::INFINITY),
        "implausible: desired posture [rad] of joint 2 is inf; allowed -4.1887902047863905 to \
         4.1887902047863905"
    );
    assert_eq!(
        line(|reference| *reference = Reference::hold(0, reference.posture)),
        "implausible: number of targets is 0; allowed 1 to 1"
    );
    assert_eq!(
        line(|reference| *reference = Reference::hold(7, reference.posture)),
        "implausible: number of targets is 7; allowed 1 to 1"
    );
    assert_eq!(
        line(|reference| *position(reference)[1] = Vector3::from([0.0, -1e300, 0.0])),
        "implausible: desired speed [m/s] of level 1 is 1e300; allowed 0 to 20"
    );
}

/// A joint is called by its number, or as the maker of the arm calls it; a level is a level
/// with any arm.
#[test]
fn faults_name_joints_as_their_maker_does() {
    let fault = |quantity, index| Fault {
        kind: FaultKind::Implausible,
        quantity,
        index,
        value: 7.0,
        min: -1.0,
        max: 1.0,
    };
    let speed = fault(Quantity::Speed, 4);
    let rest = "is 7; allowed -1 to 1";
    let numbered = format!("implausible: speed [rad/s] of joint 4 {rest}");
    assert_eq!(speed.to_string(), numbered);
    for arm in arms::ALL {
        let named = format!("implausible: speed [rad/s] of {} {rest}", arm.links[3].name);
        assert_eq!(speed.named(arm).to_string(), named);
        for (quantity, index) in [(Quantity::TargetSpeed, 2), (Quantity::Interval, 0)] {
            let other = fault(quantity, index);
            assert_eq!(other.named(arm).to_string(), other.to_string());
        }
        // An index that no joint has is shown as what it is.
        let beyond = fault(Quantity::Speed, 8);
        assert_eq!(beyond.named(arm).to_string(), beyond.to_string());
    }
}
