//! A fifth of every set against the limits of the whole.

use cell::names::{Named, PlantKind};
use hil_sim::study::limits::acceptance::{Criterion, judge};
use hil_sim::study::limits::jobs::{Plan, SetOutcome};
use hil_sim::study::limits::run::{Law, Precision};
use hil_sim::study::limits::set::Set;

use crate::{made, plan};

/// The first fifth of a set under the conditions of `plan`.
fn fifth(set: Set, plan: &Plan) -> Plan {
    Plan {
        sets: vec![set],
        runs: Some(set.size().div_ceil(5)),
        ..plan.clone()
    }
}

fn missed(outcome: &SetOutcome, plan: &Plan) -> Vec<Criterion> {
    let criteria = judge(outcome, plan);
    assert!(!criteria.is_empty(), "{}", outcome.set.name());
    criteria
        .into_iter()
        .filter(|criterion| !criterion.met)
        .collect()
}

#[test]
fn drawn_runs_keep_the_limits() {
    for precision in [Precision::F64, Precision::F32] {
        for set in Set::IN_FILES {
            let plan = fifth(
                set,
                &Plan {
                    precision,
                    laws: vec![Law::Exact, Law::WithinLimits],
                    ..plan(&[])
                },
            );
            let missed = missed(&made(&plan)[0], &plan);
            assert!(missed.is_empty(), "{} {missed:?}", precision.name());
        }
    }
}

#[test]
fn single_runs_keep_the_limits() {
    for precision in [Precision::F64, Precision::F32] {
        let plan = Plan {
            precision,
            laws: vec![Law::Exact, Law::WithinLimits],
            ..plan(&[Set::Ordered, Set::Give, Set::Saturation])
        };
        for outcome in made(&plan) {
            let missed = missed(&outcome, &plan);
            assert!(missed.is_empty(), "{} {missed:?}", precision.name());
        }
    }
}

/// Friction, wrong masses and measured speeds take from the margins, and stop nothing.
#[test]
fn on_the_realistic_plant_no_run_is_stopped() {
    let realistic = Plan {
        plant: PlantKind::Realistic,
        ..plan(&[])
    };
    for set in Set::IN_FILES {
        for run in &made(&fifth(set, &realistic))[0].within_limits {
            assert_eq!(run.stop, None, "{}", run.run);
        }
    }
}

/// Runs start where the arm is: nothing has to be joined.
#[test]
fn references_are_followed_as_they_are() {
    let sets = [Set::Pass, Set::Wrist, Set::Random, Set::Push, Set::Ordered];
    for outcome in made(&Plan {
        runs: Some(12),
        ..plan(&sets)
    }) {
        for run in &outcome.within_limits {
            assert_eq!(run.limited.joining, 0, "{}", run.run);
        }
    }
}

/// Any arm: the exact law is stopped by what the law within limits passes through.
#[test]
fn other_arms_pass_too() {
    for arm in ["fr3", "openarm_v20_right"] {
        let arm = cell::scenario::EquippedArm::new(arm, None, None).expect("a table");
        let plan = Plan {
            arm,
            laws: vec![Law::Exact, Law::WithinLimits],
            runs: Some(12),
            ..plan(&[Set::Pass])
        };
        let outcome = &made(&plan)[0];
        assert!(outcome.exact.iter().any(|run| run.stop.is_some()));
        for run in &outcome.within_limits {
            assert_eq!(run.stop, None, "{}", run.run);
            assert!(run.beyond_deg < 0.0, "{}: {}", run.run, run.beyond_deg);
        }
    }
}

/// What a limit is about is what breaks it.
#[test]
fn a_worse_run_is_not_accepted() {
    let plan = fifth(
        Set::Random,
        &Plan {
            runs: Some(2),
            ..plan(&[])
        },
    );
    let plan = Plan {
        runs: Some(2),
        ..plan
    };
    let good = &made(&plan)[0];
    let worse = |spoil: fn(&mut hil_sim::study::limits::outcome::Outcome)| {
        let mut bad = good.clone();
        bad.within_limits.iter_mut().for_each(spoil);
        let missed: Vec<_> = missed(&bad, &plan).into_iter().map(|c| c.what).collect();
        missed.join("; ")
    };
    let fine = worse(|_| {});
    for (what, missed) in [
        (
            "runs stopped",
            worse(|run| run.stop = Some("a fault".into())),
        ),
        ("runs beyond a range", worse(|run| run.beyond_deg = 0.1)),
        ("speed, of its limit", worse(|run| run.speed_share = 1.1)),
        ("torque step Nm, largest", worse(|run| run.step.nm = 40.0)),
        (
            "cycles with a torque cut",
            worse(|run| run.limited.saturated = 1),
        ),
        ("cycles unresolved", worse(|run| run.limited.unresolved = 1)),
    ] {
        assert!(
            missed.contains(what) && !fine.contains(what),
            "{what}: {missed}"
        );
    }
}
