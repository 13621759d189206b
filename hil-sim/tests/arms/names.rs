//! Who reads of a joint finds the name that its maker gave it.

use cell::names::PlantKind;
use hil_sim::summary::Verdict;

use super::{arms, experiment, run};

#[test]
fn a_stopped_run_names_the_joint_as_its_maker_does() {
    // A push of 400 N at the elbow: first joints, and no arm keeps still.
    for (text, prefix) in arms().iter().zip(["joint", "A", "Actuator", "J"]) {
        let mut experiment = experiment(text, PlantKind::Ideal);
        for push in &mut experiment.scenario.pushes {
            push.force_n = push.force_n.map(|force| 40.0 * force);
        }
        let summary = run(&experiment);
        assert_eq!(summary.verdict, Verdict::Stopped, "{:?}", summary.reason);
        let reason = summary.reason.expect("why it stopped");
        let names = experiment.scenario.arm().joints();
        let joint = names.into_iter().find(|name| {
            let words = ["speed of", "speed [rad/s] of", "position [rad] of"];
            words
                .iter()
                .any(|word| reason.contains(&format!("{word} {name} is")))
        });
        let joint = joint.unwrap_or_else(|| panic!("{reason}"));
        assert!(joint.starts_with(prefix), "{reason}");
    }
}
