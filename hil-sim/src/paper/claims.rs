//! The claims of section 6 and of the errata, each with a number and a verdict.

use super::claim::Sense::{AtLeast, Below};
use super::claim::Whose::{Ours, Paper};
use super::claim::{Claim, Claims};
use super::plan::{DRIFT, Family, PERIODS_S, period_id};
use super::results::{Results, Worst};
use super::stability::{CYCLES_MS, Evidence};
use crate::controllers::ControllerKind::{self, VelocityLevel};
use crate::controllers::TorqueLaw::{
    AccelerationLevel, AccelerationLevelEstimate, AsPrinted, Hierarchical, Literal, NoObserver,
};
use crate::summary::Summary;
use cell::names::NullStiffness;
use cell::names::PlantKind::{Ideal, Realistic};

fn rms(level: usize) -> impl Fn(&Summary) -> Option<f64> {
    move |summary| summary.levels.get(level)?.rms()
}

fn max(level: usize) -> impl Fn(&Summary) -> Option<f64> {
    move |summary| summary.levels.get(level)?.max()
}

fn residual(summary: &Summary) -> Option<f64> {
    summary.residual.rms_error_nm
}

/// The smallest of one family over the largest of another.
fn ratio(
    results: &Results,
    over: Family,
    under: Family,
    figure: impl Fn(&Summary) -> Option<f64>,
) -> Worst {
    results
        .least(over, &figure)
        .over(&results.worst(under, &figure))
}

/// Every claim.
#[must_use]
pub fn all(results: &Results, evidence: &[Evidence]) -> Vec<Claim> {
    let mut claims = Claims::default();
    two_levels(&mut claims, results);
    three_levels(&mut claims, results);
    discussion(&mut claims, results);
    attribution(&mut claims, results);
    velocity_level(&mut claims, results);
    stability(&mut claims, evidence);
    errata(&mut claims, results);
    claims.0
}

fn two_levels(s: &mut Claims, results: &Results) {
    let pushed = Family::pushed("two-level", Realistic, Hierarchical);
    let ideal = Family::pushed("two-level", Ideal, Hierarchical);
    s.add(
        Ours,
        "6.1-circle",
        "The flange keeps its circle while the body is pushed: rms error.",
        results.worst(pushed, rms(0)),
        "mm",
        Below(0.55),
    );
    s.add(
        Ours,
        "6.1-circle-max",
        "The flange keeps its circle while the body is pushed: largest error.",
        results.worst(pushed, max(0)),
        "mm",
        Below(1.8),
    );
    s.add(
        Ours,
        "6.1-exact",
        "With an exact model and nobody near, the law tracks exactly but for sampling: rms error.",
        results.worst(ideal.free(), rms(0)),
        "mm",
        Below(0.001),
    );
    s.add(
        Ours,
        "6.1-plateau",
        "A steady push leaves no task error: worst plateau with an exact model.",
        results.worst(ideal, |summary| summary.levels[0].worst_plateau()),
        "mm",
        Below(0.05),
    );
    s.add(Paper, "6.1-estimate", "The observer finds the external torque without torque sensors: rms error of the estimate, exact model.",
        results.worst(ideal, residual), "Nm", Below(0.1));
    s.add(Paper, "6.1-estimate-friction", "The estimate is as good on an arm with friction and a wrong model (friction is in r: it is no contact measure by itself).",
        results.worst(pushed, residual), "Nm", Below(0.1));
    s.add(Paper, "6.1-compliance", "The body gives way in the null space: more travel of joint 3 with the pushes than without, exact model.",
        difference(results, ideal, |summary| Some(summary.joints.range_deg[2])), "deg", AtLeast(5.0));
    s.add(
        Ours,
        "6.1-no-observer",
        "Without the observer the task is lost: how many times larger the rms error is.",
        ratio(
            results,
            Family::pushed("two-level", Realistic, NoObserver),
            pushed,
            rms(0),
        ),
        "times",
        AtLeast(8.0),
    );
    s.add(Ours, "6.1-acceleration-level", "Acceleration-level priorities lose the task when pushed: how many times larger the rms error is.",
        ratio(results, Family::pushed("two-level", Realistic, AccelerationLevel), pushed, rms(0)), "times", AtLeast(8.0));
}

fn difference(
    results: &Results,
    pushed: Family,
    figure: impl Fn(&Summary) -> Option<f64>,
) -> Worst {
    let with = results.worst(pushed, &figure);
    let without = results.worst(pushed.free(), &figure);
    Worst {
        value: with.value - without.value,
        run: with.run,
    }
}

fn three_levels(s: &mut Claims, results: &Results) {
    for (scenario, limits) in [("case-1", [0.85, 0.2]), ("case-2", [0.55, 0.2])] {
        let pushed = Family::pushed(scenario, Realistic, Hierarchical);
        let other = Family::pushed(scenario, Realistic, AccelerationLevel);
        for (level, limit) in limits.into_iter().enumerate() {
            let number = level + 1;
            s.add(
                Ours,
                &format!("6.2-{scenario}-level{number}"),
                &format!(
                    "{scenario}: level {number} keeps its task while the body is pushed: rms error."
                ),
                results.worst(pushed, rms(level)),
                "mm",
                Below(limit),
            );
            s.add(Ours, &format!("6.2-{scenario}-level{number}-acceleration"),
                &format!("{scenario}: acceleration-level priorities lose level {number}: how many times larger the rms error is."),
                ratio(results, other, pushed, rms(level)), "times", AtLeast(10.0));
        }
        let ideal = Family::pushed(scenario, Ideal, Hierarchical);
        s.add(Ours, &format!("6.2-{scenario}-priority"),
            &format!("{scenario}: lower levels do not disturb the first: its largest acceleration caused from below, exact model."),
            results.worst(ideal, |summary| summary.levels[0].leak_max), "m/s2", Below(1e-9));
    }
    s.add(Ours, "6.2-case-1-exact", "case-1: the second level tracks exactly below a moving first one: rms error, exact model, nobody near.",
        results.worst(Family::pushed("case-1", Ideal, Hierarchical).free(), rms(1)), "mm", Below(0.0005));
}

fn discussion(s: &mut Claims, results: &Results) {
    let of =
        |scenario, plant| results.worst(Family::pushed(scenario, plant, Hierarchical), residual);
    for (plant, name) in [(Ideal, "exact model"), (Realistic, "realistic arm")] {
        let two = of("two-level", plant);
        let three = of("case-1", plant);
        s.add(Paper, &format!("6.3-residual-{}", if plant == Ideal { "ideal" } else { "realistic" }),
            &format!("Two levels have the smaller residual: rms error of the estimate, two levels over three (case-1), {name}."),
            two.over(&three), "times", Below(1.0));
    }
    let hand = Family::pushed("hand", Realistic, Hierarchical);
    let force = |summary: &Summary| summary.hand_force_max_n;
    let (low, high) = (
        hand.stiff(NullStiffness::Low),
        hand.stiff(NullStiffness::High),
    );
    let soft = results.worst(low, force);
    s.add(Ours, "6.3-hand-force", "A softer null space gives way to the hand more easily: largest hand force, low over high stiffness.",
        soft.over(&results.least(high, force)), "times", Below(0.75));
    let (soft, stiff) = (results.worst(low, rms(0)), results.worst(high, rms(0)));
    s.add(
        Ours,
        "6.3-hand-tracking",
        "The stiffness does not matter to the task: relative difference of the rms errors.",
        Worst {
            value: (soft.value / stiff.value - 1.0).abs(),
            run: soft.run,
        },
        "of 1",
        Below(0.2),
    );
}

fn attribution(s: &mut Claims, results: &Results) {
    for scenario in ["two-level", "case-1", "case-2"] {
        let estimate = results.worst(
            Family::pushed(scenario, Realistic, AccelerationLevelEstimate),
            rms(0),
        );
        let product = results.worst(Family::pushed(scenario, Realistic, Hierarchical), rms(0));
        s.add(Paper, &format!("attribution-{scenario}-tracking"),
            &format!("{scenario}: with the same estimate of the external torque the hierarchical law tracks better than acceleration-level priorities: level-1 rms of the latter over that of the former."),
            estimate.over(&product), "times", AtLeast(1.0));
    }
    let travel = |summary: &Summary| Some(summary.joints.range_deg[2]);
    let product = results.worst(Family::pushed("case-2", Realistic, Hierarchical), travel);
    let estimate = results.least(
        Family::pushed("case-2", Realistic, AccelerationLevelEstimate),
        travel,
    );
    s.add(
        Paper,
        "attribution-posture",
        "What the hierarchical law has over it is a null space with stiffness: travel of joint 3 while the flange holds its place and the body is pushed (case-2), acceleration-level law with estimate over the hierarchical one.",
        estimate.over(&product),
        "times",
        AtLeast(2.0),
    );
    s.add(Paper, "attribution-observer", "The observer brings the tracking: rms error with it, over that without, same hierarchy, two-level.",
        Worst {
            value: 1.0 / ratio(results, Family::pushed("two-level", Realistic, NoObserver),
                Family::pushed("two-level", Realistic, Hierarchical), rms(0)).value,
            run: Family::pushed("two-level", Realistic, Hierarchical).id(1),
        }, "times", Below(0.125));
}

fn velocity_level(s: &mut Claims, results: &Results) {
    for (scenario, limits) in [
        ("two-level", &[0.55][..]),
        ("case-1", &[0.85, 0.2]),
        ("case-2", &[0.55, 0.2]),
    ] {
        let family = Family::pushed(scenario, Realistic, VelocityLevel);
        for (level, &limit) in limits.iter().enumerate() {
            let number = level + 1;
            s.add(
                Ours,
                &format!("velocity-{scenario}-level{number}"),
                &format!(
                    "{scenario}: velocity-level priorities above the robot's own position \
                     controller keep level {number} while the body is pushed: rms error."
                ),
                results.worst(family, rms(level)),
                "mm",
                Below(limit),
            );
        }
    }
    let travel = |summary: &Summary| Some(summary.joints.range_deg[2]);
    let yields = |controller: ControllerKind| {
        difference(
            results,
            Family::pushed("two-level", Ideal, controller),
            travel,
        )
    };
    let (stiff, soft) = (yields(VelocityLevel), yields(Hierarchical.into()));
    s.add(
        Ours,
        "velocity-compliance",
        "With them the body does not give way: more travel of joint 3 with the pushes than \
         without, hierarchical torque law over velocity level, exact model.",
        Worst {
            value: soft.value / stiff.value.abs(),
            run: stiff.run,
        },
        "times",
        AtLeast(10.0),
    );
}

fn stability(s: &mut Claims, evidence: &[Evidence]) {
    let shortest = CYCLES_MS[CYCLES_MS.len() - 1];
    for one in evidence.iter().filter(|one| one.cycle_ms == CYCLES_MS[0]) {
        let run = format!("{} at {} ms", one.name, one.cycle_ms);
        let id = format!("stability-{}", one.name.to_lowercase().replace(' ', "-"));
        if one.rises == 0 {
            s.add(
                Ours,
                &id,
                &format!(
                    "{} never rises beyond rounding: cycles in which it does.",
                    one.name
                ),
                Worst { value: 0.0, run },
                "cycles",
                Below(1.0),
            );
            continue;
        }
        let finest = evidence
            .iter()
            .find(|e| e.name == one.name && e.cycle_ms == shortest);
        let shrunk = finest.map_or(f64::NAN, |e| e.largest_rise / one.largest_rise);
        s.add(Ours, &id,
            &format!("{} rises by a sampling term only ({} cycle(s), at most {:.1e} of its start): how the largest rise shrinks from {} to {shortest} ms.",
                one.name, one.rises, one.largest_rise, one.cycle_ms),
            Worst { value: shrunk, run }, "times", Below(0.0625));
    }
}

fn errata(s: &mut Claims, results: &Results) {
    let printed = results.first(Family::pushed("two-level", Ideal, AsPrinted));
    s.add(Paper, "errata-33-sign", "(33) as printed, with - Z K_l,p q~, keeps the null space stable: how long the run goes on.",
        Worst { value: printed.summary.cycles as f64 * printed.summary.cycle_ms / 1e3, run: printed.id.clone() },
        "s", AtLeast(20.0));
    for period in PERIODS_S {
        for (controller, whose, name, limit) in [
            (
                Literal,
                Paper,
                "as printed, without coupling of moving levels",
                0.001,
            ),
            (Hierarchical, Ours, "with the coupling", 0.005),
        ] {
            let outcome = results.get(&period_id(controller, period));
            let value = outcome.summary.levels[1].rms().unwrap_or(f64::NAN);
            let short = if controller == Literal {
                "printed"
            } else {
                "exact"
            };
            s.add(whose, &format!("errata-34-coupling-{period}s-{short}"),
                &format!("(34) {name} tracks level 2 below a circle of {period} s a turn: rms error, exact model."),
                Worst { value, run: outcome.id.clone() }, "mm", Below(limit));
        }
    }
    let drift = results.get(DRIFT);
    s.add(Paper, "errata-51-drift", "The posture integral (51) stays near the start posture on the circle: travel of joint 5 before the run ends.",
        Worst { value: drift.summary.joints.range_deg[4], run: drift.id.clone() }, "deg", Below(90.0));
}
