//! Scenarios of any arm, mounted and equipped as it is.

mod mount;
mod names;
mod tool;

use cell::names::{MeasurementKind, NullStiffness, PlantKind};
use cell::scenario::Scenario;
use hil_sim::controllers::TorqueLaw;
use hil_sim::experiment::Experiment;
use hil_sim::plant::PlantOptions;
use hil_sim::summary::{Summary, Verdict};

/// Scenarios of arms of four makers: those built in, and one of an arm of which nothing is known
/// but its table.
fn arms() -> [&'static str; 4] {
    let built_in = |name| Scenario::built_in_text(name).expect("built in");
    [
        built_in("two-level-fr3"),
        built_in("two-level-iiwa-14"),
        include_str!("gen3.toml"),
        built_in("two-level-openarm"),
    ]
}

/// A run of the product, with contacts.
fn experiment(text: &str, plant: PlantKind) -> Experiment {
    let scenario = Scenario::parse(text).expect("a valid scenario");
    Experiment {
        options: PlantOptions::of(plant, &scenario.arm().parameters),
        scenario,
        plant,
        contacts: true,
        controller: TorqueLaw::Hierarchical.into(),
        null_stiffness: NullStiffness::Normal,
        measurement: MeasurementKind::Direct,
        seed: 1,
    }
}

fn run(experiment: &Experiment) -> Summary {
    let controller = experiment.controller().expect("a controller");
    let summary = experiment.run(&controller, |_| Ok(()), |_| ());
    summary.expect("nothing is written")
}

/// Two-level with something at its end.
fn two_level(more: &str) -> String {
    let text = Scenario::built_in_text("two-level").expect("built in");
    format!("{text}\n{more}")
}

#[test]
fn arms_of_four_makers_track_while_they_are_pushed() {
    for text in arms() {
        for plant in [PlantKind::Ideal, PlantKind::Realistic] {
            let mut experiment = experiment(text, plant);
            for measurement in [MeasurementKind::Direct, MeasurementKind::Fri] {
                experiment.measurement = measurement;
                let summary = run(&experiment);
                let what = format!("{}, {plant:?}, {measurement:?}", summary.scenario);
                assert_eq!(
                    summary.verdict,
                    Verdict::Pass,
                    "{what}: {:?}",
                    summary.reason
                );
                let judged = measurement == MeasurementKind::Direct;
                let limits = if judged { 2 } else { 0 };
                assert_eq!(summary.acceptance.len(), limits, "{what}");
                let limits = summary.limits;
                let active = [limits.torque, limits.rank, limits.position];
                assert_eq!(active, [0; 3], "{what}");
                // The body gives way: the pushes are felt.
                let travel = summary.joints.range_deg.into_iter().fold(0.0, f64::max);
                assert!(travel > 10.0, "{what}: {travel}");
            }
        }
    }
}

/// With stiction and elastic joints; rotors and encoders of the OpenArm are then behind the springs.
/// Without its dead time, which the loop does not bear with springs.
#[test]
fn other_arms_have_the_options_of_the_plant() {
    for text in arms() {
        let mut experiment = experiment(text, PlantKind::Realistic);
        experiment.options = PlantOptions {
            stiction: true,
            elasticity: true,
            ..PlantOptions::default()
        };
        let summary = run(&experiment);
        assert_eq!(summary.verdict, Verdict::Pass, "{:?}", summary.reason);
    }
}
