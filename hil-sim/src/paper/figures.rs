//! The paper's figures re-made, and those that the paper lacks.

use controller_core::joint::DOF;

use super::plan::Family;
use super::results::{Outcome, Results};
use super::stability::{CYCLES_MS, Evidence};
use crate::controllers::ControllerKind::{self, VelocityLevel};
use crate::controllers::TorqueLaw::{
    AccelerationLevel, AccelerationLevelEstimate, Hierarchical, NoObserver,
};
use crate::report::plot::{Chart, Panel, Scale, Series, Stroke, Style};
use crate::report::svg::Svg;
use crate::report::{Recording, Run, diagram, scene};
use cell::names::PlantKind::Realistic;
use cell::names::{Named, NullStiffness};

/// A drawing with its caption.
pub struct Figure {
    /// File name.
    pub file: &'static str,
    /// What it shows.
    pub caption: String,
    /// The drawing.
    pub drawing: Svg,
}

/// All figures, in the order of the report.
#[must_use]
pub fn all(results: &Results, evidence: &[Evidence]) -> Vec<Figure> {
    vec![
        Figure {
            file: "fig02.svg",
            caption: "Controller and observer as blocks (the paper's Fig. 2).".into(),
            drawing: diagram::drawing(),
        },
        errors(
            results,
            "fig04.svg",
            "two-level",
            "the paper's Fig. 4",
            &[
                Hierarchical.into(),
                NoObserver.into(),
                AccelerationLevel.into(),
                VelocityLevel,
            ],
        ),
        postures(results, "fig05.svg", "two-level", "the paper's Fig. 5"),
        errors(
            results,
            "fig06.svg",
            "case-1",
            "the paper's Fig. 6",
            &[
                Hierarchical.into(),
                AccelerationLevel.into(),
                AccelerationLevelEstimate.into(),
                VelocityLevel,
            ],
        ),
        torques(results, "fig07.svg", "case-1", "the paper's Fig. 7"),
        postures(results, "fig08.svg", "case-2", "the paper's Fig. 8"),
        errors(
            results,
            "fig09.svg",
            "case-2",
            "the paper's Fig. 9",
            &[
                Hierarchical.into(),
                AccelerationLevel.into(),
                AccelerationLevelEstimate.into(),
                VelocityLevel,
            ],
        ),
        torques(results, "fig10.svg", "case-2", "the paper's Fig. 10"),
        hand(results),
        attribution(results),
        lyapunov(evidence),
    ]
}

fn run(outcome: &Outcome) -> Option<(Run<'_>, &Recording)> {
    let recording = outcome.recording.as_ref()?;
    Some((
        Run::new(&outcome.summary, &outcome.scenario, recording),
        recording,
    ))
}

fn over_time(outcome: &Outcome, id: &str, title: String, description: &str) -> Chart {
    let mut chart = Chart::over_time(id, title, description);
    chart.x_range = Some([0.0, outcome.scenario.duration_s]);
    if let Some((run, _)) = run(outcome) {
        chart.bands = run.bands();
    }
    chart
}

/// Task errors of several controllers, a panel per level, logarithmic.
fn errors(
    results: &Results,
    file: &'static str,
    scenario: &'static str,
    of: &str,
    controllers: &[ControllerKind],
) -> Figure {
    let outcome = |controller| results.first(Family::pushed(scenario, Realistic, controller));
    let first = outcome(controllers[0]);
    let mut chart = over_time(
        first,
        stem(file),
        format!("Task error \u{2013} {scenario}, realistic arm, pushed"),
        "Task error of every level over time, one line per controller.",
    );
    for (level, figures) in first.summary.levels.iter().enumerate() {
        // The product last: its line lies on top.
        let lines = controllers
            .iter()
            .enumerate()
            .rev()
            .filter_map(|(k, &controller)| {
                let (_, recording) = run(outcome(controller))?;
                let style = Style::new(k, if k == 0 { Stroke::Solid } else { Stroke::Thin });
                Some(Series::new(
                    controller.name(),
                    recording.t(),
                    recording.error_milli(level),
                    style,
                ))
            });
        let label = format!("level {} [{}]", level + 1, figures.unit().suffix());
        chart.panels.push(Panel::new(
            label,
            170.0,
            Scale::Log { floor: 1e-3 },
            lines.collect(),
        ));
    }
    Figure {
        file,
        caption: format!(
            "{scenario}: distance of every level from its reference, logarithmic, with the \
             hierarchical law and with others (after {of}). Shaded: the pushes."
        ),
        drawing: chart.draw(),
    }
}

/// External torque of the seven joints, true and estimated.
fn torques(results: &Results, file: &'static str, scenario: &'static str, of: &str) -> Figure {
    let outcome = results.first(Family::pushed(scenario, Realistic, Hierarchical));
    let mut chart = over_time(
        outcome,
        stem(file),
        format!("External torque \u{2013} {scenario}, realistic arm"),
        "External torque of the seven joints over time, true and estimated.",
    );
    if let Some((_, recording)) = run(outcome) {
        for joint in 0..DOF {
            let estimate: Vec<_> = recording.residual(joint).iter().map(|r| -r).collect();
            let lines = vec![
                Series::new(
                    "true \u{3c4}_ext",
                    recording.t(),
                    recording.tau_ext(joint),
                    Style::new(6, Stroke::Wide),
                ),
                Series::new(
                    "estimate \u{2212}r",
                    recording.t(),
                    &estimate,
                    Style::new(0, Stroke::Thin),
                ),
            ];
            let label = format!("joint {} [Nm]", joint + 1);
            chart.panels.push(Panel::new(
                label,
                Panel::height_among(DOF),
                Scale::Linear,
                lines,
            ));
        }
    }
    Figure {
        file,
        caption: format!(
            "{scenario}: external torque, true and as the observer estimates it (after {of}). The \
             estimate contains friction and the errors of the model."
        ),
        drawing: chart.draw(),
    }
}

/// The arm as a stick figure at the start and in every push.
fn postures(results: &Results, file: &'static str, scenario: &'static str, of: &str) -> Figure {
    let outcome = results.first(Family::pushed(scenario, Realistic, Hierarchical));
    let mut drawing = None;
    if let Some((run, recording)) = run(outcome) {
        let bands = run.bands();
        let labels: Vec<_> = recording
            .arms
            .iter()
            .map(|arm| scene::instant(arm.t_s, &bands))
            .collect();
        let title = format!("Arm postures \u{2013} {scenario}");
        let path = scene::path_of(recording, 0);
        drawing = Some(scene::postures(&title, &recording.arms, &labels, &path));
    }
    Figure {
        file,
        caption: format!(
            "{scenario}: the arm at the start and while it is pushed, path of the flange ({of})."
        ),
        drawing: drawing.unwrap_or_else(|| Chart::over_time(stem(file), scenario, "").draw()),
    }
}

fn hand(results: &Results) -> Figure {
    let family = Family::pushed("hand", Realistic, Hierarchical);
    let first = results.first(family);
    let mut chart = over_time(
        first,
        "hand",
        "A hand at the elbow \u{2013} hand, realistic arm".into(),
        "Hand force and task error for three null-space stiffnesses.",
    );
    let levels = [
        NullStiffness::Low,
        NullStiffness::Normal,
        NullStiffness::High,
    ];
    let lines = |pick: fn(&Recording) -> &[f64]| {
        let series = levels.iter().enumerate().filter_map(|(k, &stiffness)| {
            let (_, recording) = run(results.first(family.stiff(stiffness)))?;
            let label = format!("{} stiffness", stiffness.name());
            Some(Series::new(
                label,
                recording.t(),
                pick(recording),
                Style::solid(k),
            ))
        });
        series.collect::<Vec<_>>()
    };
    chart.panels.push(Panel::new(
        "hand force [N]",
        170.0,
        Scale::FromZero,
        lines(Recording::hand_force_n),
    ));
    chart.panels.push(Panel::new(
        "task error [mm]",
        130.0,
        Scale::FromZero,
        lines(|r| r.error_milli(0)),
    ));
    Figure {
        file: "hand.svg",
        caption: "A hand moves the elbow aside twice: the softer the null space, the smaller its \
                  force; the task does not notice."
            .into(),
        drawing: chart.draw(),
    }
}

fn attribution(results: &Results) -> Figure {
    let outcome = |controller| results.first(Family::pushed("case-2", Realistic, controller));
    let mut chart = over_time(
        outcome(Hierarchical),
        "attribution",
        "Posture \u{2013} case-2, realistic arm, pushed".into(),
        "Angles of joints 1 and 3 with and without null-space stiffness.",
    );
    for joint in [0, 2] {
        let controllers = [Hierarchical, AccelerationLevelEstimate]
            .into_iter()
            .enumerate();
        let lines = controllers.filter_map(|(k, controller)| {
            let (_, recording) = run(outcome(controller))?;
            Some(Series::new(
                controller.name(),
                recording.t(),
                recording.q_deg(joint),
                Style::solid(k),
            ))
        });
        chart.panels.push(Panel::new(
            format!("joint {} [deg]", joint + 1),
            130.0,
            Scale::Linear,
            lines.collect(),
        ));
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
    chart.panels.push(Panel::new(
        "V / V(0)",
        260.0,
        Scale::Log { floor: 1e-16 },
        lines.collect(),
    ));
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
