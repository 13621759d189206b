//! The study of the law near limits: a part of it with its limits, its files, its command.

mod acceptance;
mod command;
mod distribution;
mod files;
mod published;
mod straight;

use cell::names::PlantKind;
use cell::scenario::EquippedArm;
use hil_sim::study::limits::jobs::{Plan, SetOutcome};
use hil_sim::study::limits::run::{Law, Precision};
use hil_sim::study::limits::set::Set;

/// The LWR on the ideal plant by the law within limits.
fn plan(sets: &[Set]) -> Plan {
    Plan {
        arm: EquippedArm::new("lwr_iv", None, None).expect("a table"),
        plant: PlantKind::Ideal,
        precision: Precision::F64,
        laws: vec![Law::WithinLimits],
        sets: sets.to_vec(),
        runs: None,
        jobs: std::thread::available_parallelism().map_or(1, usize::from),
        from: None,
    }
}

fn made(plan: &Plan) -> Vec<SetOutcome> {
    let outcomes = plan.run(|_, _| {}).expect("runs that can be");
    outcomes.expect("no signal")
}
