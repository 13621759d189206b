//! The tables of docs/limits-study.md are what the study gives.

use cell::names::Named;
use hil_sim::study::limits::published;
use hil_sim::study::limits::set::Set;

use crate::plan;

const DOCUMENT: &str = include_str!("../../../docs/limits-study.md");

/// Rows of the document that begin like this.
fn shown(start: &str) -> String {
    let rows = DOCUMENT.lines().filter(|line| line.starts_with(start));
    rows.map(|row| format!("{row}\n")).collect()
}

fn made(
    plan: &hil_sim::study::limits::jobs::Plan,
) -> Result<Vec<hil_sim::study::limits::jobs::SetOutcome>, cell::invalid::Invalid> {
    Ok(crate::made(plan))
}

/// Every arm has its rows, and those of some arms are made anew: one without, one with a limit of the
/// torque rate that matters.
#[test]
fn arms_are_as_they_are_shown() {
    let all = published::arms_in_the_table();
    for row @ (arm, remark) in &all {
        let shown = shown(&format!("| `{}`{remark} |", arm.name));
        assert_eq!(shown.lines().count(), 2, "{}{remark}", arm.name);
        if ["fr3", "openarm_v20_left"].contains(&arm.name) && remark.is_empty() {
            let rows = published::arm(row, &plan(&[]), &made).expect("runs");
            assert_eq!(rows, shown);
        }
    }
    let free = all.iter().filter(|(_, remark)| !remark.is_empty());
    let names: Vec<_> = free.map(|(arm, _)| arm.name).collect();
    assert_eq!(names, ["panda", "panda_identified", "fr3"]);
}

/// Every set has its rows, and those of the smaller ones are made anew.
#[test]
fn laws_are_as_they_are_shown() {
    for set in Set::ALL.iter().map(|(_, set)| *set) {
        let shown = shown(&format!("| `{}` | ", set.name()));
        assert!(!shown.is_empty(), "{}", set.name());
        if [Set::Push, Set::Give, Set::Saturation].contains(&set) {
            let rows = published::set_by_laws(set, &plan(&[]), &made).expect("runs");
            assert!(shown.contains(&rows), "{rows}\n{shown}");
        }
    }
}
