//! What the plant can do beyond the reference: dead time, stiction, elastic
//! joints, finer integration; and the two-level experiment on top of each.

use std::time::Instant;

use arms::LWR_IV;
use cell::names::PlantKind;
use cell::scenario::Scenario;
use controller_core::joint::{DOF, JointState, JointVector};
use controller_core::ranges::DEAD_CYCLES_MAX;
use controller_core::{Controller, Measurement, State, Target};
use hil_sim::arm_points::origins;
use hil_sim::contact::Contacts;
use hil_sim::plant::actuators::Actuators;
use hil_sim::plant::friction::FrictionLaw;
use hil_sim::plant::{Plant, PlantModel, PlantOptions};

const CYCLE: f64 = 0.002;
const START: [f64; DOF] = [0.2, 0.6, -0.3, -1.4, 0.4, 0.9, 0.1];
const KINDS: [PlantKind; 2] = [PlantKind::Ideal, PlantKind::Realistic];

const REFERENCE: PlantOptions = PlantOptions {
    stiction: false,
    elasticity: false,
    dead_cycles: 0,
    substeps_factor: 0,
};
const STICTION: PlantOptions = PlantOptions {
    stiction: true,
    ..REFERENCE
};
const ELASTICITY: PlantOptions = PlantOptions {
    elasticity: true,
    ..REFERENCE
};

fn dead(dead_cycles: usize) -> PlantOptions {
    PlantOptions {
        dead_cycles,
        ..REFERENCE
    }
}

fn finer(options: PlantOptions, substeps_factor: usize) -> PlantOptions {
    PlantOptions {
        substeps_factor,
        ..options
    }
}

fn plant(kind: PlantKind, options: PlantOptions) -> Plant {
    Plant::with_options(kind, &LWR_IV, START.into(), CYCLE, 7, options)
}

fn no_contact(_: f64, _: &PlantModel, _: &JointState<f64>) -> JointVector<f64> {
    JointVector::zeros()
}

/// 0.2 s under a torque that depends on the measurement, with a contact.
fn short_run(mut plant: Plant) -> JointState<f64> {
    let push = JointVector::from([3.0, -20.0, 1.0, 12.0, 0.5, -0.3, 0.08]);
    for n in 0..100 {
        let torque = push - plant.measure().dq * 0.01;
        plant.advance(f64::from(n) * CYCLE, &torque, |t, _, state| state.q * t);
    }
    *plant.state()
}

/// The numbers are those of an arm that moves by the articulated-body algorithm. Rounding is
/// another one: some units in the last place of the accelerations, which the lightest joint, at
/// 68 rad/s, adds up over the run.
#[test]
fn without_options_the_plant_is_the_reference_to_the_last_bit() {
    let pinned = [
        [
            [
                0.14557363832061537,
                0.7718074303605162,
                -0.16177914690099798,
                -1.2106640352834424,
                1.8889583905742051,
                -0.020244256358509363,
                4.006243169344262,
            ],
            [
                -0.3411818191710323,
                1.9423441829933206,
                1.0839140712380724,
                2.22244159561344,
                13.910578523486718,
                -9.018450391934993,
                67.81136433524044,
            ],
        ],
        [
            [
                0.20060464423856303,
                0.7266400008543192,
                -0.2522335950929666,
                -1.3002219399592945,
                0.7466364109715665,
                0.8936048113463113,
                0.5127414646833146,
            ],
            [
                0.0073355999119989156,
                1.3248589761908274,
                0.46350373255488075,
                1.0965111466152548,
                2.2322395782769417,
                -0.004091852653329084,
                4.331335285446564,
            ],
        ],
    ];
    for (kind, [q, dq]) in KINDS.into_iter().zip(pinned) {
        let expected = JointState {
            q: q.into(),
            dq: dq.into(),
        };
        let by_new = Plant::new(kind, &LWR_IV, START.into(), CYCLE, 7);
        let reference = short_run(by_new);
        assert!((reference.q - expected.q).amax() < 1e-13);
        assert!((reference.dq - expected.dq).amax() < 1e-12);
        for factor in [0, 1] {
            assert_eq!(short_run(plant(kind, finer(REFERENCE, factor))), reference);
        }
    }
}

#[test]
fn options_change_what_they_should() {
    let realistic = short_run(plant(PlantKind::Realistic, REFERENCE));
    for options in [STICTION, ELASTICITY, dead(1), finer(REFERENCE, 2)] {
        assert_ne!(
            short_run(plant(PlantKind::Realistic, options)),
            realistic,
            "{options:?}"
        );
        // The same run again has the same bits.
        assert_eq!(
            short_run(plant(PlantKind::Realistic, options)),
            short_run(plant(PlantKind::Realistic, options))
        );
    }
    let ideal = short_run(plant(PlantKind::Ideal, REFERENCE));
    for options in [STICTION, ELASTICITY] {
        assert_eq!(short_run(plant(PlantKind::Ideal, options)), ideal);
    }
    for options in [dead(1), finer(REFERENCE, 2)] {
        assert_ne!(short_run(plant(PlantKind::Ideal, options)), ideal);
    }
}

#[test]
fn dead_time_delays_the_torque_and_holds_the_arm_until_it_arrives() {
    let hold = PlantModel::new(&LWR_IV).gravity_torque(&START.into());
    let command = |n: usize| hold + JointVector::repeat(0.03 * n as f64);
    for kind in KINDS {
        for cycles in 0..=usize::from(DEAD_CYCLES_MAX) {
            let (mut late, mut prompt) = (plant(kind, dead(cycles)), plant(kind, REFERENCE));
            for n in 0..30_usize {
                let t = n as f64 * CYCLE;
                let arrives = n.checked_sub(cycles).map_or(hold, command);
                late.advance(t, &command(n), no_contact);
                prompt.advance(t, &arrives, no_contact);
                assert_eq!(late.state(), prompt.state());
                if kind == PlantKind::Ideal && n < cycles {
                    // Holding and weight cancel but for rounding: 1e-14 Nm
                    // on joint 7, of 1.5e-4 kg m2, for 16 ms at most.
                    assert!(late.state().dq.amax() < 1e-9);
                }
            }
        }
    }
}

#[test]
fn a_held_arm_with_stiction_does_not_move_at_all() {
    // Off balance by a third of the sliding level; torque noise comes on top.
    let mut plant = plant(PlantKind::Realistic, STICTION);
    let start = *plant.state();
    let offset = FrictionLaw::of(&LWR_IV).coulomb / 3.0;
    let torque = plant.model().gravity_torque(&start.q) + offset;
    let reading = plant.measure();
    for n in 0..1000 {
        plant.advance(f64::from(n) * CYCLE, &torque, no_contact);
        assert_eq!(*plant.state(), start);
        assert_eq!(plant.measure(), reading);
    }
}

#[test]
fn elastic_joints_yield_by_load_over_stiffness() {
    let mut plant = plant(PlantKind::Realistic, ELASTICITY);
    let deflection = |plant: &Plant| plant.motors().expect("elastic").q - plant.state().q;
    let expected = |plant: &Plant, q: &JointVector<f64>| {
        let load = plant.model().gravity_torque(q);
        load.component_div(&Actuators::of(&LWR_IV).stiffness)
    };
    // At the start exactly, up to the rounding of an angle.
    let start = START.into();
    assert!((deflection(&plant) - expected(&plant, &start)).amax() < 1e-15);
    assert!(deflection(&plant).amax() > 3e-3);

    // A quarter of a radian away, brought there and held by a joint controller.
    let goal = JointVector::from(START).add_scalar(0.25);
    let stiffness = JointVector::from([300.0, 300.0, 150.0, 150.0, 30.0, 20.0, 3.0]);
    let mut mean = JointVector::zeros();
    const SETTLE: u32 = 3000;
    const AVERAGE: u32 = 2000;
    for n in 0..SETTLE + AVERAGE {
        let JointState { q, dq } = plant.measure();
        let weight = plant.model().gravity_torque(&q);
        let torque =
            weight + (goal - q).component_mul(&stiffness) - dq.component_mul(&(stiffness * 0.1));
        plant.advance(f64::from(n) * CYCLE, &torque, no_contact);
        if n >= SETTLE {
            let error = deflection(&plant) - expected(&plant, &plant.state().q);
            mean += error / f64::from(AVERAGE);
        }
    }
    assert!((plant.state().q - goal).amax() < 0.02);
    // Torque noise of 0.1 Nm moves a spring by 1e-5 rad, the mean by far less.
    assert!(mean.amax() < 1e-5, "{mean}");
}

/// Figures of one run of the two-level experiment.
struct Figures {
    rms_mm: f64,
    max_mm: f64,
}

/// The two-level experiment with its pushes, for its 20 s.
fn two_level(kind: PlantKind, seed: u64, options: PlantOptions) -> Figures {
    let clock = Instant::now();
    let scenario = Scenario::find("two-level").expect("built in");
    let config = scenario.controller_config(options.dead_cycles as u8);
    let config = config.expect("levels that make a set");
    let controller =
        Controller::new(&scenario.arm().parameters, &config).expect("a valid configuration");
    let (cycle_s, cycles) = (scenario.cycle_s(), scenario.cycles());
    let (origins, mut contacts) = (
        origins(&scenario, &scenario.start()),
        Contacts::of(&scenario),
    );
    let (equipped, start) = (scenario.arm(), scenario.start());
    let arm = &equipped.parameters;
    let mut state = State::new();
    let mut plant = Plant::with_options(kind, arm, start, cycle_s, seed, options);
    let point = scenario.levels[0].point.resolve(&equipped);
    let (mut squares, mut max_mm) = (0.0, 0.0f64);
    for cycle in 0..cycles {
        let t_s = cycle as f64 * cycle_s;
        let truth = *plant.state();
        let JointState { q, dq } = plant.measure();
        let measurement = Measurement {
            q,
            dq,
            interval_s: cycle_s,
        };
        let reference = scenario.reference(&origins, &scenario.start(), t_s);
        let step = controller.step(&mut state, &measurement, &reference);
        assert_eq!(step.status.fault, None, "{options:?} at {t_s} s");
        let offset = point.offset.into();
        let (x, _) = plant.model().point(&truth, point.link.number(), &offset);
        let Target::Position { x: desired, .. } = reference.targets()[0] else {
            panic!("a position level");
        };
        let error_mm = (desired - x).norm() * 1e3;
        squares += error_mm * error_mm;
        max_mm = max_mm.max(error_mm);
        contacts.take_hold(t_s, plant.model(), &truth);
        plant.advance(t_s, &step.torque, |t, model, state| {
            contacts.joint_torque(t, model, state).0
        });
    }
    let rms_mm = (squares / cycles as f64).sqrt();
    println!(
        "{kind:?} seed {seed} {options:?}: rms {rms_mm:.4} mm, max {max_mm:.3} mm, {:.2} s",
        clock.elapsed().as_secs_f64()
    );
    Figures { rms_mm, max_mm }
}

/// Largest relative change of the rms when the steps become 2 and 4 times finer.
fn integration_error(kind: PlantKind, seed: u64, options: PlantOptions) -> f64 {
    let reference = two_level(kind, seed, options).rms_mm;
    [2, 4]
        .map(|factor| {
            let fine = two_level(kind, seed, finer(options, factor)).rms_mm;
            (fine / reference - 1.0).abs()
        })
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn the_integration_error_is_far_below_the_figures() {
    // 1 % of the rms is below the differences between seeds by a factor of five.
    // Noise is drawn per cycle and so the same at every step length.
    for seed in 1..=3 {
        let error = integration_error(PlantKind::Realistic, seed, REFERENCE);
        println!("realistic, seed {seed}: {:.3} %", error * 100.0);
        assert!(error < 1e-2, "{error}");
    }
    for options in [STICTION, ELASTICITY] {
        let error = integration_error(PlantKind::Realistic, 1, options);
        println!("{options:?}: {:.3} %", error * 100.0);
        assert!(error < 1e-2, "{error}");
    }
    // The ideal plant is integrated with order four: h^4 of a motion of some
    // rad/s, 1e-11, and rounding.
    let error = integration_error(PlantKind::Ideal, 1, REFERENCE);
    println!("ideal: {error:e}");
    assert!(error < 1e-8, "{error}");
}

#[test]
fn the_loop_bears_every_option() {
    let all = PlantOptions {
        elasticity: true,
        ..STICTION
    };
    for seed in 1..=2 {
        let reference = two_level(PlantKind::Realistic, seed, REFERENCE);
        for options in [STICTION, ELASTICITY, all, dead(1)] {
            let with = two_level(PlantKind::Realistic, seed, options);
            // A loop near its border would show at once: an oscillation at the
            // resonance has the size of the speed limits, not of the error.
            assert!(with.rms_mm < 1.5 * reference.rms_mm, "{options:?}");
            assert!(with.max_mm < 2.0 * reference.max_mm, "{options:?}");
        }
    }
    assert!(two_level(PlantKind::Ideal, 1, dead(1)).rms_mm < 0.25);
}
