//! Where nothing is at a limit the law is the exact one.

use arms::LWR_IV;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{JointState, JointVector};
use controller_core::real::Real;
use controller_core::{Axes, Controller, ControllerConfig, Measurement, Reference, Target, Task};
use stratum_tests::config::{ELBOW, FLANGE, REFERENCE_GAINS, WRIST, with_tasks};
use stratum_tests::random::States;

/// What a law asks for at a state where nothing is at a limit; none elsewhere.
fn torques<T: Real>(
    laws: &[Controller<T>; 2],
    joints: &JointState<f64>,
    reference: &Reference<f64>,
    residual: &JointVector<f64>,
) -> Option<[JointVector<f64>; 2]> {
    let narrow = |x: &JointVector<f64>| x.map(T::from_f64);
    let measurement = Measurement {
        q: narrow(&joints.q),
        dq: narrow(&joints.dq),
        interval_s: T::from_f64(0.002),
    };
    let mut wanted = Reference::hold(reference.targets().len(), narrow(&reference.posture));
    for (wanted, target) in wanted.targets_mut().iter_mut().zip(reference.targets()) {
        *wanted = narrowed(target);
    }
    let input = Input {
        measurement: &measurement,
        reference: &wanted,
    };
    let [within, exact] = laws.each_ref().map(|law| {
        let mut data = Data::new();
        data.observer.residual = narrow(residual);
        law.evaluate(&input, &mut data);
        data
    });
    let (spectrum, wish) = (&within.spectrum, &within.wish);
    let touched = spectrum.degraded.any() | wish.scaled.any() | wish.shaped.any();
    let untouched = !touched && within.bounds.contain(&wish.acceleration);
    let wide = |x: &JointVector<T>| x.map(T::to_f64);
    untouched.then(|| [wide(&within.demand.0), wide(&exact.demand.0)])
}

fn narrowed<T: Real>(target: &Target<f64>) -> Target<T> {
    match target {
        Target::Position { x, dx, ddx } => Target::Position {
            x: x.map(T::from_f64),
            dx: dx.map(T::from_f64),
            ddx: ddx.map(T::from_f64),
        },
        other => panic!("{other:?} is not used here"),
    }
}

/// Flange, flange and wrist, flange and elbow height, four levels.
fn sets() -> Vec<ControllerConfig> {
    let flange = Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS);
    let wrist = |axes| Task::position(WRIST, axes, REFERENCE_GAINS);
    let elbow = |axes| Task::position(ELBOW, axes, REFERENCE_GAINS);
    vec![
        with_tasks(&[flange]),
        with_tasks(&[flange, wrist(Axes::XY)]),
        with_tasks(&[flange, elbow(Axes::Z), wrist(Axes::X)]),
        with_tasks(&[elbow(Axes::XY), flange]),
    ]
}

/// Largest relative differences, of the torque of states that no limit touches.
#[derive(Default)]
struct Apart {
    /// Of both laws from each other.
    laws: f64,
    /// Of the law within limits from the exact one in double precision.
    within: f64,
    /// The same of the exact law.
    exact: f64,
}

fn apart<T: Real>(wanted: usize) -> Apart {
    let law = |config: &ControllerConfig| {
        [
            Controller::<T>::new(&LWR_IV, config).expect("valid"),
            Controller::exact(&LWR_IV, config).expect("valid"),
        ]
    };
    let sets: Vec<_> = sets()
        .iter()
        .map(|config| {
            let truth = Controller::<f64>::exact(&LWR_IV, config).expect("valid");
            (law(config), [truth.clone(), truth])
        })
        .collect();
    let mut states = States::new(7);
    let mut apart = Apart::default();
    let (mut found, mut drawn) = (0, 0);
    while found < wanted {
        let (laws, truth) = &sets[drawn % sets.len()];
        drawn += 1;
        let mut joints = states.state();
        joints.q *= 0.9;
        joints.dq *= 0.3;
        let mut reference = truth[0].moving_reference(&joints);
        for target in reference.targets_mut() {
            if let Target::Position { x, dx, ddx } = target {
                *x += states.vector().fixed_rows::<3>(0) * 2e-3;
                *dx += states.vector().fixed_rows::<3>(0) * 0.02;
                *ddx += states.vector().fixed_rows::<3>(0) * 0.5;
            }
        }
        reference.posture += states.vector() * 0.2;
        let residual = states
            .vector()
            .component_mul(&JointVector::from([3.0, 3.0, 1.0, 1.0, 0.1, 0.1, 0.01]));
        let Some([within, exact]) = torques(laws, &joints, &reference, &residual) else {
            continue;
        };
        found += 1;
        let [_, truth] = torques(truth, &joints, &reference, &residual).expect("the exact law");
        let relative = |a: &JointVector<f64>, b: &JointVector<f64>| (a - b).norm() / truth.norm();
        apart.laws = apart.laws.max(relative(&within, &exact));
        apart.within = apart.within.max(relative(&within, &truth));
        apart.exact = apart.exact.max(relative(&exact, &truth));
    }
    println!("{wanted} of {drawn} states");
    apart
}

#[test]
fn untouched_states_have_the_torque_of_the_exact_law() {
    let double = apart::<f64>(4096).laws;
    // Both solve the same equations, by other factorisations.
    println!("f64: {double:.1e} apart");
    assert!(double < 1e-9, "{double:e}");
    let single = apart::<f32>(4096);
    println!(
        "f32: {:.1e} from f64, the exact law {:.1e}",
        single.within, single.exact
    );
    assert!(single.within < 1.5 * single.exact);
}
