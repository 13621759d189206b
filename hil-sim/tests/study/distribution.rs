//! The runs are drawn as they are said to be.

use std::collections::BTreeMap;

use cell::names::Named;
use hil_sim::study::limits::set::Set;

use crate::{made, plan};

/// Steps of torque \[Nm\] of all runs of each set, drawn and made by an independent program: law,
/// arm and draw. It has no limit of the torque rate, and pushes that are constant within a cycle.
const INDEPENDENT: &str = include_str!("steps.json");

/// Largest distance of the cumulative frequencies of two samples.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let share = |sample: &[f64], most: f64| {
        let count = sample.iter().filter(|&&value| value <= most).count();
        count as f64 / sample.len() as f64
    };
    let gaps = a
        .iter()
        .chain(b)
        .map(|&at| (share(a, at) - share(b, at)).abs());
    gaps.fold(0.0, f64::max)
}

/// Kolmogorov and Smirnov: two samples of n from one distribution are farther apart than
/// 1.63 (2/n)^1/2 once in a hundred times.
#[test]
fn steps_are_those_of_an_independent_draw() {
    let independent: BTreeMap<String, Vec<f64>> = serde_json::from_str(INDEPENDENT).unwrap();
    for outcome in made(&plan(&Set::IN_FILES)) {
        let steps: Vec<_> = outcome
            .within_limits
            .iter()
            .map(|run| run.step.nm)
            .collect();
        let others = &independent[outcome.set.name()];
        assert_eq!(steps.len(), others.len());
        let apart = distance(&steps, others);
        let allowed = 1.63 * (2.0 / steps.len() as f64).sqrt();
        assert!(
            apart < allowed,
            "{}: {apart}, {allowed}",
            outcome.set.name()
        );
    }
}

#[test]
fn runs_are_drawn_the_same_every_time_and_differ() {
    let runs = || {
        made(&hil_sim::study::limits::jobs::Plan {
            runs: Some(4),
            ..plan(&Set::IN_FILES)
        })
    };
    let (once, again) = (runs(), runs());
    for (a, b) in once.iter().zip(&again) {
        let steps = |of: &hil_sim::study::limits::jobs::SetOutcome| {
            of.within_limits
                .iter()
                .map(|run| run.step.nm)
                .collect::<Vec<_>>()
        };
        assert_eq!(steps(a), steps(b));
        assert!(steps(a).windows(2).all(|pair| pair[0] != pair[1]));
    }
}
