//! In the experiments, which come to no limit, every cycle has the torque of the exact law.

use cell::names::PlantKind;
use cell::scenario::Scenario;
use controller_core::joint::{JointState, JointVector};
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, State};
use hil_sim::arm_points::origins;
use hil_sim::contact::Contacts;
use hil_sim::plant::Plant;

/// A controller and what it knows.
struct Law<T: Real> {
    controller: Controller<T>,
    state: State<T>,
}

impl<T: Real> Law<T> {
    fn new(scenario: &Scenario, within_limits: bool) -> Self {
        let (arm, config) = (scenario.arm().parameters, scenario.controller_config(0));
        let config = config.expect("a valid scenario");
        let controller = match within_limits {
            true => Controller::new(&arm, &config),
            false => Controller::exact(&arm, &config),
        };
        Self {
            controller: controller.expect("a valid configuration"),
            state: State::new(),
        }
    }

    /// The torque \[Nm\] of a cycle in which nothing is at a limit.
    fn torque(
        &mut self,
        joints: &JointState<f64>,
        reference: &Reference<f64>,
        cycle_s: f64,
    ) -> JointVector<f64> {
        let measurement = Measurement {
            q: joints.q.map(T::from_f64),
            dq: joints.dq.map(T::from_f64),
            interval_s: T::from_f64(cycle_s),
        };
        let posture = reference.posture.map(T::from_f64);
        let mut wanted = Reference::hold(reference.targets().len(), posture);
        for (wanted, target) in wanted.targets_mut().iter_mut().zip(reference.targets()) {
            *wanted = target.cast();
        }
        let step = self.controller.step(&mut self.state, &measurement, &wanted);
        assert!(step.status.is_clear(), "{:?}", step.status);
        step.torque.map(T::to_f64)
    }
}

/// Largest relative differences over a run by the law within limits in the precision `T`.
#[derive(Debug, Default)]
struct Apart {
    /// From the exact law in the same precision.
    laws: f64,
    /// From the exact law in double precision.
    within: f64,
    /// Of the exact law in `T` from that.
    exact: f64,
}

fn run<T: Real>(name: &str, plant: PlantKind, contacts: bool) -> Apart {
    let scenario = Scenario::find(name).expect("built in");
    let (start, cycle_s) = (scenario.start(), scenario.cycle_s());
    let mut laws = [true, false].map(|within| Law::<T>::new(&scenario, within));
    let mut truth = Law::<f64>::new(&scenario, false);
    let origins = origins(&scenario, &start);
    let mut contacts = match contacts {
        true => Contacts::of(&scenario),
        false => Contacts::none(),
    };
    let arm = scenario.arm().parameters;
    let mut plant = Plant::new(plant, &arm, start, cycle_s, 1);
    let mut apart = Apart::default();
    for cycle in 0..scenario.cycles() {
        let t_s = cycle as f64 * cycle_s;
        let joints = plant.measure();
        let reference = scenario.reference(&origins, &start, t_s);
        let [within, exact] = laws
            .each_mut()
            .map(|law| law.torque(&joints, &reference, cycle_s));
        let truth = truth.torque(&joints, &reference, cycle_s);
        let relative = |a: &JointVector<f64>, b: &JointVector<f64>| (a - b).norm() / truth.norm();
        apart.laws = apart.laws.max(relative(&within, &exact));
        apart.within = apart.within.max(relative(&within, &truth));
        apart.exact = apart.exact.max(relative(&exact, &truth));
        let held = *plant.state();
        contacts.take_hold(t_s, plant.model(), &held);
        plant.advance(t_s, &within, |t_s, model, state| {
            contacts.joint_torque(t_s, model, state).0
        });
    }
    apart
}

#[test]
fn the_experiments_have_the_torque_of_the_exact_law() {
    for name in ["two-level", "case-1"] {
        for plant in [PlantKind::Ideal, PlantKind::Realistic] {
            for contacts in [false, true] {
                let double = run::<f64>(name, plant, contacts);
                let single = run::<f32>(name, plant, contacts);
                println!("{name} {plant:?} {contacts}: {double:?} {single:?}");
                // Both laws solve the same equations, by other factorisations.
                assert!(double.laws < 1e-9, "{name} {plant:?} {contacts} {double:?}");
                // Rounding in single precision is that of the exact law.
                let most = 1.5 * single.exact;
                assert!(
                    single.within < most,
                    "{name} {plant:?} {contacts} {single:?}"
                );
            }
        }
    }
}
