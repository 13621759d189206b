//! The momentum observer (30): its discrete form is the exact solution, whatever
//! the gain and the interval, and inside the controller it is fed with what
//! really happened.

use arms::LWR_IV;
use cell::names::PlantKind;
use controller_core::cycle::observer::{Observer, external_torque};
use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::law::null_space::NullDamping;
use controller_core::{Controller, Measurement, Reference, State, Target};
use hil_sim::plant::Plant;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use std::cell::RefCell;
use stratum_tests::config::{FLANGE, two_level};
use stratum_tests::golden::Worst;
use stratum_tests::oracle::closed_loop::{
    TWO_LEVEL_START, circle, no_contact, posture, true_point,
};
use stratum_tests::random::States;
use stratum_tests::{controller, evaluate, lwr};

/// Eq (30): with a constant disturbance F and a known input that jumps at every
/// instant, r = F (1 - e^(-K_I t)) at the instants, for any gains and any
/// intervals: eq (31) solved, and the decay of r~ = r + tau_ext, eq (40). The
/// momentum is simulated exactly; its rounding, 1e-16 |p| / h, is what the
/// difference may show, beside that of sums of |u| and |F|.
#[test]
fn the_step_response_is_the_exponential_at_every_instant_for_any_gain() {
    let config = ProptestConfig {
        cases: 2000,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(30),
        ..ProptestConfig::default()
    };
    let worst = RefCell::new(Worst::new("r / rounding"));
    let strategy = (
        prop::array::uniform7(-1.0..5.0f64),
        prop::collection::vec(-4.0..-1.4f64, 1..60),
        any::<u64>(),
    );
    let outcome = TestRunner::new(config).run(&strategy, |(gains, intervals, seed)| {
        let gain: JointVector<f64> = gains.map(libm::exp10).into();
        let mut random = States::new(seed);
        let force = random.vector() * 30.0;
        let mut momentum = random.vector() * 3.0;
        let mut observer = Observer::new();
        observer.update(&gain, 0.002, &momentum);
        prop_assert_eq!(observer.residual, JointVector::zeros());
        let (mut time, mut largest, mut shortest) = (0.0, 0.0f64, 1.0f64);
        for interval in intervals.into_iter().map(libm::exp10) {
            let input = random.vector() * 50.0;
            observer.input = input;
            momentum += (input + force) * interval;
            time += interval;
            observer.update(&gain, interval, &momentum);
            (largest, shortest) = (largest.max(momentum.amax()), shortest.min(interval));
            for i in 0..7 {
                let expected = -force[i] * libm::expm1(-gain[i] * time);
                let rounding = f64::EPSILON * (largest / shortest + 80.0);
                (worst.borrow_mut()).add((observer.residual[i] - expected).abs() / rounding);
            }
        }
        Ok(())
    });
    outcome.expect("every case");
    // A few roundings per cycle of sixty.
    worst.into_inner().within(10.0);
}

/// Eq (31), dr/dt = K_I (d(t) - r), for a disturbance that grows
/// and swings, against the discrete form: the mean of d over each cycle is
/// exact, so halving the cycle divides the error by four.
#[test]
fn a_changing_disturbance_is_followed_to_second_order() {
    const GAIN: f64 = 50.0;
    const OMEGA: f64 = 20.0;
    // d = sin(omega t): r = K (K sin - w cos + w e^(-K t)) / (K^2 + w^2).
    let solution = |t: f64| {
        let decayed = OMEGA * libm::exp(-GAIN * t);
        GAIN * (GAIN * libm::sin(OMEGA * t) - OMEGA * libm::cos(OMEGA * t) + decayed)
            / (GAIN * GAIN + OMEGA * OMEGA)
    };
    let error = |interval: f64| {
        let mut observer = Observer::new();
        let mut worst = 0.0f64;
        for k in 0..=(1.0 / interval) as u32 {
            let t = f64::from(k) * interval;
            let momentum = JointVector::repeat((1.0 - libm::cos(OMEGA * t)) / OMEGA);
            observer.update(&JointVector::repeat(GAIN), interval, &momentum);
            worst = worst.max((observer.residual[3] - solution(t)).abs());
        }
        worst
    };
    let [coarse, fine] = [0.002, 0.001].map(error);
    println!("errors {coarse:e}, {fine:e}");
    assert!((3.8..4.2).contains(&(coarse / fine)), "{coarse} {fine}");
    // h^2 K omega / 12 of the largest d.
    assert!(coarse < 4e-4, "{coarse}");
}

/// K_I h = 3: the explicit Euler form of eq (30) multiplies its error by -2 every
/// cycle, the exact form settles within a few. Covers the sign of eq (31).
#[test]
fn it_is_stable_where_the_euler_form_is_not() {
    let (interval, gain, force) = (0.002, 1500.0, 7.0f64);
    let mut observer = Observer::new();
    let mut euler = 0.0f64;
    let mut momentum = 0.5;
    for _ in 0..30 {
        observer.update(
            &JointVector::repeat(gain),
            interval,
            &JointVector::repeat(momentum),
        );
        euler += gain * interval * (force - euler);
        momentum += force * interval;
    }
    let residual = observer.residual[0];
    assert!((residual - force).abs() < 1e-9, "{residual}");
    assert!((euler - force).abs() > 1e6, "{euler}");
    // The sign is flipped in one place, eq (31).
    assert_eq!(
        external_torque(&JointVector::repeat(residual))[6],
        -residual
    );
}

/// Starts at full speed: the first residual is exactly zero and stays at
/// rounding while nothing pushes. Starting from p = 0 as eq (30) is printed the
/// residual would begin with K_I p.
#[test]
fn starting_in_motion_gives_no_jump() {
    let model = lwr();
    let start = posture(TWO_LEVEL_START);
    let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, start, 0.002, 1);
    let push = JointVector::from([10.0, -5.0, 3.0, 5.0, 0.2, 0.1, 0.001])
        + evaluate(&model, plant.state()).1.gravity;
    for _ in 0..100 {
        plant.advance(0.0, &push, no_contact);
    }
    let momentum = evaluate(&model, plant.state()).1.momentum;
    assert!(momentum.amax() > 1.0, "a moving arm: {momentum}");
    let controller = controller(&two_level());
    let mut state = State::new();
    let mut largest = 0.0f64;
    for cycle in 0..50 {
        let reference = towards(Target::position(flange(&plant)), plant.state().q);
        let step = controller.step(&mut state, &measured(&plant, 0.002), &reference);
        assert!(step.status.fault.is_none(), "{:?}", step.status);
        if cycle == 0 {
            assert_eq!(step.residual, JointVector::zeros());
        }
        largest = largest.max(step.residual.amax());
        plant.advance(0.0, &step.torque, no_contact);
    }
    println!(
        "largest residual {largest:.3} Nm, K_I p = {:.0} Nm/s",
        50.0 * momentum.amax()
    );
    // C^T dq - g is held over 2 ms while the arm brakes hard.
    assert!(largest < 0.1, "{largest}");
}

/// An arm whose shoulder may only give 90 % of the torque that holds it: every
/// cycle is cut, by ever more as it sinks. The observer knows the torque that was
/// applied; with the one demanded r would show the difference.
#[test]
fn saturated_torque_is_not_taken_for_an_external_one() {
    let start = posture(TWO_LEVEL_START);
    let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, start, 0.002, 1);
    let mut arm = LWR_IV;
    arm.links[1].torque_limit = 0.9 * evaluate(&lwr(), plant.state()).1.gravity[1].abs();
    let controller = Controller::new(&arm, &two_level()).expect("a weak arm");
    let mut state = State::new();
    let x = flange(&plant);
    let (mut largest, mut excess) = (0.0f64, 0.0f64);
    for _ in 0..100 {
        let reference = towards(Target::position(x), start);
        let step = controller.step(&mut state, &measured(&plant, 0.002), &reference);
        assert!(step.status.fault.is_none(), "{:?}", step.status);
        assert!(step.status.saturated.contains(1));
        excess = excess.max((state.data().demand.0 - step.torque).amax());
        largest = largest.max(step.residual.amax());
        plant.advance(0.0, &step.torque, no_contact);
    }
    println!("cut by up to {excess:.0} Nm, residual {largest:.4} Nm");
    assert!(excess > 5.0, "{excess}");
    // What C^T dq - g changes within a cycle.
    assert!(largest < 0.01 * excess, "{largest}");
}

fn flange(plant: &Plant) -> Vector3<f64> {
    true_point(plant, FLANGE)
}

fn measured(plant: &Plant, interval_s: f64) -> Measurement<f64> {
    let JointState { q, dq } = *plant.state();
    Measurement { q, dq, interval_s }
}

fn towards(target: Target<f64>, posture: JointVector<f64>) -> Reference<f64> {
    Reference::new([target], posture)
}

/// Runs the fast circle with plant steps of 0.5 ms and controller intervals of 2
/// to 10 of them, pushed by `push` \[N\] along y at the elbow from 1 s on. Returns
/// the largest distance of r from the exponential answer to tau_ext.
fn with_varying_intervals(push: f64, claimed: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 0.0005;
    let start = posture(TWO_LEVEL_START);
    let motion = circle(0.1, 3.0);
    let controller = controller(&two_level());
    let mut state = State::new();
    let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, start, STEP, 1);
    let origin = flange(&plant);
    let mut random = States::new(8);
    let (mut t, mut interval, mut worst) = (0.0, 0.002, 0.0f64);
    let mut expected = JointVector::zeros();
    let force = [0.0, push, 0.0].into();
    while t < 4.0 {
        let reference = towards(motion.sample(&origin, t), start);
        let step = controller.step(&mut state, &measured(&plant, claimed(interval)), &reference);
        assert!(step.status.fault.is_none(), "{:?}", step.status);
        worst = worst.max((step.residual - expected).amax());
        let count = 2 + (4.5 * (random.signed() + 1.0)) as u32;
        interval = f64::from(count) * STEP;
        for _ in 0..count {
            let pushed = t >= 1.0;
            plant.advance(t, &step.torque, |_, model, state| {
                let torque = model.point_torque(&state.q, 3, &[0.0; 3].into(), &force);
                if pushed { torque } else { JointVector::zeros() }
            });
            // The continuous observer: dr/dt = K_I (-tau_ext - r).
            let acting = plant
                .model()
                .point_torque(&plant.state().q, 3, &[0.0; 3].into(), &force);
            let target = if pushed { acting } else { JointVector::zeros() };
            expected += (target - expected) * -libm::expm1(-50.0 * STEP);
            t += STEP;
        }
    }
    worst
}

/// Intervals between 1 and 5 ms, known to the controller: r is the continuous
/// observer's answer. With the nominal 2 ms claimed instead it is not.
#[test]
fn the_interval_that_counts_is_the_measured_one() {
    let free = with_varying_intervals(0.0, |interval| interval);
    let pushed = with_varying_intervals(35.0, |interval| interval);
    let nominal = with_varying_intervals(0.0, |_| 0.002);
    println!("free {free:.3} Nm, pushed {pushed:.3} Nm, nominal claimed {nominal:.2} Nm");
    // u is held over up to 5 ms on a circle of 0.1 m in 3 s: hundredths of Nm.
    assert!(free < 0.05, "{free}");
    // tau_ext of 14 Nm is met by a push that starts between instants.
    assert!(pushed < 0.2, "{pushed}");
    assert!(nominal > 10.0 * free, "{nominal}");
}

/// Torque that acts two cycles late: told of it, the observer stays at zero on a
/// circle; told nothing, it takes the delay for a push.
#[test]
fn dead_time_is_known_to_the_observer() {
    let largest = |dead_cycles: u8| {
        let start = posture(TWO_LEVEL_START);
        let mut config = two_level();
        config.null_space.damping = NullDamping::Inertia(10.0);
        config.dead_cycles = dead_cycles;
        let motion = circle(0.1, 2.0);
        let controller = controller(&config);
        let mut state = State::new();
        let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, start, 0.002, 1);
        let origin = flange(&plant);
        let gravity = evaluate(&lwr(), plant.state()).1.gravity;
        let mut wire = [gravity; 2];
        let mut largest = 0.0f64;
        for cycle in 0..1500 {
            let t = f64::from(cycle) * 0.002;
            let reference = towards(motion.sample(&origin, t), start);
            let step = controller.step(&mut state, &measured(&plant, 0.002), &reference);
            assert!(step.status.is_clear(), "{:?}", step.status);
            largest = largest.max(step.residual.amax());
            plant.advance(t, &wire[1], no_contact);
            wire = [step.torque, wire[0]];
        }
        largest
    };
    let (told, untold) = (largest(2), largest(0));
    println!("told {told:.4} Nm, untold {untold:.3} Nm");
    // u is held over 2 ms; the circle of 0.1 m takes 2 s.
    assert!(told < 0.05, "{told}");
    assert!(untold > 5.0 * told, "{untold}");
}
