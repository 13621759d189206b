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

/// Scenario files of arms of four makers.
const ARMS: [&str; 4] = [
    include_str!("fr3.toml"),
    include_str!("iiwa_14.toml"),
    include_str!("gen3.toml"),
    include_str!("openarm_v20_right.toml"),
];

/// A run of the product, with contacts.
fn experiment(text: &str, plant: PlantKind) -> Experiment {
    Experiment {
        scenario: Scenario::parse(text).expect("a valid scenario"),
        plant,
        contacts: true,
        controller: TorqueLaw::Hierarchical.into(),
        null_stiffness: NullStiffness::Normal,
        measurement: MeasurementKind::Direct,
        seed: 1,
        options: PlantOptions::default(),
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
    for text in ARMS {
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
                assert_eq!(
                    summary.acceptance.len(),
                    if judged { 2 } else { 0 },
                    "{what}"
                );
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

/// With stiction and elastic joints; rotors of the OpenArm are then behind the springs.
#[test]
fn other_arms_have_the_options_of_the_plant() {
    for text in ARMS {
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
