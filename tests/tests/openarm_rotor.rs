//! Rotors behind gears are up to two thirds of what a joint of OpenArm feels: the two-level
//! experiment with them in the controller's tables and without, on a plant that has them.

use arms::OPENARM_V20_LEFT;
use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::law::null_space::{NullDamping, NullSpace};
use controller_core::{Axes, Controller, ControllerConfig, Task};
use hil_sim::plant::PlantModel;
use stratum_tests::config::{REFERENCE_GAINS, with_tasks};
use stratum_tests::evaluate;
use stratum_tests::oracle::closed_loop::{ClosedLoop, circle, posture};

/// In the middle of the ranges, the elbow bent.
const START_DEG: [f64; 7] = [-30.0, -80.0, 10.0, 80.0, 10.0, 10.0, 0.0];

/// The elbow is pushed from 3 to 5 s by this force \[N\].
const PUSH: Vector3<f64> = Vector3::new(0.0, 5.0, -5.0);
const CYCLES: usize = 4_000;

/// The arm as a controller knows it that was told of bodies only.
fn without_rotors() -> ArmParameters {
    let mut arm = OPENARM_V20_LEFT;
    for link in &mut arm.links {
        link.rotor_inertia = 0.0;
    }
    arm
}

/// rms of the flange's error \[mm\] and largest |r| before the push \[Nm\].
#[derive(Debug)]
struct Figures {
    rms_mm: f64,
    residual_before: f64,
}

/// A circle of 0.05 m in 4 s with the tables `believed`.
fn run(believed: &ArmParameters) -> Figures {
    let flange = OPENARM_V20_LEFT.flange_point();
    let config = with_tasks(&[Task::position(flange, Axes::XYZ, REFERENCE_GAINS)]);
    let config = ControllerConfig {
        null_space: NullSpace {
            damping: NullDamping::Inertia(20.0),
            ..config.null_space
        },
        ..config
    };
    let motions = [circle(0.05, 4.0)];
    let mut closed =
        ClosedLoop::<f64>::with_arm(&OPENARM_V20_LEFT, &config, posture(START_DEG), &motions);
    closed.controller = Controller::exact(believed, &config).expect("either table");
    let elbow = OPENARM_V20_LEFT.point("elbow").expect("a point of the arm");
    let push = |t: f64, plant: &PlantModel, state: &JointState<f64>| {
        if (3.0..5.0).contains(&t) {
            plant.point_torque(&state.q, elbow.link.number(), &elbow.offset.into(), &PUSH)
        } else {
            JointVector::zeros()
        }
    };
    let (mut squares, mut residual_before) = (0.0, 0.0f64);
    for _ in 0..CYCLES {
        let reference = closed.reference();
        let seen = closed.step_towards(&reference, push);
        assert!(
            seen.step.status.fault.is_none(),
            "{} s: {:?}",
            seen.t_s,
            seen.step.status
        );
        squares += seen.errors[0] * seen.errors[0];
        if seen.t_s < 3.0 {
            residual_before = residual_before.max(seen.step.residual.amax());
        }
    }
    Figures {
        rms_mm: 1e3 * (squares / CYCLES as f64).sqrt(),
        residual_before,
    }
}

/// Without them the torques that move the flange are those of another, lighter arm, and what the
/// rotors take is seen as external torque.
#[test]
fn rotors_belong_into_the_table() {
    let arms = [OPENARM_V20_LEFT, without_rotors()];
    let state = JointState {
        q: posture(START_DEG),
        dq: JointVector::zeros(),
    };
    let [whole, bodies] = arms.each_ref().map(|arm| {
        let model = ArmModel::<f64>::new(arm).expect("either table");
        evaluate(&model, &state).1.mass_matrix.diagonal()
    });
    let shares = (whole - bodies).component_div(&whole);
    println!("share of the rotors in M_ii: {:.2}", shares.transpose());
    assert!(shares.min() > 0.05 && shares.max() > 0.6, "{shares}");

    let [with, without] = arms.map(|arm| run(&arm));
    println!("with rotors {with:?}, without {without:?}");
    // The push moves the flange while the estimate grows, 0.02 s; before it r is the rounding of
    // momenta and what torque held over a cycle leaves.
    assert!(with.rms_mm < 0.1 && with.residual_before < 0.01);
    assert!(without.rms_mm > 50.0 * with.rms_mm);
    assert!(without.residual_before > 1.0);
}
