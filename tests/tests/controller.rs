//! The cycle around the law: what is believed, what is latched, what is held,
//! what is reported.

#[path = "controller/configuration.rs"]
mod configuration;
#[path = "controller/data.rs"]
mod data;
#[path = "controller/hold.rs"]
mod hold;
#[path = "controller/plausibility.rs"]
mod plausibility;
#[path = "controller/targets.rs"]
mod targets;

use arms::LWR_IV;
use controller_core::cycle::record::Recorder;
use controller_core::fault::{IndexSet, Quantity};
use controller_core::joint::{JointState, JointVector, Vector3, zeros};
use controller_core::law::hierarchy::RANK_THRESHOLD;
use controller_core::law::motion::MotionSplit;
use controller_core::law::null_space::Posture;
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, State, Step, Target};
use stratum_tests::config::{FLANGE, three_level, two_level};
use stratum_tests::oracle::closed_loop::{ClosedLoop, TWO_LEVEL_START, circle, posture};
use stratum_tests::{controller, evaluate};

/// A state and a recorder in static memory: both are built by the compiler.
static STATE: State<f32> = State::new();
static RECORDER: Recorder<f32, 4> = Recorder::new();

fn at<T: Real>(q: JointVector<f64>) -> Measurement<T> {
    Measurement {
        q: q.map(T::from_f64),
        dq: zeros(),
        interval_s: T::from_f64(0.002),
    }
}

fn resting<T: Real>(controller: &Controller<T>, q: &JointVector<f64>) -> Reference<T> {
    controller.rest_reference(&q.map(T::from_f64))
}

fn start() -> JointVector<f64> {
    posture(TWO_LEVEL_START)
}

#[test]
fn state_and_recorder_can_be_static() {
    let mut state = STATE.clone();
    assert!(state.fault().is_none() && RECORDER.iter().count() == 0);
    let controller = controller(&two_level());
    let step = controller.step(&mut state, &at(start()), &resting(&controller, &start()));
    assert!(step.status.is_clear(), "{:?}", step.status);
}

/// The rank rule: a row with R_kk^2 below 1e-8 has no acceleration and a flag,
/// any other has none. On the straightening arm the radial row of the flange
/// crosses the threshold; the other rows never do.
#[test]
fn a_row_that_cannot_be_resolved_gets_a_flag_and_no_acceleration() {
    let controller = controller::<f64>(&two_level());
    let (mut flagged, mut free) = (0, 0);
    for step in 0..=140 {
        let elbow = libm::exp10(-f64::from(step) / 20.0);
        // A stretched arm along x: x is the radial direction.
        let q = JointVector::from([0.0, std::f64::consts::FRAC_PI_2, 0.0, elbow, 0.0, 0.0, 0.0]);
        let mut reference = resting(&controller, &start());
        reference.posture = q;
        let mut state = State::new();
        state.follow_at_once();
        let step = controller.step(&mut state, &at(q), &reference);
        let conditioning = state.data().hierarchy.conditioning();
        let y = state.data().control.task_acceleration;
        assert!(step.status.fault.is_none());
        assert!(step.torque.iter().all(|torque| torque.is_finite()));
        for k in 0..3 {
            let deficient = conditioning[k] * conditioning[k] < RANK_THRESHOLD;
            assert_eq!(step.status.rank.contains(k), deficient, "{conditioning:?}");
            assert_eq!(y[k] == 0.0, deficient, "{y}");
            flagged += u32::from(deficient);
            free += u32::from(!deficient);
        }
        assert_eq!(step.status.rank.0 >> 3, 0, "no flag behind the last row");
    }
    assert!(flagged > 10 && free > 2 * flagged, "{flagged} {free}");
}

/// A fault stays whatever comes, until the reset, and the observer starts anew behind it.
#[test]
fn a_fault_is_latched_until_the_reset() {
    let controller = controller::<f64>(&two_level());
    let mut closed = ClosedLoop::<f64>::new(&two_level(), start(), &[circle(0.1, 3.0)]);
    for _ in 0..600 {
        let _ = closed.step();
    }
    let state = *closed.plant.state();
    let good = Measurement {
        dq: state.dq,
        ..at(state.q)
    };
    let reference = resting(&controller, &state.q);
    let before = controller.step(&mut closed.state, &good, &reference);
    assert!(before.status.fault.is_none() && before.residual.amax() > 0.0);

    let bad = Measurement {
        dq: good.dq * f64::NAN,
        ..good
    };
    for measurement in [bad, good, bad, at(start())] {
        let step = controller.step(&mut closed.state, &measurement, &reference);
        assert_eq!(step.residual, JointVector::zeros());
        assert_eq!(step.status.rank, IndexSet::NONE);
        let latched = step.status.fault.expect("latched");
        assert_eq!((latched.quantity, latched.index), (Quantity::Speed, 1));
    }

    closed.state.reset();
    assert_eq!(closed.state.fault(), None);
    let acting = closed.state.data().allocation.torque;
    let after = controller.step(&mut closed.state, &good, &reference);
    assert_eq!(after.status.fault, None);
    assert_eq!(after.residual, JointVector::zeros());
    let mut fresh = State::new();
    fresh.set_applied_torque(&acting);
    let fresh = controller.step(&mut fresh, &good, &reference);
    assert_eq!(after, fresh, "nothing remembered but the torque that acts");
}

/// A flag for each joint that was cut and for no other; the cut joint gives its
/// limit with the sign of the demand. Held gravity is cut as well.
#[test]
fn saturated_joints_are_flagged_and_cut_with_their_sign() {
    let mut weak = LWR_IV;
    weak.links[1].torque_limit = 10.0;
    weak.links[3].torque_limit = 2.0;
    let controller = Controller::<f64>::new(&weak, &three_level()).expect("a weak arm");
    let model = controller.arm();
    let resting = JointState {
        q: start(),
        dq: JointVector::zeros(),
    };
    let (kinematics, dynamics) = evaluate(model, &resting);
    let x = kinematics.point(FLANGE.link, &FLANGE.offset.into()).x;
    let pushing = Target::Position {
        x,
        dx: Vector3::zeros(),
        ddx: Vector3::from([3.0, -2.0, 4.0]),
    };
    // The wrist is asked to be where the flange is.
    let reference = Reference::new([pushing, Target::position(x)], start());
    let mut state = State::new();
    let step: Step<f64> = controller.step(&mut state, &at(start()), &reference);
    let demand = state.data().demand.0;
    let mut cut = 0;
    for i in 0..7 {
        let limit = model.torque_limit()[i];
        let expected = demand[i].clamp(-limit, limit);
        assert_eq!(step.torque[i], expected);
        assert_eq!(step.status.saturated.contains(i), demand[i].abs() > limit);
        cut += u32::from(demand[i].abs() > limit);
    }
    assert!((2..7).contains(&cut), "{demand}");
    let bad = Measurement {
        interval_s: 1.0,
        ..at(start())
    };
    let held = controller.step(&mut state, &bad, &reference).torque;
    let limit = model.torque_limit();
    assert_eq!(
        held,
        JointVector::from_fn(|i, _| dynamics.gravity[i].clamp(-limit[i], limit[i]))
    );
    assert_eq!(
        held[1].abs(),
        10.0,
        "gravity of the shoulder is more than 10 Nm"
    );
}

/// Constant: q_d is that of every reference. Integrated, eq (51): that of the first,
/// then the trapezoidal integral of w over the measured intervals, from the next
/// reference again after a reset.
#[test]
fn the_desired_posture_is_that_of_its_mode() {
    for mode in [
        Posture::Constant,
        Posture::IntegralCoupled,
        Posture::IntegralUncoupled,
    ] {
        let mut config = three_level();
        config.null_space.posture = mode;
        let controller = controller(&config);
        let mut state = State::new();
        let mut expected: Option<(JointVector<f64>, JointVector<f64>)> = None;
        for cycle in 0..20 {
            if cycle == 12 {
                state.reset();
                // Where it starts is not joined.
                state.follow_at_once();
                expected = None;
            }
            let speed = JointVector::from_fn(|i, _| 0.2 * libm::sin(f64::from(cycle) + i as f64));
            let interval_s = 0.002 + 0.0005 * f64::from(cycle % 4);
            let measurement = Measurement {
                dq: speed,
                interval_s,
                ..at(start())
            };
            let mut reference = resting(&controller, &start());
            reference.posture.add_scalar_mut(0.01 * f64::from(cycle));
            let step = controller.step(&mut state, &measurement, &reference);
            assert_eq!(step.status.fault, None);
            let data = state.data();
            let q_d = data.posture;
            let rate = match mode {
                Posture::IntegralUncoupled => MotionSplit::uncoupled_task_velocity(
                    &data.dynamics,
                    &data.rows,
                    &data.hierarchy,
                    &data.joints,
                ),
                _ => data.motion.task_velocity,
            };
            let right = match (mode, expected) {
                (Posture::Constant, _) | (_, None) => reference.posture,
                (_, Some((last, last_rate))) => last + (rate + last_rate) * (interval_s / 2.0),
            };
            // One rounding of an angle.
            assert!((q_d - right).amax() < 1e-15, "{mode:?} {cycle}");
            expected = Some((q_d, rate));
        }
    }
}

/// The ring keeps the last cycles in order with their numbers, faults included.
#[test]
fn the_recorder_keeps_the_last_cycles() {
    let controller = controller::<f64>(&two_level());
    let mut recorder: Recorder<f64, 4> = Recorder::new();
    let mut state = State::new();
    for cycle in 0..7 {
        let mut measurement = at(start());
        measurement.interval_s = if cycle == 5 {
            f64::NAN
        } else {
            0.002 + 1e-4 * f64::from(cycle)
        };
        let step = controller.step(&mut state, &measurement, &resting(&controller, &start()));
        recorder.push(&measurement, &step);
        assert_eq!(recorder.iter().count(), 4.min(cycle as usize + 1));
    }
    let numbers: Vec<u32> = recorder.iter().map(|record| record.number).collect();
    assert_eq!(numbers, [3, 4, 5, 6]);
    let faults: Vec<bool> = recorder
        .iter()
        .map(|record| record.status.fault.is_some())
        .collect();
    assert_eq!(faults, [false, false, true, true]);
    let newest = recorder.iter().last().expect("cycles");
    assert_eq!(newest.measurement.interval_s, 0.002 + 1e-4 * 6.0);
    assert_eq!(newest.residual, JointVector::zeros());
    let third = recorder.iter().nth(2).expect("cycles");
    assert!(third.measurement.interval_s.is_nan(), "as it came");
}
