//! Controllers of two arms side by side in one program: neither knows of the other.

use arms::{FR3, LWR_IV};
use controller_core::arm::ArmParameters;
use controller_core::joint::JointVector;
use controller_core::law::null_space::{NullDamping, NullSpace};
use controller_core::real::Real;
use controller_core::{Axes, ControllerConfig, Step, Task};
use stratum_tests::config::{REFERENCE_GAINS, with_tasks};
use stratum_tests::oracle::closed_loop::{ClosedLoop, TWO_LEVEL_START, circle, posture};

const CYCLES: usize = 2_000;

/// The flange on a circle, the null space as heavy as the arm.
fn closed_loop<T: Real>(arm: &ArmParameters, start: JointVector<f64>) -> ClosedLoop<T> {
    let flange = Task::position(arm.flange_point(), Axes::XYZ, REFERENCE_GAINS);
    let config = with_tasks(&[flange]);
    let config = ControllerConfig {
        null_space: NullSpace {
            damping: NullDamping::Inertia(20.0),
            ..config.null_space
        },
        ..config
    };
    ClosedLoop::with_arm(arm, &config, start, &[circle(0.05, 4.0)])
}

/// In the precision of each controller: bits of torque, residual and gravity.
fn bits<T: Real>(step: &Step<T>) -> Vec<u64> {
    assert!(step.status.is_clear(), "{:?}", step.status);
    let vectors = [step.torque, step.residual, step.gravity, step.coriolis];
    let numbers = vectors.iter().flat_map(|vector| vector.iter());
    numbers.map(|x| x.to_f64().to_bits()).collect()
}

fn lwr() -> ClosedLoop<f64> {
    closed_loop(&LWR_IV, posture(TWO_LEVEL_START))
}

fn fr3<T: Real>() -> ClosedLoop<T> {
    // The maker's "ready" posture.
    closed_loop(&FR3, posture([0.0, -45.0, 0.0, -135.0, 0.0, 90.0, 45.0]))
}

fn alone<T: Real>(mut arm: ClosedLoop<T>) -> Vec<Vec<u64>> {
    (0..CYCLES).map(|_| bits(&arm.step().step)).collect()
}

/// Cycle by cycle in turn, in different precisions too, each has the bits that it has alone;
/// and both move, so that there is something to mistake.
#[test]
fn two_arms_in_turn_have_the_bits_of_each_alone() {
    let (lwr_alone, fr3_alone, single_alone) =
        (alone(lwr()), alone(fr3::<f64>()), alone(fr3::<f32>()));
    let (mut one, mut other, mut single) = (lwr(), fr3::<f64>(), fr3::<f32>());
    let start = [*one.plant.state(), *other.plant.state()];
    for cycle in 0..CYCLES {
        assert_eq!(
            bits(&one.step().step),
            lwr_alone[cycle],
            "LWR, cycle {cycle}"
        );
        assert_eq!(
            bits(&other.step().step),
            fr3_alone[cycle],
            "FR3, cycle {cycle}"
        );
        assert_eq!(
            bits(&single.step().step),
            single_alone[cycle],
            "FR3 in f32, cycle {cycle}"
        );
    }
    for (start, plant) in start.iter().zip([&one.plant, &other.plant]) {
        assert!((plant.state().q - start.q).amax() > 0.05);
    }
    assert_ne!(lwr_alone, fr3_alone);
}

/// The same on threads of their own: controllers are shared, states are not.
#[test]
fn two_arms_on_two_threads_have_the_bits_of_each_alone() {
    let (lwr_alone, fr3_alone) = (alone(lwr()), alone(fr3::<f64>()));
    let (one, other) = std::thread::scope(|scope| {
        let one = scope.spawn(|| alone(lwr()));
        let other = scope.spawn(|| alone(fr3::<f64>()));
        (one.join().expect("the LWR"), other.join().expect("the FR3"))
    });
    assert!(one == lwr_alone && other == fr3_alone);
}
