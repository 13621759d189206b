//! The built-in two-level scenarios with proposed gains.

use cell::names::{MeasurementKind, NullStiffness, PlantKind};
use cell::scenario::Scenario;
use controller_core::Controller;
use hil_sim::controllers::TorqueLaw;
use hil_sim::experiment::Experiment;
use hil_sim::gains::bounds::Cause;
use hil_sim::gains::link::{Departure, Link};
use hil_sim::gains::near_rest::NearRest;
use hil_sim::gains::proposal::{Request, hertz, propose};
use hil_sim::gains::sampled::transition;
use hil_sim::plant::PlantOptions;
use hil_sim::summary::{Summary, Verdict};

/// The scenarios, and what their arm is called in docs/gains.md.
const SCENARIOS: [(&str, &str); 4] = [
    ("two-level", "LWR IV+"),
    ("two-level-iiwa-14", "iiwa 14"),
    ("two-level-fr3", "FR3"),
    ("two-level-openarm", "OpenArm 2.0"),
];

/// A scenario with the gains that are proposed for its arm and cycle, and their bandwidths as
/// docs/gains.md has them: of positions and orientations with what bounds them, by the sampling,
/// of positions by the noise \[Hz\].
fn proposed(name: &str, departure: Departure) -> (Scenario, String) {
    let mut scenario = Scenario::find(name).expect("built in");
    let arm = scenario.arm().parameters;
    let request = Request {
        cycle_s: scenario.cycle_s(),
        bandwidth: None,
        departure,
    };
    let proposal = propose(&arm, request).unwrap_or_else(|refusal| panic!("{name}: {refusal}"));
    proposal.apply(&mut scenario);
    scenario.validate().expect("gains that a file may have");
    let [position, orientation] = proposal.levels.map(|level| {
        let [least, ..] = level.bounds;
        format!("{:.2} {}", hertz(level.bandwidth), least.cause.name())
    });
    let [sampling, noise] = [Cause::Sampling, Cause::Noise].map(|cause| {
        let mut bounds = proposal.levels[0].bounds.iter();
        let bound = bounds.find(|bound| bound.cause == cause).expect("a bound");
        hertz(bound.bandwidth)
    });
    let row = format!("{position} | {orientation} | {sampling:.2} | {noise:.2}");
    (scenario, row)
}

const AS_IT_IS: Departure = Departure {
    dead_cycles: None,
    elastic: false,
};

fn run(scenario: &Scenario, plant: PlantKind, seed: u64) -> Summary {
    let experiment = Experiment {
        options: PlantOptions::of(plant, &scenario.arm().parameters),
        scenario: scenario.clone(),
        plant,
        contacts: true,
        controller: TorqueLaw::Hierarchical.into(),
        null_stiffness: NullStiffness::Normal,
        measurement: MeasurementKind::Direct,
        seed,
    };
    let controller = experiment.controller().expect("gains that the core takes");
    let run = experiment.run(&controller, |_| Ok(()), |_| ());
    let run = run.expect("nothing is written");
    assert!(!run.acceptance.is_empty(), "{}", scenario.name);
    let name = &scenario.name;
    assert_eq!(
        run.verdict,
        Verdict::Pass,
        "{name}, seed {seed}: {:?}, {:?}",
        run.acceptance,
        run.reason
    );
    run
}

/// With elastic joints and dead time the gains of two-level-openarm are unstable, as the command
/// says of their bandwidth; those that it proposes then hold the arm on its circle.
#[test]
fn an_elastic_arm_with_dead_time_is_held_by_what_is_proposed_for_it() {
    let elastic = Departure {
        elastic: true,
        ..AS_IT_IS
    };
    let ended = |scenario: Scenario| {
        let options = PlantOptions {
            elasticity: true,
            ..PlantOptions::of(PlantKind::Realistic, &scenario.arm().parameters)
        };
        let experiment = Experiment {
            scenario,
            plant: PlantKind::Realistic,
            contacts: false,
            controller: TorqueLaw::Hierarchical.into(),
            null_stiffness: NullStiffness::Normal,
            measurement: MeasurementKind::Direct,
            seed: 1,
            options,
        };
        let controller = experiment.controller().expect("gains that the core takes");
        let run = experiment.run(&controller, |_| Ok(()), |_| ());
        run.expect("nothing is written")
    };
    let own = Scenario::find("two-level-openarm").expect("built in");
    let (proposed, _) = proposed("two-level-openarm", elastic);
    let radii = [&own, &proposed].map(|scenario| radius_at_start(scenario, elastic));
    assert!(radii[0] > 1.0 && radii[1] < 1.0, "{radii:?}");
    assert_eq!(ended(own).verdict, Verdict::Stopped);
    let run = ended(proposed);
    assert_ne!(run.verdict, Verdict::Stopped);
    println!(
        "OpenArm 2.0, elastic: radii {radii:.4?}, {:.3} mm rms",
        rms(&run)
    );
}

/// Spectral radius of the loop on the realistic arm where a scenario starts.
fn radius_at_start(scenario: &Scenario, departure: Departure) -> f64 {
    let arm = scenario.arm().parameters;
    let link = Link::realistic(&arm, scenario.cycle_s(), departure);
    let config = scenario.controller_config(link.timing.dead_cycles);
    let config = config.expect("levels that make a set");
    let controller = Controller::new(&arm, &config).expect("gains that the core takes");
    let (tasks, gain) = (config.tasks.tasks(), scenario.observer.gain);
    let near = NearRest::of(&arm, &controller, tasks, gain, &link, &scenario.start());
    let near = near.expect("a mass matrix");
    transition(&near.arm, &link.timing, &near.law).spectral_radius()
}

/// rms of the flange's error \[mm\].
fn rms(run: &Summary) -> f64 {
    run.levels[0].rms().expect("samples")
}

/// The arm whose loop has dead time and motor frames, and the one with the heaviest friction.
#[test]
fn two_arms_keep_the_limits_of_their_scenarios() {
    for name in ["two-level", "two-level-openarm"] {
        let (scenario, _) = proposed(name, AS_IT_IS);
        run(&scenario, PlantKind::Realistic, 1);
    }
}

/// All of them, as docs/gains.md has it.
#[test]
#[ignore = "minutes without --release"]
fn the_document_says_what_all_arms_reach() {
    let path = format!("{}/../docs/gains.md", env!("CARGO_MANIFEST_DIR"));
    let document = std::fs::read_to_string(path).expect("a document");
    let mut missing = Vec::new();
    for (name, arm) in SCENARIOS {
        let (scenario, bandwidths) = proposed(name, AS_IT_IS);
        let ideal = rms(&run(&scenario, PlantKind::Ideal, 1));
        let realistic = (1..=5).map(|seed| rms(&run(&scenario, PlantKind::Realistic, seed)));
        let worst = realistic.fold(0.0, f64::max);
        let row = format!("| {arm} | {ideal:.3} | {worst:.3} | {bandwidths} |");
        println!("{row}");
        if !document.contains(&row) {
            missing.push(row);
        }
    }
    assert!(missing.is_empty(), "docs/gains.md has to say {missing:#?}");
}
