//! Scenarios near and beyond limits, one by one: files that `run` takes as well.

use cell::invalid::Invalid;
use cell::ranges::Range;
use cell::scenario::{LevelSpec, NEAR_LIMITS, ReferenceSpec, Scenario, Stroke};

use super::case::{Case, CaseLevel};
use crate::arm_points::origins;

/// Built-in scenarios that come to no limit, before those that do.
const FAR: [&str; 3] = ["two-level", "case-1", "case-2"];

/// Their number.
#[must_use]
pub fn count() -> usize {
    FAR.len() + NEAR_LIMITS.len()
}

/// The scenario `number` (from 0) without contacts.
///
/// # Errors
/// There are not so many.
pub fn case(number: usize) -> Result<Case, Invalid> {
    if let Some(name) = FAR.get(number) {
        return Ok(of_scenario(&Scenario::find(name)?));
    }
    let Some((name, text)) = NEAR_LIMITS.get(number - FAR.len()) else {
        let last = count() - 1;
        return Err(Invalid::new("run", number, Range::new(0, last)));
    };
    let scenario = Scenario::parse(text).map_err(|error| error.within(name))?;
    Ok(of_scenario(&scenario))
}

fn of_scenario(scenario: &Scenario) -> Case {
    let start = scenario.start();
    let arm = scenario.arm();
    let origins = origins(scenario, &start);
    let level = |(place, level): (usize, &LevelSpec)| CaseLevel {
        task: level.task(place, &arm),
        label: level.label(),
    };
    let levels = scenario.levels.iter().enumerate().map(level).collect();
    let case = Case {
        cycle_s: scenario.cycle_s(),
        ..Case::at_rest(scenario.name.clone(), &arm, start, levels)
    };
    let case = case.following(scenario.duration_s, |t_s| {
        let reference = scenario.reference(&origins, &start, t_s);
        reference.targets().to_vec()
    });
    let stroke = scenario.levels.iter().find_map(stroke);
    Case {
        back_at_s: stroke.map(|stroke| stroke.end_s()),
        hold_s: stroke.map(|stroke| resting(&stroke)),
        ..case
    }
}

fn stroke(level: &LevelSpec) -> Option<Stroke> {
    match &level.reference {
        ReferenceSpec::ThereAndBack(motion) => Some(motion.stroke()),
        _ => None,
    }
}

/// The second half of the rest at the far end.
fn resting(stroke: &Stroke) -> [f64; 2] {
    let end_s = stroke.from_s + stroke.duration_s + stroke.hold_s;
    [end_s - stroke.hold_s / 2.0, end_s]
}
