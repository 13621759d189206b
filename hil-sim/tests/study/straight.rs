//! Straight arms as scenario files.

use cell::names::{MeasurementKind, NullStiffness, PlantKind};
use cell::scenario::{NEAR_LIMITS, Scenario};
use hil_sim::controllers::TorqueLaw;
use hil_sim::experiment::Experiment;
use hil_sim::plant::PlantOptions;
use hil_sim::summary::Verdict;

/// They keep the limits of their files, at least one on either plant.
#[test]
fn straight_arms_keep_what_their_files_say() {
    let files = NEAR_LIMITS
        .iter()
        .filter(|(name, _)| name.contains("back") && !name.contains("beyond"));
    assert_eq!(files.clone().count(), 5);
    for (name, text) in files {
        for plant in [PlantKind::Ideal, PlantKind::Realistic] {
            let experiment = Experiment {
                scenario: Scenario::parse(text).expect(name),
                plant,
                contacts: true,
                controller: TorqueLaw::Hierarchical.into(),
                null_stiffness: NullStiffness::Normal,
                measurement: MeasurementKind::Direct,
                seed: 1,
                options: PlantOptions::default(),
            };
            let controller = experiment.controller().expect(name);
            let summary = experiment.run(&controller, |_| Ok(()), |_| ());
            let summary = summary.expect("no sink that fails");
            assert!(!summary.acceptance.is_empty(), "{name}");
            assert_eq!(
                summary.verdict,
                Verdict::Pass,
                "{name} {:?}",
                summary.reason
            );
        }
    }
}
