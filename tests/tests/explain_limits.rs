//! `explain` of cycles of runs that met limits: the torque of the cycle comes again in every bit,
//! with what the cycle said of its limits.

use cell::names::{MeasurementKind, NullStiffness, PlantKind};
use cell::scenario::{NEAR_LIMITS, Scenario};
use controller_core::joint::DOF;
use hil_sim::controllers::TorqueLaw;
use hil_sim::experiment::Experiment;
use hil_sim::explain::{Output, WithinLimits, explain, state_at};
use hil_sim::plant::PlantOptions;
use record::run::Sample;

fn experiment(name: &str, plant: PlantKind, dead_cycles: usize) -> Experiment {
    let near = NEAR_LIMITS.iter().find(|(known, _)| *known == name);
    let scenario = match near {
        Some((_, text)) => Scenario::parse(text),
        None => Scenario::find(name),
    };
    Experiment {
        scenario: scenario.expect(name),
        plant,
        contacts: true,
        controller: TorqueLaw::Hierarchical.into(),
        null_stiffness: NullStiffness::Normal,
        measurement: MeasurementKind::Direct,
        seed: 1,
        options: PlantOptions {
            dead_cycles,
            ..PlantOptions::default()
        },
    }
}

fn cycles(experiment: &Experiment) -> Vec<Sample> {
    let controller = experiment.controller().expect("a controller");
    let mut all = Vec::new();
    let sink = |sample: &Sample| {
        all.push(sample.clone());
        Ok(())
    };
    experiment.run(&controller, sink, |_| ()).expect("a run");
    all
}

/// The first cycle, one with most exchanges, and one of each kind of limit, in its middle.
fn of_interest(cycles: &[Sample]) -> Vec<&Sample> {
    let status = |sample: &Sample| {
        sample
            .limits
            .as_ref()
            .expect("the law within limits")
            .status
    };
    let kinds: [fn(&controller_core::fault::Status) -> bool; 6] = [
        |status| status.at_least.any(),
        |status| status.at_greatest.any(),
        |status| status.released.any() && !status.stuck.any(),
        |status| status.stuck.any(),
        |status| status.shaped.any(),
        |status| status.scaled.any(),
    ];
    let most = cycles.iter().max_by_key(|sample| status(sample).pivots);
    let mut chosen: Vec<_> = cycles.first().into_iter().chain(most).collect();
    for kind in kinds {
        let met: Vec<_> = cycles
            .iter()
            .filter(|sample| kind(&status(sample)))
            .collect();
        chosen.extend(met.get(met.len() / 2));
    }
    // Of what has no flag, such as an arm that is being bent, whatever comes by: twice a second.
    chosen.extend(cycles.iter().step_by(250));
    chosen
}

fn explained(experiment: &Experiment, sample: &Sample) -> (Output, WithinLimits) {
    let state = state_at(experiment, sample.t_s).expect("a cycle of the run");
    let output = explain(&state).expect("a state");
    let within = output.within_limits.clone().expect("the law within limits");
    (output, within)
}

/// tau = M a + C dq + g - r, by the matrices that `explain` shows.
fn torque_of(output: &Output, within: &WithinLimits) -> [f64; DOF] {
    std::array::from_fn(|i| {
        let row = output.mass_matrix[i].iter().zip(&within.joints);
        let inertial: f64 = row.map(|(m, joint)| m * joint.acceleration).sum();
        inertial + output.coriolis[i] + output.gravity[i] - output.residual[i]
    })
}

#[test]
fn cycles_at_limits_come_again() {
    let (mut compared, mut at_bound, mut bent) = (0, 0, 0);
    for (name, plant, dead_cycles) in [
        ("fast-30-beyond-wrist", PlantKind::Ideal, 0),
        ("fast-30-beyond-wrist", PlantKind::Realistic, 1),
        ("reach-30-beyond-orientation", PlantKind::Realistic, 0),
        ("straight-back-orientation", PlantKind::Ideal, 0),
        ("two-level", PlantKind::Realistic, 0),
    ] {
        let mut experiment = experiment(name, plant, dead_cycles);
        // Behind that nothing new comes.
        experiment.scenario.duration_s = experiment.scenario.duration_s.min(6.0);
        let cycles = cycles(&experiment);
        for sample in of_interest(&cycles) {
            let (output, within) = explained(&experiment, sample);
            let place = format!("{name} {plant:?} at {}", sample.t_s);
            assert_eq!(output.torque, sample.torque.as_slice(), "{place}");
            assert_eq!(output.residual, sample.residual.as_slice(), "{place}");

            let limits = sample.limits.as_ref().expect("the law within limits");
            assert_eq!(within.exchanges, limits.status.pivots, "{place}");
            assert_eq!(within.unresolved, limits.status.unresolved, "{place}");
            assert_eq!(within.null_space.share, limits.null_share, "{place}");
            assert_eq!(within.null_space.power, limits.null_power, "{place}");
            for (number, (level, shown)) in within.levels.iter().zip(&sample.levels).enumerate() {
                assert_eq!(level.share, shown.share, "{place}");
                assert_eq!(level.disturbance, shown.disturbance, "{place}");
                assert_eq!(level.leak, shown.leak, "{place}");
                for (name, set) in [
                    ("degraded", limits.status.degraded),
                    ("released", limits.status.released),
                    ("shaped", limits.status.shaped),
                    ("scaled", limits.status.scaled),
                    ("stuck", limits.status.stuck),
                ] {
                    assert_eq!(level.met.contains(&name), set.contains(number), "{place}");
                }
            }
            for (joint, shown) in within.joints.iter().enumerate() {
                assert_eq!(shown.at_bound, limits.at_bound(joint), "{place}");
                assert!(shown.acceleration >= shown.least && shown.acceleration <= shown.greatest);
                at_bound += usize::from(shown.at_bound != 0);
            }
            for (demand, expected) in output.torque_demand.iter().zip(torque_of(&output, &within)) {
                // M is up to 5 kg m2, a up to 200 rad/s2: 1e3 Nm in double precision.
                assert!(
                    (demand - expected).abs() < 1e-10,
                    "{place} {demand} {expected}"
                );
            }
            bent += usize::from(within.way_out.iter().any(|&a| a != 0.0));
            compared += 1;
        }
    }
    println!("{compared} cycles, {at_bound} joints at bounds, {bent} arms bent");
    assert!(compared > 25 && at_bound > 10 && bent > 0);
}

/// Where nothing is released a direction is driven with 1/z and kept to itself.
#[test]
fn directions_of_a_level_that_is_clear_are_whole() {
    let experiment = experiment("two-level", PlantKind::Ideal, 0);
    let state = state_at(&experiment, 0.5).expect("a cycle");
    let output = explain(&state).expect("a state");
    let within = output.within_limits.expect("the law within limits");
    for direction in &within.levels[0].directions {
        assert!((direction.driven - 1.0).abs() < 1e-14 && (direction.kept - 1.0).abs() < 1e-14);
    }
    assert!(within.levels[0].met.is_empty());
    assert_eq!(within.null_space.release, 0.0);
    // One lambda: the mobilities are the eigenvalues of its inverse.
    let trace: f64 = within.levels[0].directions.iter().map(|d| d.mobility).sum();
    let lambda = controller_core::joint::Matrix3::from_fn(|i, j| output.levels[0].lambda[i][j]);
    let inverse = lambda.try_inverse().expect("regular");
    assert!((inverse.trace() / trace - 1.0).abs() < 1e-9, "{trace}");
}

#[test]
fn what_cannot_be_used_is_named() {
    let experiment = experiment("two-level", PlantKind::Ideal, 0);
    let error = state_at(&experiment, 30.0)
        .expect_err("too late")
        .to_string();
    assert_eq!(
        error,
        "--state-at: 30; allowed: a cycle of the run: 0 to 20"
    );
    let fri = Experiment {
        measurement: MeasurementKind::LikeFri,
        ..experiment.clone()
    };
    let error = state_at(&fri, 0.5)
        .expect_err("estimated speeds")
        .to_string();
    assert!(error.contains("--measurement direct"), "{error}");

    let state = state_at(&experiment, 0.1).expect("a cycle");
    for (from, to, said) in [
        (
            "\"disturbance\": [\n      0.0\n    ]",
            "\"disturbance\": [0, 0]",
            "before: disturbance: 2 values; allowed: at most 1, one per level",
        ),
        (
            "\"law\": \"within-limits\"",
            "\"law\": \"within-limits\", \"controller\": \"literal\"",
            "law: within-limits; allowed: exact with a controller other than hierarchical",
        ),
        (
            "\"cycle_ms\": 2.0",
            "\"cycle_ms\": 50",
            "cycle_ms: 50; allowed: 0.1 to 20",
        ),
        (
            "\"dead_cycles\": 0",
            "\"dead_cycles\": 9",
            "dead_cycles: 9; allowed: 0 to 8",
        ),
    ] {
        assert!(state.contains(from), "{from} {state}");
        let error = explain(&state.replace(from, to)).expect_err(to).to_string();
        assert!(error.contains(said), "{error}");
    }
}
