//! Measurements and references that cannot be true.

use controller_core::controller::ControllerState;
use controller_core::fault::{Fault, FaultKind, Quantity};
use controller_core::measurement::{
    INTERVAL_FACTORS, Measurement, POSITION_MARGIN, QUATERNION_NORMS, Reference, SPEED_FACTOR,
};
use controller_core::real::Real;

use super::{at, resting, start, two_levels};

/// Exactly at its bound a number is believed; the next larger one is not, and the
/// fault says what, where, how much and what would be allowed. In `T`.
fn bounds_are_exact<T: Real>(next_up: fn(T) -> T) {
    let (model, controller) = two_levels::<T>();
    let check = |measurement: Measurement<T>| {
        let mut state = ControllerState::new();
        let step = controller.step(&mut state, &measurement, &resting(1, &start()));
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
        let position = model.position_limit()[joint] + T::from_f64(POSITION_MARGIN);
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
    let (_, controller) = two_levels::<f64>();
    let line = |change: fn(&mut Reference<f64>)| {
        let mut reference = resting(1, &start());
        change(&mut reference);
        let step = controller.step(&mut ControllerState::new(), &at(start()), &reference);
        step.status.fault.expect("a fault").to_string()
    };
    assert_eq!(
        line(|reference| reference.tasks[0].ddx.y = f64::NAN),
        "implausible: reference of level 1 is NaN; it must be finite"
    );
    assert_eq!(
        line(|reference| reference.posture[4] = f64::INFINITY),
        "implausible: desired posture [rad] of joint 5 is inf; it must be finite"
    );
    assert_eq!(
        line(|reference| reference.tasks.clear()),
        "implausible: number of task references is 0; allowed 1 to 1"
    );
    assert!(
        line(|reference| reference.tasks[0].x.z = 1e308)
            .starts_with("non_finite_torque: demanded torque [Nm] of joint")
    );
    // The norm itself, squared in the fault.
    assert!(line(|reference| reference.tasks[0].orientation *= 2.1).contains("level 1"));
    assert_eq!(QUATERNION_NORMS, [0.5, 2.0]);
    for norm in QUATERNION_NORMS {
        let mut reference = resting(1, &start());
        reference.tasks[0].orientation *= norm;
        let step = controller.step(&mut ControllerState::new(), &at(start()), &reference);
        assert_eq!(step.status.fault, None);
    }
    // They go over wires.
    assert_eq!(
        (
            FaultKind::Implausible as u8,
            FaultKind::NonFiniteTorque as u8
        ),
        (32, 33)
    );
}
