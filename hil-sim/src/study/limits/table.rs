//! Figures and acceptance for people.

use std::fmt::Write as _;

use cell::names::Named;

use super::acceptance::{Criterion, SMALL_STEP_NM, figures, percentile};
use super::jobs::SetOutcome;
use super::outcome::{LevelOutcome, Outcome};

/// Median, 95 % and largest over runs.
fn spread(values: &[f64]) -> String {
    if values.is_empty() {
        return String::new();
    }
    let [median, most, all] = [0.5, 0.95, 1.0].map(|share| brief(percentile(values, share)));
    format!("{median:>8} {most:>8} {all:>8}")
}

/// A number with three digits that say something.
pub(super) fn brief(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.1e}");
    }
    let whole = if size >= 1.0 {
        size.log10() as usize
    } else {
        0
    };
    format!("{value:.*}", 3usize.saturating_sub(whole))
}

type Figure = fn(&Outcome) -> f64;

/// Figures of every run, by name.
const FIGURES: [(&str, Figure); 7] = [
    ("torque step Nm", |run| run.step.nm),
    ("torque Nm", |run| run.torque_nm),
    ("speed, of its limit", |run| run.speed_share()),
    ("beyond a range deg", |run| run.beyond_deg),
    ("pivots", |run| f64::from(run.pivots)),
    ("null power, least W", |run| run.null_power_w[0]),
    ("null power, greatest W", |run| run.null_power_w[1]),
];

type LevelFigure = fn(&LevelOutcome) -> Option<f64>;

/// Figures of every level.
const LEVEL_FIGURES: [(&str, LevelFigure); 7] = [
    ("largest", |level| Some(level.max)),
    ("rms", |level| Some(level.rms)),
    ("far out", |level| level.hold),
    ("1 s after", |level| level.back),
    ("at the end", |level| Some(level.end)),
    ("disturbance m/s2", |level| Some(level.disturbance)),
    ("leak m/s2", |level| Some(level.leak)),
];

type Count = fn(&Outcome) -> bool;

/// Runs that are counted.
const COUNTS: [(&str, Count); 5] = [
    ("runs stopped", |run| run.stop.is_some()),
    ("runs with a large step", |run| run.step.nm > SMALL_STEP_NM),
    ("runs beyond a range", |run| run.beyond_deg > 0.0),
    ("runs above a speed limit", |run| run.speed_share() > 1.0),
    ("runs with a torque cut", |run| run.limited.saturated > 0),
];

type Cycles = fn(&Outcome) -> usize;

/// Cycles that are counted.
const CYCLES: [(&str, Cycles); 10] = [
    ("cycles degraded", |run| run.limited.degraded),
    ("cycles released", |run| run.limited.released),
    ("cycles shaped", |run| run.limited.shaped),
    ("cycles scaled", |run| run.limited.scaled),
    ("cycles bounded", |run| run.limited.bounded),
    ("cycles unresolved", |run| run.limited.unresolved),
    ("cycles stuck", |run| run.limited.stuck),
    ("cycles with a torque cut", |run| run.limited.saturated),
    ("cycles rate limited", |run| run.limited.torque_rate),
    ("cycles joining", |run| run.limited.joining),
];

/// A set as text: a row per figure, both laws side by side, then what is judged.
#[must_use]
pub fn table(of_set: &SetOutcome, criteria: &[Criterion]) -> String {
    let laws = [&of_set.exact, &of_set.within_limits];
    let count = laws.map(Vec::len).into_iter().max().unwrap_or(0);
    let mut text = format!("{}: {count} runs\n", of_set.set.name());
    let _ = writeln!(
        text,
        "{:<34} {:>26}   {:>26}",
        "median, 95 %, largest", "exact law", "law within limits"
    );
    let mut row = |name: &str, cells: [String; 2]| {
        let [exact, within] = cells;
        if !(exact.is_empty() && within.is_empty()) {
            let _ = writeln!(text, "{name:<34} {exact:>26}   {within:>26}");
        }
    };
    for (name, figure) in FIGURES {
        row(name, laws.map(|runs| spread(&figures(runs, figure))));
    }
    for index in 0..2 {
        for turns in [false, true] {
            let unit = if turns { "mrad" } else { "mm" };
            for (name, figure) in LEVEL_FIGURES {
                let of_level = |run: &Outcome| {
                    let level = run.levels.get(index).filter(|level| level.turns == turns);
                    level.and_then(figure)
                };
                let unit = if name.ends_with("m/s2") { "" } else { unit };
                let name = format!("level {} {name} {unit}", index + 1);
                let cell = |runs: &Vec<Outcome>| {
                    let values: Vec<_> = runs.iter().filter_map(of_level).collect();
                    spread(&values)
                };
                row(&name, laws.map(cell));
            }
        }
    }
    for (name, is) in COUNTS {
        let counted = |runs: &Vec<Outcome>| match runs.is_empty() {
            true => String::new(),
            false => runs.iter().filter(|run| is(run)).count().to_string(),
        };
        row(name, laws.map(counted));
    }
    for (name, cycles) in CYCLES {
        let share = |runs: &Vec<Outcome>| {
            let all: usize = runs.iter().map(|run| run.cycles).sum();
            let these: usize = runs.iter().map(cycles).sum();
            match runs.is_empty() {
                true => String::new(),
                false => format!("{these} of {all}"),
            }
        };
        row(name, laws.map(share));
    }
    text + &judged(criteria)
}

fn judged(criteria: &[Criterion]) -> String {
    let mut text = String::new();
    for criterion in criteria {
        let Criterion {
            what,
            value,
            allowed,
            met,
        } = criterion;
        let word = if *met { "met" } else { "NOT MET" };
        let value = brief(*value);
        let _ = writeln!(text, "  {what:<66} {value:>9}  {allowed:<16} {word}");
    }
    if criteria.is_empty() {
        text += "  nothing is judged under these conditions\n";
    }
    text
}

/// One row per run, for sets whose runs have names of their own.
#[must_use]
pub fn one_by_one(runs: &[Outcome]) -> String {
    let mut text = format!(
        "{:<28} {:>8} {:>8} {:>7} {:>9} {:>9} {:>9} {:>9}  {}\n",
        "run", "torque", "step Nm", "speed", "level 1", "far out", "end", "level 2", "at limits"
    );
    for run in runs {
        let first = &run.levels[0];
        let hold = first.hold.map_or("-".into(), brief);
        let second = run
            .levels
            .get(1)
            .map_or("-".into(), |level| brief(level.max));
        let stopped = run.stop.as_deref().map(|why| format!(", stopped at {why}"));
        let _ = writeln!(
            text,
            "{:<28} {:>8} {:>8} {:>7} {:>9} {:>9} {:>9} {:>9}  {} of {} cycles{}",
            run.run,
            brief(run.torque_nm),
            brief(run.step.nm),
            brief(run.speed_share()),
            brief(first.max),
            hold,
            brief(first.end),
            second,
            run.limited.any,
            run.cycles,
            stopped.unwrap_or_default()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_brief() {
        for (value, text) in [
            (0.0, "0.000"),
            (1.6543, "1.654"),
            (37.04, "37.04"),
            (7670.2, "7670"),
            (5.6e5, "5.6e5"),
            (-0.93, "-0.930"),
            (3.8e-8, "3.8e-8"),
        ] {
            assert_eq!(brief(value), text);
        }
    }
}
