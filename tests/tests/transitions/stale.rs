//! References that get too old.

use arms::LWR_IV;
use cell::names::PlantKind;
use controller_core::task::{AfterStale, Stale};
use controller_core::{ControllerConfig, TaskSet};
use stratum_tests::config::{three_level, two_level};
use stratum_tests::oracle::closed_loop::{TWO_LEVEL_START, posture};

use super::run::{Run, on_circle};

const AGE_S: f64 = 0.1;

fn run(then: AfterStale) -> Run {
    let set = three_level().tasks;
    let [flange, wrist] = set.tasks() else {
        panic!("two tasks");
    };
    let mut wrist = *wrist;
    wrist.stale = Some(Stale { age_s: AGE_S, then });
    let config = ControllerConfig {
        tasks: TaskSet::new(&[*flange, wrist]).expect("two tasks"),
        ..two_level()
    };
    let start = posture(TWO_LEVEL_START);
    Run::new(&LWR_IV, &config, PlantKind::Ideal, start, 1)
}

/// Age of the reference of level 2.
fn age_s(t_s: f64) -> f64 {
    if (2.0..4.0).contains(&t_s) {
        t_s - 2.0
    } else {
        0.0
    }
}

/// The reference of level 2 ages from 2 s on and is fresh again from 4 s on. Returns for each
/// cycle whether it was stale, whether it was changing, and its rows.
fn course(then: AfterStale) -> (Run, Vec<(f64, bool, bool, usize)>) {
    let mut run = run(then);
    let origin = run.controller.rest_reference(&posture(TWO_LEVEL_START));
    let mut seen = Vec::new();
    for _ in 0..3500 {
        let t_s = run.t_s();
        let mut reference = origin.clone();
        reference.targets_mut()[0] = on_circle(&origin.targets()[0], t_s);
        reference.set_age(1, age_s(t_s));
        let status = run.cycle(&reference).status;
        assert_eq!(status.fault, None);
        let rows = run.state.data().rows.count();
        seen.push((
            t_s,
            status.stale.contains(1),
            status.changing.contains(1),
            rows,
        ));
    }
    (run, seen)
}

#[test]
fn it_holds_while_its_reference_is_stale() {
    let (run, seen) = course(AfterStale::Hold);
    for (t_s, stale, changing, rows) in seen {
        assert_eq!(stale, age_s(t_s) > AGE_S, "{t_s}");
        assert!(!changing && rows == 5, "{t_s}");
    }
    assert!(run.step < 2.5, "{} Nm at {} s", run.step, run.stepped_at_s);
}

#[test]
fn it_goes_while_its_reference_is_stale_and_comes_back() {
    let (run, seen) = course(AfterStale::Release);
    let rows_at = |t: f64| {
        seen.iter()
            .find(|(t_s, ..)| *t_s >= t)
            .map(|(.., rows)| *rows)
    };
    // 0.1 s until it is stale, 0.2 s to rest, 0.5 s to go.
    assert_eq!(rows_at(2.7), Some(5));
    assert_eq!(rows_at(2.9), Some(3));
    assert_eq!(rows_at(3.9), Some(3));
    assert_eq!(rows_at(4.1), Some(5));
    // Half a second to come, or somewhat more.
    let until = seen
        .iter()
        .filter(|(.., changing, _)| *changing)
        .map(|(t_s, ..)| *t_s);
    let until = until.fold(0.0, f64::max);
    assert!((4.4..4.7).contains(&until), "{until}");
    assert!(
        seen.iter()
            .all(|&(t_s, stale, ..)| stale == (age_s(t_s) > AGE_S))
    );
    let changes_at = |t: f64| {
        seen.iter()
            .any(|(t_s, _, changing, _)| *changing && *t_s > t)
    };
    assert!(changes_at(2.4) && !changes_at(4.6));
    assert!(run.step < 2.5, "{} Nm at {} s", run.step, run.stepped_at_s);
}

/// An age that is no number is no age.
#[test]
fn an_age_that_is_not_a_number_is_stale() {
    let mut run = run(AfterStale::Hold);
    let mut reference = run.controller.rest_reference(&posture(TWO_LEVEL_START));
    reference.set_age(1, f64::NAN);
    reference.set_age(99, 1.0);
    assert!(run.cycle(&reference).status.stale.contains(1));
}
