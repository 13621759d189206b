//! Single against double precision, from the same source.

use controller_core::joint::{JointState, JointVector};
use controller_core::real::Real;
use controller_core::task::trajectory::Trajectory;
use controller_core::{Controller, ControllerConfig, Measurement, State, Step};
use stratum_tests::config::{three_level, two_level};
use stratum_tests::controller;
use stratum_tests::golden::Worst;
use stratum_tests::oracle::Oracle;
use stratum_tests::oracle::closed_loop::{
    CASE_START, ClosedLoop, TWO_LEVEL_START, cast, circle, posture, rms_mm,
};
use stratum_tests::oracle::sample::{SPLITS, Sample, Wish, configuration};
use stratum_tests::random::States;

/// Demands, residual and status of two cycles, the second 2 ms later.
fn two_cycles<T: Real>(
    controller: &Controller<T>,
    states: &[JointState<f64>; 2],
    wish: &Wish,
) -> ([JointVector<f64>; 2], Step<T>) {
    let mut memory = State::new();
    let reference = cast(&wish.reference);
    let [first, second] = states.map(|state| {
        let measurement = Measurement {
            q: state.q.map(T::from_f64),
            dq: state.dq.map(T::from_f64),
            interval_s: T::from_f64(0.002),
        };
        memory.follow_at_once();
        let step = controller.step(&mut memory, &measurement, &reference);
        (memory.data().demand.0.map(T::to_f64), step)
    });
    ([first.0, second.0], second.1)
}

/// Every split at random states: demands differ by rounding of f32, 6e-8, times
/// the conditioning of the whitened rows and of L, which is the root of what the
/// oracle's formulas invert. The residual differs by the rounding of p / h and of
/// u, through the filter.
#[test]
fn one_cycle_in_single_precision_differs_by_its_rounding() {
    let mut torque = Worst::new("demand / (largest, conditioning)");
    let mut plain = Worst::new("demand / largest, conditioning below 1e5");
    let mut residual = Worst::new("residual / (p / h + u)");
    let (mut skipped, mut checked) = (0, 0);
    for (index, (_, split)) in SPLITS.iter().enumerate() {
        let config = configuration(split);
        let (single, double) = (controller::<f32>(&config), controller::<f64>(&config));
        let mut random = States::new(900 + index as u64);
        for _ in 0..200 {
            let state = random.state();
            let wish = Wish::random(&double, &state, &mut random);
            let sample = Sample::new(&double, state, &wish);
            let conditioning = Oracle::new(sample.terms()).conditioning();
            // Beyond it f32 has no digits left of any row.
            if conditioning > 1e8 {
                skipped += 1;
                continue;
            }
            checked += 1;
            let later = JointState {
                q: state.q + state.dq * 0.002,
                dq: state.dq + random.vector() * 0.01,
            };
            let (demands, step) = two_cycles(&double, &[state, later], &wish);
            let (in_single, step_single) = two_cycles(&single, &[state, later], &wish);
            assert_eq!(step.status.rank, step_single.status.rank);
            for (a, b) in in_single.iter().zip(&demands) {
                let error = (a - b).amax() / b.amax();
                torque.add(error / conditioning.sqrt());
                if conditioning < 1e5 {
                    plain.add(error);
                }
            }
            let momentum = sample.data.dynamics.momentum.amax() / 0.002;
            let size = momentum + step.torque.amax() + sample.data.dynamics.coriolis.amax();
            let difference = step_single.residual.map(f64::from) - step.residual;
            residual.add(difference.amax() / size);
        }
    }
    assert!(skipped < checked / 50, "{skipped} of {checked}");
    torque.within(1e-6);
    plain.within(1e-4);
    residual.within(1e-5);
}

/// rms and largest error \[mm\] per level and the largest residual \[Nm\], from 0
/// to 10 s, free.
fn free_run<T: Real>(
    config: &ControllerConfig,
    start: [f64; 7],
    motions: &[Trajectory<f64>],
) -> (Vec<[f64; 2]>, f64) {
    let mut closed = ClosedLoop::<T>::new(config, posture(start), motions);
    let mut errors = vec![Vec::new(); motions.len()];
    let mut residual = 0.0f64;
    for _ in 0..5000 {
        let seen = closed.step();
        assert!(seen.step.status.is_clear(), "{:?}", seen.step.status);
        for (errors, error) in errors.iter_mut().zip(&seen.errors) {
            errors.push(*error);
        }
        residual = residual.max(seen.step.residual.map(T::to_f64).amax());
    }
    let figures = errors.iter().map(|errors| {
        let largest = errors.iter().fold(0.0f64, |a, &b| a.max(b));
        [rms_mm(errors), 1e3 * largest]
    });
    (figures.collect(), residual)
}

/// Ten seconds of the two-level circle on the ideal plant. Sensors of f32 (6e-8
/// rad) and its arithmetic leave hundredths of a mm at most.
#[test]
fn the_two_level_circle_is_kept_in_single_precision() {
    let motions = [circle(0.1, 6.0)];
    let (double, quiet) = free_run::<f64>(&two_level(), TWO_LEVEL_START, &motions);
    let (single, noisy) = free_run::<f32>(&two_level(), TWO_LEVEL_START, &motions);
    println!(
        "rms, max [mm]: f64 {double:.5?}, f32 {single:.5?}; residual {quiet:.1e}, {noisy:.1e} Nm"
    );
    // As in the two-level experiment.
    assert!(double[0][0] < 0.001 && double[0][1] < 0.003);
    assert!(single[0][0] < 0.002 && single[0][1] < 0.01);
    assert!(noisy < 0.05);
}

/// The same for three levels, where a second level hangs on the first.
#[test]
fn three_levels_are_kept_in_single_precision() {
    let motions = [circle(0.04, 5.0), Trajectory::Hold];
    let (double, _) = free_run::<f64>(&three_level(), CASE_START, &motions);
    let (single, _) = free_run::<f32>(&three_level(), CASE_START, &motions);
    println!("rms, max [mm]: f64 {double:.5?}, f32 {single:.5?}");
    for level in 0..2 {
        assert!(double[level][0] < 0.001);
        assert!(single[level][0] < 0.002 && single[level][1] < 0.01);
    }
}
