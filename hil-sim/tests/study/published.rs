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

/// Every arm has its rows, and those of one whose limit of the torque rate matters are made anew.
#[test]
fn arms_are_as_they_are_shown() {
    let all = published::arms_in_the_table();
    for (arm, remark) in &all {
        let shown = shown(&format!("| `{}`{remark} |", arm.name));
        assert_eq!(shown.lines().count(), 2, "{}{remark}", arm.name);
    }
    check_arms(|name, remark| name == "openarm_v20_left" && remark.is_empty());
    let free = all.iter().filter(|(_, remark)| !remark.is_empty());
    let names: Vec<_> = free.map(|(arm, _)| arm.name).collect();
    assert_eq!(names, ["panda", "panda_identified", "fr3"]);
}

#[test]
#[ignore = "minutes"]
fn every_arm_is_as_it_is_shown() {
    check_arms(|_, _| true);
}

/// Makes the rows of some arms anew.
fn check_arms(some: impl Fn(&str, &str) -> bool) {
    let all = published::arms_in_the_table();
    let some = all.iter().filter(|(arm, remark)| some(arm.name, remark));
    let mut made_anew = 0;
    for row @ (arm, remark) in some {
        let rows = published::arm(row, &plan(&[]), &made).expect("runs");
        assert_eq!(rows, shown(&format!("| `{}`{remark} |", arm.name)));
        made_anew += 1;
    }
    assert!(made_anew > 0, "no such arm");
}

/// Every set has its rows, and those of the smallest are made anew.
#[test]
fn laws_are_as_they_are_shown() {
    for set in Set::ALL.iter().map(|(_, set)| *set) {
        assert!(!shown_of(set).is_empty(), "{}", set.name());
    }
    check_laws(Set::Give);
}

#[test]
#[ignore = "minutes"]
fn smaller_sets_are_as_they_are_shown() {
    for set in [Set::Push, Set::Give, Set::Saturation] {
        check_laws(set);
    }
}

fn shown_of(set: Set) -> String {
    shown(&format!("| `{}` | ", set.name()))
}

/// Makes the rows of a set anew.
fn check_laws(set: Set) {
    let rows = published::set_by_laws(set, &plan(&[]), &made).expect("runs");
    let shown = shown_of(set);
    assert!(shown.contains(&rows), "{rows}\n{shown}");
}
