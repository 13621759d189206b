//! The tables of docs/limits-study.md, as Markdown.
//!
//! - [`arms()`]: passes and motions of every arm by the law within limits;
//! - [`laws`]: every figure that is judged, of both laws, plants and precisions;
//! - [`speeds`]: which joints of the LWR exceed their speed limits on the realistic plant.

use std::fmt::Write as _;

use cell::arm::robot::Robot;
use cell::invalid::Invalid;
use cell::names::{Named, PlantKind};
use cell::scenario::EquippedArm;
use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::law::limits::joint_limits;

use super::acceptance::{Criterion, figures, judge, percentile};
use super::jobs::{Plan, SetOutcome};
use super::outcome::Outcome;
use super::run::{Law, Precision};
use super::set::Set;
use super::table::brief;

/// What the rows are made under, but for what they are about.
pub type Made<'a> = &'a dyn Fn(&Plan) -> Result<Vec<SetOutcome>, Invalid>;

/// Plants and precisions, in the order of the columns.
const CONDITIONS: [(PlantKind, Precision); 4] = [
    (PlantKind::Ideal, Precision::F64),
    (PlantKind::Ideal, Precision::F32),
    (PlantKind::Realistic, Precision::F64),
    (PlantKind::Realistic, Precision::F32),
];

/// A torque rate as good as none \[Nm/s\]; the cycle of the runs \[s\].
const NO_RATE: f64 = 1e5;
const CYCLE_S: f64 = 0.002;

const ARMS_HEAD: &str = "\
| arm | runs | stopped | torque step Nm | of the largest torque | cycles rate limited | speed, of its limit | above it | beyond a range | level 1 not back in 1 s |
|---|---|---|---|---|---|---|---|---|---|
";

/// Every arm there is a table of.
///
/// # Errors
/// A run that cannot be.
pub fn arms(plan: &Plan, made: Made<'_>) -> Result<String, Invalid> {
    let mut text = String::from(ARMS_HEAD);
    for table in arms_in_the_table() {
        text += &arm(&table, plan, made)?;
    }
    Ok(text)
}

/// As in the tables; once more without limit of the torque rate where that makes other limits of
/// the joints.
#[must_use]
pub fn arms_in_the_table() -> Vec<(ArmParameters, &'static str)> {
    let limits = |arm: &ArmParameters| {
        let model = ArmModel::<f64>::new(arm).ok()?;
        Some(joint_limits(arm, &model, CYCLE_S, 0))
    };
    let mut all = Vec::new();
    for name in Robot::names() {
        let Ok(arm) = EquippedArm::new(name, None, None) else {
            continue;
        };
        let mut free = arm.parameters;
        for link in &mut free.links {
            link.torque_rate_limit = NO_RATE;
        }
        all.push((arm.parameters, ""));
        if limits(&free) != limits(&arm.parameters) {
            all.push((free, ", torque rate free"));
        }
    }
    all
}

/// The rows of one arm.
///
/// # Errors
/// A run that cannot be.
pub fn arm(
    (table, remark): &(ArmParameters, &str),
    plan: &Plan,
    made: Made<'_>,
) -> Result<String, Invalid> {
    let plan = Plan {
        arm: EquippedArm::of(table),
        laws: vec![Law::WithinLimits],
        sets: vec![Set::Pass, Set::Random],
        ..plan.clone()
    };
    let torques = table.links.iter().map(|link| link.torque_limit);
    let strongest = torques.fold(0.0, f64::max);
    let mut text = String::new();
    for of_set in made(&plan)? {
        let runs = &of_set.within_limits;
        let steps = figures(runs, |run| run.step.nm);
        let spread = |write: &dyn Fn(f64) -> String| {
            [0.5, 0.95, 1.0]
                .map(|share| write(percentile(&steps, share)))
                .join(" / ")
        };
        let count = |is: &dyn Fn(&Outcome) -> bool| runs.iter().filter(|run| is(run)).count();
        let back = |run: &Outcome| run.levels[0].back.is_none_or(|error| error >= 0.1);
        let _ = writeln!(
            text,
            "| `{}`{remark} | {} `{}` | {} | {} | {} | {} of {} | {} | {} | {} | {} |",
            table.name,
            runs.len(),
            of_set.set.name(),
            count(&|run| run.stop.is_some()),
            spread(&brief),
            spread(&|step| format!("{:.1} %", step / strongest * 100.0)),
            runs.iter()
                .map(|run| run.limited.torque_rate)
                .sum::<usize>(),
            runs.iter().map(|run| run.cycles).sum::<usize>(),
            brief(percentile(&figures(runs, Outcome::speed_share), 1.0)),
            count(&|run| run.speed_share() > 1.0),
            count(&|run| run.beyond_deg > 0.0),
            match of_set.set {
                Set::Pass => count(&back).to_string(),
                _ => "-".into(),
            },
        );
    }
    Ok(text)
}

const LAWS_HEAD: &str = "\
| set | figure | must be | ideal f64 | ideal f32 | realistic f64 | realistic f32 |
|---|---|---|---|---|---|---|
";

/// Every figure that is judged, of all sets of `plan`: exact law / law within limits.
///
/// # Errors
/// A run that cannot be.
pub fn laws(plan: &Plan, made: Made<'_>) -> Result<String, Invalid> {
    let mut text = String::from(LAWS_HEAD);
    for &set in &plan.sets {
        text += &set_by_laws(set, plan, made)?;
    }
    Ok(text)
}

/// The rows of one set.
///
/// # Errors
/// A run that cannot be.
pub fn set_by_laws(set: Set, plan: &Plan, made: Made<'_>) -> Result<String, Invalid> {
    let mut columns = Vec::new();
    for (plant, precision) in CONDITIONS {
        let plan = Plan {
            plant,
            precision,
            laws: vec![Law::Exact, Law::WithinLimits],
            sets: vec![set],
            ..plan.clone()
        };
        for of_set in made(&plan)? {
            let exact = SetOutcome {
                within_limits: of_set.exact.clone(),
                ..of_set.clone()
            };
            columns.push([judged(&exact, &plan), judged(&of_set, &plan)]);
        }
    }
    let mut text = String::new();
    let Some([first, _]) = columns.first() else {
        return Ok(text);
    };
    for (row, Criterion { what, allowed, .. }) in first.iter().enumerate() {
        let _ = write!(text, "| `{}` | {what} | {allowed} |", set.name());
        for [exact, within] in &columns {
            let [exact, within] = [exact, within].map(|all| value(&all[row]));
            let _ = write!(text, " {exact} / {within} |");
        }
        text += "\n";
    }
    Ok(text)
}

/// The figures that are judged on the ideal plant in double precision, and how often limits of
/// the joints were exceeded.
fn judged(of_set: &SetOutcome, plan: &Plan) -> Vec<Criterion> {
    let plan = Plan {
        plant: PlantKind::Ideal,
        precision: Precision::F64,
        ..plan.clone()
    };
    let mut all = judge(of_set, &plan);
    let runs = &of_set.within_limits;
    for (what, is) in [
        (
            "runs beyond a range",
            (|run| run.beyond_deg > 0.0) as fn(&Outcome) -> bool,
        ),
        ("runs above a speed limit", |run| run.speed_share() > 1.0),
    ] {
        if of_set.set.is_drawn() && all.iter().all(|criterion| criterion.what != what) {
            all.push(Criterion {
                what: what.into(),
                value: runs.iter().filter(|run| is(run)).count() as f64,
                allowed: "-".into(),
                met: true,
            });
        }
    }
    all
}

/// A figure, whole numbers as they are; none of a level that was never there.
fn value(criterion: &Criterion) -> String {
    let value = criterion.value;
    match () {
        () if !value.is_finite() => "-".into(),
        () if value == value.round() && value.abs() < 1e5 => format!("{value}"),
        () => brief(value),
    }
}

const SPEEDS_HEAD: &str = "\
| joint | f64, runs above | largest, of its limit | f32, runs above | largest, of its limit |
|---|---|---|---|---|
";

/// Which joints exceed their speed limits in the random motions on the realistic plant, by the
/// law within limits.
///
/// # Errors
/// A run that cannot be.
pub fn speeds(plan: &Plan, made: Made<'_>) -> Result<String, Invalid> {
    let mut columns = Vec::new();
    for precision in [Precision::F64, Precision::F32] {
        let plan = Plan {
            plant: PlantKind::Realistic,
            precision,
            laws: vec![Law::WithinLimits],
            sets: vec![Set::Random],
            ..plan.clone()
        };
        columns.extend(made(&plan)?.into_iter().map(|of_set| of_set.within_limits));
    }
    let mut text = String::from(SPEEDS_HEAD);
    for (joint, link) in plan.arm.parameters.links.iter().enumerate() {
        let _ = write!(text, "| {} |", link.name);
        for runs in &columns {
            let shares = figures(runs, |run| run.speed_shares[joint]);
            let above = shares.iter().filter(|&&share| share > 1.0).count();
            let _ = write!(text, " {above} | {} |", brief(percentile(&shares, 1.0)));
        }
        text += "\n";
    }
    Ok(text)
}

/// All of them; of runs from files the laws.
///
/// # Errors
/// A run that cannot be.
pub fn all(plan: &Plan, made: Made<'_>) -> Result<String, Invalid> {
    let by_laws = laws(plan, made)?;
    if plan.from.is_some() {
        return Ok(by_laws);
    }
    let (by_arms, by_joints) = (arms(plan, made)?, speeds(plan, made)?);
    Ok([by_laws, by_joints, by_arms].join("\n"))
}
