//! The sampling bound: its postures are the worst ones, and it lies where a sampled
//! loop really becomes unstable.

use arms::LWR_IV;
use controller_core::joint::{JointMatrix, JointState, JointVector};
use controller_core::law::sampling::{bound, fastest_mode, mode_at};
use controller_core::{ConfigError, Controller, ControllerConfig};
use hil_sim::plant::noise::Rng;
use stratum_tests::config::{REFERENCE_DAMPING, two_level};
use stratum_tests::random::States;
use stratum_tests::{JOINTS, lwr};

fn diagonal(values: [f64; 7]) -> JointMatrix<f64> {
    JointMatrix::from_diagonal(&values.into())
}

/// 20,000 random postures and as many near the stretched arm, where the worst
/// ones lie: none exceeds the committed set by more than 0.1 % (the set is
/// rounded to 0.01 deg).
#[test]
fn no_posture_is_worse_than_the_committed_ones() {
    let model = lwr();
    let mut dampings: Vec<JointMatrix<f64>> = vec![diagonal(REFERENCE_DAMPING), diagonal([1.0; 7])];
    dampings.extend(JOINTS.map(|joint| {
        let mut only = [1e-9; 7];
        only[joint] = 1.0;
        diagonal(only)
    }));
    for damping in dampings {
        let fastest = fastest_mode(&model, &damping).rate;
        let mut states = States::new(11);
        for n in 0..40_000 / 9 {
            let spread = if n % 2 == 0 { 1.0 } else { 0.05 };
            let rate = mode_at(&model, &damping, (states.state().q * spread).into()).rate;
            assert!(
                rate <= fastest * 1.001,
                "{rate} above {fastest} for {damping}"
            );
        }
    }
}

/// The largest eigenvalue against the Rayleigh quotient, which no vector
/// exceeds and the returned mode reaches.
#[test]
fn fastest_mode_is_the_largest_rayleigh_quotient() {
    let model = lwr();
    let damping = diagonal(REFERENCE_DAMPING);
    let mut states = States::new(12);
    for _ in 0..200 {
        let state = states.state();
        let mode = mode_at(&model, &damping, state.q.into());
        let mass_matrix = stratum_tests::evaluate(&model, &state).1.mass_matrix;
        let quotient = |x: &JointVector<f64>| x.dot(&(damping * x)) / x.dot(&(mass_matrix * x));
        for _ in 0..50 {
            assert!(quotient(&states.vector()) <= mode.rate * (1.0 + 1e-9));
        }
        // Power iteration on M^-1 D from a random start gets there.
        let cholesky = stratum_tests::evaluate(&model, &state).1.cholesky;
        let mut x = states.vector();
        for _ in 0..3_000 {
            x = cholesky
                .solve_upper(&cholesky.solve_lower(&(damping * x)))
                .normalize();
        }
        assert!((quotient(&x) / mode.rate - 1.0).abs() < 1e-6);
    }
}

#[test]
fn reference_damping_passes_the_direct_bound_and_not_the_dead_time_bound() {
    let model = lwr();
    let direct = two_level();
    let fastest = direct.validate(&model).expect("reference damping at 2 ms");
    let value = fastest.rate * 0.002;
    assert!((1.27..1.33).contains(&value), "{value}");
    let delayed = ControllerConfig {
        dead_cycles: 1,
        ..direct
    };
    match Controller::<f64>::new(&LWR_IV, &delayed) {
        Err(ConfigError::Damping { value, bound, .. }) => {
            assert!(value > bound && (bound - 1.0).abs() < 1e-12)
        }
        other => panic!("{other:?}"),
    }
}

/// The sampled mode multiplies by 1 - h lambda: at 0.98 of the bound a
/// disturbance of the damped double integrator decays, at 1.02 it grows, with up
/// to four cycles of dead time.
#[test]
fn the_bounds_are_where_the_sampled_loop_turns_unstable() {
    let grows = |h_lambda: f64, dead_cycles: usize| {
        let mut speeds = vec![1.0; dead_cycles + 1];
        for _ in 0..4_000 {
            let delayed = speeds[speeds.len() - 1 - dead_cycles];
            speeds.push(speeds[speeds.len() - 1] - h_lambda * delayed);
        }
        speeds.iter().rev().take(8).any(|speed| speed.abs() > 1.0)
    };
    assert_eq!((bound(0), bound(1)), (2.0, 1.0000000000000002));
    for dead_cycles in 0..=4 {
        let bound = bound(dead_cycles);
        let dead_cycles = usize::from(dead_cycles);
        assert!(!grows(0.98 * bound, dead_cycles));
        assert!(grows(1.02 * bound, dead_cycles));
    }
}

/// A damping proportional to the inertia has the same rate everywhere.
#[test]
fn inertia_shaped_damping_has_one_rate() {
    let model = lwr();
    let mut rng = Rng::new(3, 1);
    let q = [0.0; 7].map(|_: f64| rng.uniform());
    let state = JointState {
        q: q.into(),
        dq: JointVector::zeros(),
    };
    let damping = stratum_tests::evaluate(&model, &state).1.mass_matrix * 10.0;
    assert!((mode_at(&model, &damping, q).rate - 10.0).abs() < 1e-9);
}
