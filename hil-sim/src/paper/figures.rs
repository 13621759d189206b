//! The paper's figures re-made, and those that the paper lacks.

use super::plan::Family;
use super::results::{Outcome, Results};
use super::stability::{CYCLES_MS, Evidence};
use crate::controllers::ControllerKind::{self, VelocityLevel};
use crate::controllers::TorqueLaw::{
    AccelerationLevel, AccelerationLevelEstimate, Hierarchical, NoObserver,
};
use crate::report::figures::{Figure, torque_panels};
use crate::report::plot::{Chart, Panel, Scale, Series, Stroke, Style};
use crate::report::{Recording, diagram, scene};
use cell::names::PlantKind::Realistic;
use cell::names::{Named, NullStiffness};

/// All figures, in the order of the report.
#[must_use]
pub fn all(results: &Results, evidence: &[Evidence]) -> Vec<Figure> {
    let [two_level, cases] = [
        [Hierarchical, NoObserver, AccelerationLevel],
        [Hierarchical, AccelerationLevel, AccelerationLevelEstimate],
    ]
    .map(|[first, second, third]| [first.into(), second.into(), third.into(), VelocityLevel]);
    vec![
        Figure {
            file: "fig02.svg",
            caption: "Controller and observer as blocks (the paper's Fig. 2).".into(),
            drawing: diagram::drawing(),
        },
        errors(results, "fig04.svg", "two-level", 4, two_level),
        postures(results, "fig05.svg", "two-level", 5),
        errors(results, "fig06.svg", "case-1", 6, cases),
        torques(results, "fig07.svg", "case-1", 7),
        postures(results, "fig08.svg", "case-2", 8),
        errors(results, "fig09.svg", "case-2", 9, cases),
        torques(results, "fig10.svg", "case-2", 10),
        hand(results),
        attribution(results),
        lyapunov(evidence),
    ]
}

/// The first run of a scenario on the pushed realistic arm.
fn pushed<'a>(
    results: &'a Results,
    scenario: &'static str,
    controller: impl Into<ControllerKind>,
) -> &'a Outcome {
    results.first(Family::pushed(scenario, Realistic, controller))
}

/// Task errors of several controllers, a panel per level, logarithmic. After the paper's
/// figure `number`, as all with such a number.
fn errors(
    results: &Results,
    file: &'static str,
    scenario: &'static str,
    number: u8,
    controllers: [ControllerKind; 4],
) -> Figure {
    let first = pushed(results, scenario, controllers[0]);
    let mut chart = first.run().chart(
        stem(file),
        format!("Task error \u{2013} {scenario}, realistic arm, pushed"),
        "Task error of every level over time, one line per controller.",
    );
    let strokes = [Stroke::Solid, Stroke::Thin, Stroke::Thin, Stroke::Thin];
    for (level, figures) in first.summary.levels.iter().enumerate() {
        // The product last: its line lies on top.
        let lines = (0..controllers.len()).rev().map(|k| {
            let recording = &pushed(results, scenario, controllers[k]).recording;
            let (error, style) = (recording.error_milli(level), Style::new(k, strokes[k]));
            recording.line(controllers[k].name(), error, style)
        });
        let label = format!("level {} [{}]", level + 1, figures.unit().suffix());
        let scale = Scale::Log { floor: 1e-3 };
        let panel = Panel::new(label, 170.0, scale, lines.collect());
        chart.panels.push(panel);
    }
    Figure {
        file,
        caption: format!(
            "{scenario}: distance of every level from its reference, logarithmic, with the \
             hierarchical law and with others (after the paper's Fig. {number}). Shaded: the \
             pushes."
        ),
        drawing: chart.draw(),
    }
}

/// External torque of the seven joints, true and estimated.
fn torques(results: &Results, file: &'static str, scenario: &'static str, number: u8) -> Figure {
    let outcome = pushed(results, scenario, Hierarchical);
    let mut chart = outcome.run().chart(
        stem(file),
        format!("External torque \u{2013} {scenario}, realistic arm"),
        "External torque of the seven joints over time, true and estimated.",
    );
    chart.panels = torque_panels(&outcome.recording);
    Figure {
        file,
        caption: format!(
            "{scenario}: external torque, true and as the observer estimates it (after the \
             paper's Fig. {number}). The estimate contains friction and the errors of the model."
        ),
        drawing: chart.draw(),
    }
}

/// The arm as a stick figure at the start and in every push.
fn postures(results: &Results, file: &'static str, scenario: &'static str, number: u8) -> Figure {
    let run = pushed(results, scenario, Hierarchical).run();
    let title = format!("Arm postures \u{2013} {scenario}");
    Figure {
        file,
        caption: format!(
            "{scenario}: the arm at the start and while it is pushed, path of the flange (the \
             paper's Fig. {number})."
        ),
        drawing: scene::postures(&run, &title),
    }
}

fn hand(results: &Results) -> Figure {
    let family = Family::pushed("hand", Realistic, Hierarchical);
    let first = results.first(family);
    let mut chart = first.run().chart(
        "hand",
        "A hand at the elbow \u{2013} hand, realistic arm",
        "Hand force and task error for three null-space stiffnesses.",
    );
    let lines = |pick: fn(&Recording) -> &[f64]| {
        let levels = NullStiffness::ALL.iter().enumerate();
        let series = levels.map(|(k, &(name, stiffness))| {
            let recording = &results.first(family.stiff(stiffness)).recording;
            let label = format!("{name} stiffness");
            recording.line(label, pick(recording), Style::solid(k))
        });
        series.collect::<Vec<_>>()
    };
    let (force, error) = (lines(Recording::hand_force_n), lines(|r| r.error_milli(0)));
    let unit = first.summary.levels[0].unit().suffix();
    chart.panels = vec![
        Panel::new("hand force [N]", 170.0, Scale::FromZero, force),
        Panel::new(
            format!("task error [{unit}]"),
            130.0,
            Scale::FromZero,
            error,
        ),
    ];
    Figure {
        file: "hand.svg",
        caption: "A hand moves the elbow aside twice: the softer the null space, the smaller its \
                  force; the task does not notice."
            .into(),
        drawing: chart.draw(),
    }
}

fn attribution(results: &Results) -> Figure {
    let outcomes = [Hierarchical, AccelerationLevelEstimate]
        .map(|controller| (controller, pushed(results, "case-2", controller)));
    let mut chart = outcomes[0].1.run().chart(
        "attribution",
        "Posture \u{2013} case-2, realistic arm, pushed",
        "Angles of joints 1 and 3 with and without null-space stiffness.",
    );
    for joint in [0, 2] {
        let lines = outcomes
            .iter()
            .enumerate()
            .map(|(k, (controller, outcome))| {
                let angle = outcome.recording.q_deg(joint);
                (outcome.recording).line(controller.name(), angle, Style::solid(k))
            });
        let name = outcomes[0].1.recording.arm().joint(joint);
        let label = format!("{name} [deg]");
        let panel = Panel::new(label, 130.0, Scale::Linear, lines.collect());
        chart.panels.push(panel);
    }
    Figure {
        file: "attribution.svg",
        caption: "What the hierarchy brings and what the observer brings: with the same estimate \
                  the acceleration-level law tracks as well, but its null space has no stiffness \
                  and the posture drifts."
            .into(),
        drawing: chart.draw(),
    }
}

fn lyapunov(evidence: &[Evidence]) -> Figure {
    let mut chart = Chart::over_time(
        "stability",
        "Lyapunov functions \u{2013} case-1, exact model",
        "Lyapunov functions relative to their start over time.",
    );
    let shown = evidence.iter().filter(|one| one.cycle_ms == CYCLES_MS[0]);
    let lines = shown
        .enumerate()
        .map(|(k, one)| Series::new(one.name.clone(), &one.t, &one.value, Style::solid(k)));
    let scale = Scale::Log { floor: 1e-16 };
    let panel = Panel::new("V / V(0)", 260.0, scale, lines.collect());
    chart.panels.push(panel);
    Figure {
        file: "stability.svg",
        caption: "V_1 with a constant external torque and the observer at work, V_1 and V_2 \
                  contact-free from 5 mm off, V_l from 0.1 rad off along the null space, at 2 ms. \
                  What remains of V_l lies across it: the null space turns as the arm moves."
            .into(),
        drawing: chart.draw(),
    }
}

fn stem(file: &'static str) -> &'static str {
    file.strip_suffix(".svg").unwrap_or(file)
}
