//! The data of a state: every result of its last cycle, nothing of another controller,
//! the same bits for the same input.

use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::fault::FaultKind;
use controller_core::joint::{JointState, JointVector, zeros};
use controller_core::law::control::TorqueDemand;
use controller_core::law::null_space::{NullDamping, Posture};
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, State, Step, Target};
use stratum_tests::controller;
use stratum_tests::oracle::closed_loop::cast;
use stratum_tests::oracle::sample::{SPLITS, Wish, configuration};
use stratum_tests::random::States;

/// As text: the data of a cycle has no equality. The shortest decimals that read back
/// as the same number, so equal text is equal bits.
fn text(data: &impl std::fmt::Debug) -> String {
    format!("{data:?}")
}

/// A measurement and a reference per cycle, as a robot in motion would give them.
fn inputs(controller: &Controller<f64>, seed: u64) -> Vec<(Measurement<f64>, Reference<f64>)> {
    let mut random = States::new(seed);
    let first = random.state();
    (0..6)
        .map(|cycle| {
            let t = 0.002 * f64::from(cycle);
            let joints = JointState {
                q: first.q * 0.9 + first.dq * t,
                dq: first.dq * (1.0 - t),
            };
            let mut reference = Wish::random(controller, &joints, &mut random).reference;
            if cycle % 3 == 1 {
                reference.targets_mut()[0] = Target::Hold;
            }
            let measurement = Measurement {
                q: joints.q,
                dq: joints.dq,
                interval_s: 0.002 + 1e-4 * f64::from(cycle),
            };
            (measurement, reference)
        })
        .collect()
}

fn narrow<T: Real>(measurement: &Measurement<f64>) -> Measurement<T> {
    Measurement {
        q: measurement.q.map(T::from_f64),
        dq: measurement.dq.map(T::from_f64),
        interval_s: T::from_f64(measurement.interval_s),
    }
}

/// Every split with everything that is remembered: dead time, integrated posture, held
/// places, residual.
fn configurations() -> Vec<controller_core::ControllerConfig> {
    let configs = SPLITS.iter().map(|(_, split)| {
        let mut config = configuration(split);
        config.dead_cycles = 2;
        config.null_space.damping = NullDamping::Inertia(10.0);
        config.null_space.posture = Posture::IntegralUncoupled;
        config
    });
    configs.collect()
}

/// The stages on the same inputs give what the state holds, and the answer of the
/// cycle is read off from it.
fn a_state_holds_what_the_stages_give<T: Real>() {
    for (index, config) in configurations().iter().enumerate() {
        let wide = controller::<f64>(config);
        let controller = controller::<T>(config);
        let (mut state, mut data) = (State::new(), Data::new());
        for (measurement, reference) in inputs(&wide, 40 + index as u64) {
            let (measurement, reference) = (narrow(&measurement), cast(&reference));
            // As an evaluation does.
            state.follow_at_once();
            let step = controller.step(&mut state, &measurement, &reference);
            assert_eq!(step.status.fault, None);
            let input = Input {
                measurement: &measurement,
                reference: &reference,
            };
            controller.evaluate(&input, &mut data);
            assert_eq!(text(state.data()), text(&data));
            assert_eq!(step.torque, data.allocation.torque);
            assert_eq!(step.residual, *data.residual());
            assert_eq!(step.gravity, data.dynamics.gravity);
            assert_eq!(step.coriolis, data.dynamics.coriolis);
            assert_eq!(step.status.saturated, data.allocation.saturated);
            assert_eq!(step.status.rank, data.hierarchy.deficient());
            assert_eq!(
                (data.joints.q, data.joints.dq),
                (measurement.q, measurement.dq)
            );
        }
    }
}

#[test]
fn the_data_of_a_state_is_what_the_stages_give() {
    a_state_holds_what_the_stages_give::<f64>();
    a_state_holds_what_the_stages_give::<f32>();
}

/// Up to a stage: what stands above it is computed, what stands below it is as it was.
#[test]
fn the_stages_up_to_one_leave_the_others_alone() {
    let controller = controller::<f64>(&configuration(SPLITS[7].1));
    let cycles = inputs(&controller, 60);
    let input = |cycle: usize| Input {
        measurement: &cycles[cycle].0,
        reference: &cycles[cycle].1,
    };
    let mut before = Data::new();
    controller.evaluate(&input(0), &mut before);
    let mut after = before.clone();
    controller.evaluate(&input(2), &mut after);
    /// The result of each stage as text.
    fn results(data: &Data<f64>) -> [String; 12] {
        [
            text(&data.joints),
            text(&data.kinematics),
            text(&data.dynamics),
            text(&data.holding_torque),
            text(data.residual()),
            text(&data.followed),
            text(&data.rows),
            text(&data.hierarchy),
            text(&data.motion),
            text(&data.posture),
            text(&data.control),
            text(&data.demand),
        ]
    }
    let (old, new) = (results(&before), results(&after));
    // Tasks stay as they are where none is changed.
    let names = Controller::<f64>::EXACT_STAGES.map(|(name, _)| name);
    let changed = names.into_iter().filter(|name| *name != StageName::Tasks);
    let names: Vec<_> = changed.collect();
    for (index, &last) in names.iter().take(old.len()).enumerate() {
        let mut data = before.clone();
        controller.evaluate_until(last, &input(2), &mut data);
        let seen = results(&data);
        assert_eq!(seen[..=index], new[..=index], "{}", last.text());
        assert_eq!(seen[index + 1..], old[index + 1..], "{}", last.text());
        assert_ne!(seen[index], old[index], "{}", last.text());
    }
    let all = [StageName::TorqueDemand, StageName::ObserverInput];
    assert_eq!([names[11], names[13]], all);
}

/// A law that demands what the product's law demands changes no bit; one that demands
/// something else is cut and observed as the product's.
#[test]
fn another_law_takes_the_place_of_one_stage() {
    let controller = controller::<f64>(&configurations()[7]);
    let (mut own, mut other, mut limp) = (State::new(), State::new(), State::new());
    for (measurement, reference) in inputs(&controller, 61) {
        let expected = controller.step(&mut own, &measurement, &reference);
        let step = controller.step_with(&mut other, &measurement, &reference, |_, _, data| {
            let (dynamics, residual) = (&data.dynamics, data.residual());
            data.demand =
                TorqueDemand::compensating(dynamics, &data.hierarchy, &data.control, residual);
        });
        assert_eq!(step, expected);
        assert_eq!(text(other.data()), text(own.data()));
        let step = controller.step_with(&mut limp, &measurement, &reference, |_, input, data| {
            assert_eq!(input.reference.targets().len(), reference.targets().len());
            assert_eq!(data.joints.q, measurement.q);
            data.demand = TorqueDemand(JointVector::repeat(1e4));
        });
        assert_eq!(step.torque, *controller.arm().torque_limit());
        assert_eq!(step.status.saturated.0, 0b111_1111);
    }
}

/// Some cycles of `controller` from `state`.
fn run<T: Real>(controller: &Controller<T>, state: &mut State<T>, seed: u64) -> Vec<Step<T>> {
    let mut random = States::new(seed);
    let first = random.state();
    (0..4)
        .map(|cycle| {
            let t = 0.002 * f64::from(cycle);
            let measurement = Measurement {
                q: (first.q * 0.9 + first.dq * t).map(T::from_f64),
                dq: first.dq.map(T::from_f64),
                interval_s: T::from_f64(0.002),
            };
            let joints = JointState {
                q: measurement.q * T::from_f64(0.99),
                dq: measurement.dq,
            };
            let mut reference = controller.moving_reference(&joints);
            if cycle > 1 {
                reference.targets_mut()[0] = Target::Hold;
            }
            controller.step(state, &measurement, &reference)
        })
        .collect()
}

/// From seven rows to one and to every number between: after a reset, which clears
/// what is remembered, a used state gives the bits of a fresh one, so no row and no flag
/// of the other controller is left in it. The other one ended with a stretched arm, or
/// with a law that gave a torque that is not finite.
fn a_used_state_is_a_fresh_one<T: Real>() {
    let controllers: Vec<_> = configurations().iter().map(controller::<T>).collect();
    let mut flagged = 0;
    for (first, before) in controllers.iter().enumerate() {
        for (second, after) in controllers.iter().enumerate() {
            let mut used = State::new();
            let steps = run(before, &mut used, 70);
            assert_eq!(steps[3].status.fault, None);
            let (mut poisoned, last) = (used.clone(), used.data().joints);
            let reference = before.moving_reference(&last);
            let measurement = Measurement {
                q: last.q,
                dq: last.dq,
                interval_s: T::from_f64(0.002),
            };
            let step = before.step_with(&mut poisoned, &measurement, &reference, |_, _, data| {
                data.demand = TorqueDemand(JointVector::repeat(T::from_f64(f64::NAN)));
            });
            let fault = step.status.fault.expect("not finite");
            assert_eq!(fault.kind, FaultKind::NonFiniteTorque);
            let stretched = Measurement {
                q: zeros(),
                dq: zeros(),
                ..measurement
            };
            let hold = Reference::hold(before.level_count(), stretched.q);
            let step = before.step(&mut used, &stretched, &hold);
            assert_eq!(step.status.fault, None);
            flagged += u32::from(step.status.rank.any());

            // What acts goes on behind a reset.
            let mut fresh = State::new();
            fresh.set_applied_torque(&zeros());
            let expected = run(after, &mut fresh, 71);
            for state in [&mut used, &mut poisoned] {
                state.reset();
                state.set_applied_torque(&zeros());
                let steps = run(after, state, 71);
                assert_eq!(
                    steps, expected,
                    "{} after {}",
                    SPLITS[second].0, SPLITS[first].0
                );
                let [data, right] = [state.data(), fresh.data()];
                assert_eq!(data.rows.count(), right.rows.count());
                assert_eq!(data.hierarchy.count(), right.hierarchy.count());
                assert_eq!(data.hierarchy.levels(), right.hierarchy.levels());
                assert_eq!(
                    data.hierarchy.conditioning(),
                    right.hierarchy.conditioning()
                );
                assert_eq!(text(&data.control), text(&right.control));
                assert_eq!(text(&data.motion), text(&right.motion));
            }
        }
    }
    assert!(flagged > 50, "{flagged}");
}

#[test]
fn a_used_state_is_a_fresh_one_after_the_reset() {
    a_used_state_is_a_fresh_one::<f64>();
    a_used_state_is_a_fresh_one::<f32>();
}

/// Without a reset only what is remembered differs: with no dead time, a constant
/// posture and no level that holds that is the torque that acts and the observer, and
/// from the same torque and without the residual the demand has the same bits.
#[test]
fn without_a_reset_only_what_is_remembered_differs() {
    let large = controller::<f64>(&configuration(SPLITS[11].1));
    for (name, split) in &SPLITS[..11] {
        let small = controller::<f64>(&configuration(split));
        let (mut used, mut fresh) = (State::new(), State::new());
        for (measurement, reference) in inputs(&large, 80) {
            let _ = large.step(&mut used, &measurement, &reference);
        }
        let joints = JointState {
            q: used.data().joints.q * 0.9,
            dq: used.data().joints.dq,
        };
        let reference = Wish::random(&small, &joints, &mut States::new(81)).reference;
        let measurement = Measurement {
            q: joints.q,
            dq: joints.dq,
            interval_s: 0.002,
        };
        let steps = [&mut used, &mut fresh].map(|state| {
            state.set_applied_torque(&zeros());
            state.follow_at_once();
            small.step_with(state, &measurement, &reference, |_, _, data| {
                let (dynamics, hierarchy) = (&data.dynamics, &data.hierarchy);
                let none = JointVector::zeros();
                data.demand = TorqueDemand::compensating(dynamics, hierarchy, &data.control, &none);
            })
        });
        assert_eq!(steps[0].torque, steps[1].torque, "{name}");
        assert_ne!(steps[0].residual, steps[1].residual, "{name}");
        assert_eq!(steps[1].residual, JointVector::zeros());
    }
}

/// The same inputs from the same state give the same bits, in another state as in a
/// copy made half-way; the same input once more, without time for anything to change,
/// does so too.
#[test]
fn the_same_input_gives_the_same_bits() {
    for (index, config) in configurations().iter().enumerate() {
        let controller = controller::<f64>(config);
        let cycles = inputs(&controller, 90 + index as u64);
        let (mut one, mut two) = (State::new(), State::new());
        for (cycle, (measurement, reference)) in cycles.iter().enumerate() {
            // Each input twice in a row.
            for _ in 0..2 {
                let steps = [&mut one, &mut two]
                    .map(|state| controller.step(state, measurement, reference));
                assert_eq!(steps[0], steps[1]);
                assert_eq!(text(one.data()), text(two.data()));
            }
            if cycle == 2 {
                two = one.clone();
            }
        }
    }
    // Nothing remembered matters: twice the same input gives twice the same torque.
    let mut config = configuration(SPLITS[1].1);
    config.observer_gain = [1e-9; 7];
    let controller = controller::<f64>(&config);
    let (measurement, reference) = &inputs(&controller, 99)[0];
    let mut state = State::new();
    let [one, two] = [(); 2].map(|()| {
        let law = |_: &Controller<f64>, _: &Input<'_, f64>, data: &mut Data<f64>| {
            let (dynamics, hierarchy) = (&data.dynamics, &data.hierarchy);
            let none = JointVector::zeros();
            data.demand = TorqueDemand::compensating(dynamics, hierarchy, &data.control, &none);
        };
        state.follow_at_once();
        controller.step_with(&mut state, measurement, reference, law)
    });
    assert_eq!(one.torque, two.torque);
}
