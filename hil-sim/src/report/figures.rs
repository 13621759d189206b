//! The figures of a run.

use controller_core::joint::DOF;

use super::plot::{Chart, LimitLine, Mark, Panel, Scale, Series, Stroke, Style};
use super::run::Run;
use super::scene;
use super::svg::Svg;
use super::ticks::plain;
use crate::summary::Verdict;
use cell::scenario::Metric;

/// Below this, a task acceleration is rounding \[m/s2\].
const LEAK_FLOOR: f64 = 1e-18;

/// Below this, a row counts as lost \[1/sqrt(kg)\].
const CONDITIONING_FLOOR: f64 = 1e-6;

/// A figure with the words under it.
#[derive(Clone, Debug)]
pub struct Figure {
    /// File name, with its ending.
    pub file: &'static str,
    /// How to read it.
    pub caption: String,
    /// The drawing.
    pub drawing: Svg,
}

/// The figures of a run as files: name and SVG text.
#[must_use]
pub fn figures(run: &Run<'_>) -> Vec<(String, String)> {
    let all = captioned(run).into_iter();
    all.map(|figure| (figure.file.to_string(), figure.drawing.standalone()))
        .collect()
}

/// The figures of a run, in the order of the report. What was not recorded has
/// no figure.
#[must_use]
pub fn captioned(run: &Run<'_>) -> Vec<Figure> {
    let mut figures = vec![task_error(run), external_torque(run), joint_angles(run)];
    figures.extend(priority_leak(run));
    figures.extend(conditioning(run));
    figures.extend(hand_force(run));
    figures.extend(path(run));
    figures.extend(arm(run));
    figures
}

/// A chart over the whole time of the run, with its contacts.
fn chart(run: &Run<'_>, id: &str, what: &str, description: &str) -> Chart {
    let mut chart = Chart::over_time(id, format!("{what} \u{2013} {}", run.label()), description);
    chart.x_range = Some([0.0, run.scenario.duration_s]);
    chart.bands = run.bands();
    if run.summary.verdict == Verdict::Stopped
        && let Some(&at) = run.recording.t().last()
    {
        chart.marks.push(Mark {
            at,
            label: format!("stopped at {at:.2} s"),
        });
    }
    chart
}

/// " Shaded: contacts A to D.", or nothing.
fn shading(run: &Run<'_>) -> String {
    match run.bands().as_slice() {
        [] => String::new(),
        [one] => format!(" Shaded: contact {}.", one.label),
        [first, .., last] => format!(" Shaded: contacts {} to {}.", first.label, last.label),
    }
}

fn task_error(run: &Run<'_>) -> Figure {
    let recording = run.recording;
    let mut chart = chart(
        run,
        "task-error",
        "Task error",
        "Norm of every level's task error over time, with the limits it is judged by.",
    );
    let count = recording.levels();
    let mut limited = false;
    for (index, level) in run.summary.levels.iter().enumerate().take(count) {
        let label = format!("error of level {}, {}", index + 1, level.name);
        let line = Series::new(
            label,
            recording.t(),
            recording.error_milli(index),
            Style::solid(index),
        );
        let title = if count == 1 {
            format!("task error [{}]", level.unit().suffix())
        } else {
            format!("level {} [{}]", index + 1, level.unit().suffix())
        };
        let mut panel = Panel::new(
            title,
            Panel::height_among(count),
            Scale::FromZero,
            vec![line],
        );
        panel.limits = limits(run, index);
        limited |= !panel.limits.is_empty();
        chart.panels.push(panel);
    }
    let explained = if limited {
        " Broken lines: limits of the largest error, of its rms and of its plateau, as labelled."
    } else {
        " No limit is set for this plant and these contacts."
    };
    Figure {
        file: "task-error.svg",
        caption: format!(
            "Task error: distance of the controlled point from its reference, along the level\u{2019}s axes, from the true motion.{explained}{}",
            shading(run)
        ),
        drawing: chart.draw(),
    }
}

/// The acceptance limits of a level as lines.
fn limits(run: &Run<'_>, level: usize) -> Vec<LimitLine> {
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

fn external_torque(run: &Run<'_>) -> Figure {
    let recording = run.recording;
    let mut chart = chart(
        run,
        "external-torque",
        "External torque",
        "External torque of the seven joints over time, true and estimated.",
    );
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
    let friction = if run.summary.plant == "realistic" {
        " Friction and the errors of the model are part of the estimate: it is not zero without contact."
    } else {
        ""
    };
    Figure {
        file: "external-torque.svg",
        caption: format!(
            "External torque \u{3c4}_ext of M\u{a0}ddq + C\u{a0}dq + g = \u{3c4} \u{2212} \u{3c4}_ext, joint by joint: true, and as the momentum observer estimates it (\u{2212}r). Every joint has its own scale.{friction}{}",
            shading(run)
        ),
        drawing: chart.draw(),
    }
}

fn joint_angles(run: &Run<'_>) -> Figure {
    let recording = run.recording;
    let mut chart = chart(
        run,
        "joint-angles",
        "Joint angles",
        "Positions of the seven joints over time.",
    );
    let strokes = [Stroke::Solid, Stroke::Dashed];
    let lines = (0..DOF).map(|joint| {
        let style = Style::new(joint, strokes[joint % 2]);
        Series::new(
            format!("q{}", subscript(joint + 1)),
            recording.t(),
            recording.q_deg(joint),
            style,
        )
    });
    let mut panel = Panel::new("joint angle [deg]", 300.0, Scale::Linear, lines.collect());
    panel.end_labels = true;
    chart.panels.push(panel);
    Figure {
        file: "joint-angles.svg",
        caption: format!(
            "Joint angles, true. A contact moves the arm within what the tasks leave free.{}",
            shading(run)
        ),
        drawing: chart.draw(),
    }
}

fn subscript(digit: usize) -> char {
    char::from_u32(0x2080 + digit as u32).unwrap_or('?')
}

fn priority_leak(run: &Run<'_>) -> Option<Figure> {
    let recording = run.recording;
    let count = recording.levels();
    let levels = run.summary.levels.iter().enumerate().take(count);
    let panels = levels.map(|(index, level)| {
        let label = format!("level {}, {}", index + 1, level.name);
        let style = Style::new(index, Stroke::Thin);
        let line = Series::new(label, recording.t(), recording.leak(index), style);
        let scale = Scale::Log { floor: LEAK_FLOOR };
        let title = if count == 1 {
            "acceleration [m/s\u{b2}]".to_string()
        } else {
            format!("level {} [m/s\u{b2}]", index + 1)
        };
        Panel::new(title, Panel::height_among(count), scale, vec![line])
    });
    let panels: Vec<_> = panels.collect();
    if panels.iter().all(Panel::is_empty) {
        return None;
    }
    let mut chart = chart(
        run,
        "priority-leak",
        "Priority leak",
        "Task acceleration that lower levels and the null space cause in every level, over time.",
    );
    chart.panels = panels;
    Some(Figure {
        file: "priority-leak.svg",
        caption: format!(
            "Priority leak: task acceleration of a level that the torque of everything below it causes on this arm. With an exact model it is rounding; what remains on a mismatched arm is the error of the controller's model. Zero is drawn at the lower edge.{}",
            shading(run)
        ),
        drawing: chart.draw(),
    })
}

fn conditioning(run: &Run<'_>) -> Option<Figure> {
    let recording = run.recording;
    let mut lines = Vec::new();
    for (number, level) in (1..).zip(&run.scenario.levels) {
        for axis in level.axes.chars() {
            let row = lines.len();
            if row < recording.rows().min(DOF) {
                let style = Style::new(row, [Stroke::Solid, Stroke::Dashed][row % 2]);
                let label = format!("level {number} {axis}");
                lines.push(Series::new(
                    label,
                    recording.t(),
                    recording.conditioning(row),
                    style,
                ));
            }
        }
    }
    let scale = Scale::Log {
        floor: CONDITIONING_FLOOR,
    };
    let mut panel = Panel::new("|R_kk| [1/\u{221a}kg]", 210.0, scale, lines);
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
    Some(Figure {
        file: "conditioning.svg",
        caption: format!(
            "Conditioning: |R_kk| of every task row, logarithmic. It says how far the row is from being unresolvable given the rows above it; a row below 10\u{207b}\u{2074} is dropped.{}",
            shading(run)
        ),
        drawing: chart.draw(),
    })
}

fn hand_force(run: &Run<'_>) -> Option<Figure> {
    let recording = run.recording;
    let line = Series::new("", recording.t(), recording.hand_force_n(), Style::solid(0));
    if line.is_empty() {
        return None;
    }
    let mut chart = chart(
        run,
        "hand-force",
        "Hand force",
        "Force of the simulated hand on the arm over time.",
    );
    chart.panels.push(Panel::new(
        "hand force [N]",
        190.0,
        Scale::FromZero,
        vec![line],
    ));
    Some(Figure {
        file: "hand-force.svg",
        caption: format!(
            "Force with which the hand moves the arm against its compliance.{}",
            shading(run)
        ),
        drawing: chart.draw(),
    })
}

fn path(run: &Run<'_>) -> Option<Figure> {
    let drawing = scene::paths(run)?;
    Some(Figure {
        file: "path.svg",
        caption: "Desired and true path of the controlled points, where the reference moves, and the deviation in the same plane, true less desired: a perfect follower stays at its zero.".into(),
        drawing,
    })
}

fn arm(run: &Run<'_>) -> Option<Figure> {
    let recording = run.recording;
    if recording.arms.is_empty() {
        return None;
    }
    let labels: Vec<_> = recording
        .arms
        .iter()
        .map(|arm| scene::instant(arm.t_s, &run.bands()))
        .collect();
    let title = format!("Arm postures \u{2013} {}", run.label());
    Some(Figure {
        file: "arm.svg",
        caption: "The arm as lines from the base plate over shoulder, elbow and wrist to the flange, at the start and while contacts press: the same task, other postures. Thin line: path of the first level\u{2019}s point.".into(),
        drawing: scene::postures(&title, &recording.arms, &labels, &scene::path_of(recording, 0)),
    })
}
