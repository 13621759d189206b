//! The figures of a run.

use controller_core::joint::DOF;

use super::figure::{chart, figure};
use super::limits;
use super::plot::{LimitLine, Panel, Scale, Series, Stroke, Style};
use super::recording::Recording;
use super::run::Run;
use super::scene;
use super::ticks::plain;
use crate::metrics::LevelFigures;
use cell::scenario::Metric;

pub use super::figure::Figure;

/// Below this, a task acceleration is rounding \[m/s2\].
const LEAK_FLOOR: f64 = 1e-18;

/// Below this, a row counts as lost \[1/sqrt(kg)\].
const CONDITIONING_FLOOR: f64 = 1e-6;

/// The figures of a run, in the order of the report. What was not recorded has
/// no figure.
#[must_use]
pub fn figures(run: &Run<'_>) -> Vec<Figure> {
    let mut figures = vec![task_error(run), external_torque(run), joint_angles(run)];
    figures.extend(limits::figures(run));
    figures.extend(priority_leak(run));
    figures.extend(conditioning(run));
    figures.extend(hand_force(run));
    figures.extend(path(run));
    figures.extend(arm(run));
    figures
}

/// A panel per level: its axis is titled `what` where there is one level only.
fn per_level(
    run: &Run<'_>,
    what: &str,
    panel: impl Fn(usize, &LevelFigures) -> (&'static str, Scale, Series),
) -> Vec<Panel> {
    let count = run.recording.levels();
    let levels = run.summary.levels.iter().enumerate().take(count);
    let panels = levels.map(|(index, level)| {
        let (unit, scale, line) = panel(index, level);
        let title = if count == 1 {
            format!("{what} [{unit}]")
        } else {
            format!("level {} [{unit}]", index + 1)
        };
        Panel::new(title, Panel::height_among(count), scale, vec![line])
    });
    panels.collect()
}

fn task_error(run: &Run<'_>) -> Figure {
    let mut chart = chart(
        run,
        "task-error",
        "Task error",
        "Norm of every level's task error over time, with the limits it is judged by.",
    );
    chart.panels = per_level(run, "task error", |index, level| {
        let label = format!("error of level {}, {}", index + 1, level.name);
        let error = run.recording.error_milli(index);
        let line = run.recording.line(label, error, Style::solid(index));
        (level.unit().suffix(), Scale::FromZero, line)
    });
    let mut explained = "No limit is set for this plant and these contacts.";
    for (index, panel) in chart.panels.iter_mut().enumerate() {
        panel.limits = acceptance(run, index);
        if !panel.limits.is_empty() {
            explained = "Broken lines: limits of the largest error, of its rms and of its \
                         plateau, as labelled.";
        }
    }
    let caption = format!(
        "Task error: distance of the controlled point from its reference, along the \
         level\u{2019}s axes, from the true motion. {explained}"
    );
    figure(run, "task-error.svg", &caption, &chart)
}

/// The acceptance limits of a level as lines.
fn acceptance(run: &Run<'_>, level: usize) -> Vec<LimitLine> {
    let levels = &run.scenario.levels;
    let unit = run.summary.levels[level].unit().suffix();
    let mine = run.summary.acceptance.iter().filter_map(|acceptance| {
        let kind = match Metric::parse(&acceptance.metric, levels).ok()? {
            Metric::Rms(of) if of == level => "rms",
            Metric::Max(of) if of == level => "max",
            Metric::Plateau(of) if of == level => "plateau",
            _ => return None,
        };
        Some(LimitLine {
            value: acceptance.limit,
            label: format!("{kind} limit {} {unit}", plain(acceptance.limit)),
        })
    });
    mine.collect()
}

/// External torque of every joint, true and estimated.
pub(crate) fn torque_panels(recording: &Recording) -> Vec<Panel> {
    let panel = |joint| {
        let estimate: Vec<_> = recording.residual(joint).iter().map(|r| -r).collect();
        let (wide, thin) = (Style::new(6, Stroke::Wide), Style::new(0, Stroke::Thin));
        let lines = vec![
            recording.line("true \u{3c4}_ext", recording.tau_ext(joint), wide),
            recording.line("estimate \u{2212}r", &estimate, thin),
        ];
        let label = format!("{} [Nm]", recording.arm().joint(joint));
        Panel::new(label, Panel::height_among(DOF), Scale::Linear, lines)
    };
    (0..DOF).map(panel).collect()
}

fn external_torque(run: &Run<'_>) -> Figure {
    let mut chart = chart(
        run,
        "external-torque",
        "External torque",
        "External torque of the seven joints over time, true and estimated.",
    );
    chart.panels = torque_panels(run.recording);
    let friction = if run.summary.plant == "realistic" {
        " Friction and the errors of the model are part of the estimate: it is not zero without \
         contact."
    } else {
        ""
    };
    let caption = format!(
        "External torque \u{3c4}_ext of M\u{a0}ddq + C\u{a0}dq + g = \u{3c4} \u{2212} \
         \u{3c4}_ext, joint by joint: true, and as the momentum observer estimates it \
         (\u{2212}r). Every joint has its own scale.{friction}"
    );
    figure(run, "external-torque.svg", &caption, &chart)
}

fn joint_angles(run: &Run<'_>) -> Figure {
    let mut chart = chart(
        run,
        "joint-angles",
        "Joint angles",
        "Positions of the seven joints over time.",
    );
    let lines = ('\u{2081}'..).take(DOF).enumerate().map(|(joint, number)| {
        let angle = run.recording.q_deg(joint);
        let label = format!("q{number}");
        run.recording.line(label, angle, Style::alternating(joint))
    });
    let mut panel = Panel::new("joint angle [deg]", 300.0, Scale::Linear, lines.collect());
    panel.end_labels = true;
    chart.panels.push(panel);
    let caption = "Joint angles, true. A contact moves the arm within what the tasks leave free.";
    figure(run, "joint-angles.svg", caption, &chart)
}

fn priority_leak(run: &Run<'_>) -> Option<Figure> {
    let mut chart = chart(
        run,
        "priority-leak",
        "Priority leak",
        "Task acceleration that lower levels and the null space cause in every level, over time.",
    );
    chart.panels = per_level(run, "acceleration", |index, level| {
        let label = format!("level {}, {}", index + 1, level.name);
        let (leak, style) = (run.recording.leak(index), Style::new(index, Stroke::Thin));
        let line = run.recording.line(label, leak, style);
        ("m/s\u{b2}", Scale::Log { floor: LEAK_FLOOR }, line)
    });
    if chart.panels.iter().all(Panel::is_empty) {
        return None;
    }
    let caption = "Priority leak: task acceleration of a level that the torque of everything \
                   below it causes on this arm. With an exact model it is rounding; what remains \
                   on a mismatched arm is the error of the controller's model. Zero is drawn at \
                   the lower edge.";
    Some(figure(run, "priority-leak.svg", caption, &chart))
}

fn conditioning(run: &Run<'_>) -> Option<Figure> {
    let levels = (1..).zip(&run.scenario.levels);
    let rows = levels.flat_map(|(number, level)| {
        let axes = level.axes.chars();
        axes.map(move |axis| format!("level {number} {axis}"))
    });
    let shown = run.recording.rows().min(DOF);
    let lines = rows.take(shown).enumerate().map(|(row, label)| {
        let values = run.recording.conditioning(row);
        run.recording.line(label, values, Style::alternating(row))
    });
    let scale = Scale::Log {
        floor: CONDITIONING_FLOOR,
    };
    let mut panel = Panel::new("|R_kk| [1/\u{221a}kg]", 210.0, scale, lines.collect());
    if panel.is_empty() {
        return None;
    }
    panel.end_labels = true;
    let mut chart = chart(
        run,
        "conditioning",
        "Conditioning",
        "Diagonal of the triangular factor of the task rows over time, on a logarithmic axis.",
    );
    chart.panels.push(panel);
    let caption = "Conditioning: |R_kk| of every task row, logarithmic. It says how far the row \
                   is from being unresolvable given the rows above it; a row below \
                   10\u{207b}\u{2074} is dropped.";
    Some(figure(run, "conditioning.svg", caption, &chart))
}

fn hand_force(run: &Run<'_>) -> Option<Figure> {
    let force = run.recording.hand_force_n();
    let line = run.recording.line("", force, Style::solid(0));
    if line.is_empty() {
        return None;
    }
    let mut chart = chart(
        run,
        "hand-force",
        "Hand force",
        "Force of the simulated hand on the arm over time.",
    );
    let panel = Panel::new("hand force [N]", 190.0, Scale::FromZero, vec![line]);
    chart.panels.push(panel);
    let caption = "Force with which the hand moves the arm against its compliance.";
    Some(figure(run, "hand-force.svg", caption, &chart))
}

fn path(run: &Run<'_>) -> Option<Figure> {
    Some(Figure {
        file: "path.svg",
        caption: "Desired and true path of the controlled points, where the reference moves, and \
                  the deviation in the same plane, true less desired: a perfect follower stays \
                  at its zero."
            .into(),
        drawing: scene::paths(run)?,
    })
}

fn arm(run: &Run<'_>) -> Option<Figure> {
    let title = format!("Arm postures \u{2013} {}", run.label());
    (!run.recording.arms.is_empty()).then(|| Figure {
        file: "arm.svg",
        caption: "The arm as lines from the base plate along the lengths of its table to flange \
                  and tool, base-plate axes, at the start and while contacts press: the same task, other postures. \
                  Thin line: path of the first level\u{2019}s point."
            .into(),
        drawing: scene::postures(run, &title),
    })
}
