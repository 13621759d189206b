//! Drawings to scale: paths in their plane, and the arm as a stick figure.

mod view;

use super::plot::{Band, Stroke, Style};
use super::recording::{ArmSnapshot, Recording};
use super::run::Run;
use super::svg::{Anchor, Svg, text_width};

use view::{LEFT, View};

const AXES: [&str; 3] = ["x", "y", "z"];
/// Points of a drawn path.
const PATH_POINTS: usize = 900;
/// A reference that moves less than this is at rest \[m\].
const AT_REST: f64 = 1e-4;
const RIGHT: f64 = 16.0;
const BELOW: f64 = 44.0;

/// Every nth point, so that a closed curve keeps its shape.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let step = points.len().div_ceil(PATH_POINTS).max(1);
    points
        .iter()
        .step_by(step)
        .chain(points.last())
        .copied()
        .collect()
}

fn spread(values: &[f64]) -> f64 {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    (finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min)).max(0.0)
}

/// A legend in one row.
fn legend(svg: &mut Svg, [mut x, y]: [f64; 2], entries: &[(Style, String)]) {
    for (style, label) in entries {
        svg.line(&style.class(), [x, y], [x + 26.0, y]);
        svg.text("", [x + 32.0, y + 4.0], Anchor::Start, label);
        x += 50.0 + text_width(label, 12.0);
    }
}

/// Desired and true path of every level with at least two axes, and its
/// deviation; none if there is no such level.
#[must_use]
pub fn paths(run: &Run<'_>) -> Option<Svg> {
    const SIDE: f64 = 330.0;
    const TOP: f64 = 72.0;
    let recording = run.recording;
    let levels = run
        .scenario
        .levels
        .iter()
        .enumerate()
        .take(recording.levels());
    let drawn: Vec<_> = levels
        .filter(|(_, level)| level.axes.len() >= 2 && !recording.t().is_empty())
        .collect();
    if drawn.is_empty() {
        return None;
    }
    let step = SIDE + BELOW + TOP;
    let title = format!("Path \u{2013} {}", run.label());
    let mut svg = Svg::new(
        "path",
        [900.0, step * drawn.len() as f64 + 6.0],
        &title,
        "Desired and true path of the controlled points in their plane, and the deviation.",
    );
    svg.text("t", [LEFT, 16.0], Anchor::Start, &title);
    for (place, (index, level)) in drawn.into_iter().enumerate() {
        let top = place as f64 * step + TOP;
        let [a, b] = plane(recording, index, &level.axes);
        let moves = spread(recording.desired(index, a)) + spread(recording.desired(index, b));
        let series = |pick: fn(&Recording, usize, usize) -> &[f64]| {
            let (u, v) = (pick(recording, index, a), pick(recording, index, b));
            u.iter()
                .zip(v)
                .map(|(u, v)| [u * 1e3, v * 1e3])
                .collect::<Vec<_>>()
        };
        let (desired, actual) = (series(Recording::desired), series(Recording::actual));
        let pairs = desired.iter().zip(&actual);
        let deviation: Vec<_> = pairs.map(|(d, x)| [x[0] - d[0], x[1] - d[1]]).collect();
        let name = format!("Level {}, {}", index + 1, level.label());
        let solid = Style::solid(index);
        let wide = Style::new(6, Stroke::Wide);
        let mut left = LEFT;
        if moves > AT_REST {
            let corner = [left, top];
            let (desired, actual) = (thinned(&desired), thinned(&actual));
            let view = View::new(
                corner,
                [SIDE + 20.0, SIDE],
                desired.iter().chain(&actual),
                &[],
            );
            view.axes(
                &mut svg,
                [&format!("{} [mm]", AXES[a]), &format!("{} [mm]", AXES[b])],
            );
            svg.curve(&wide.class(), &view.pixels(&desired), "");
            svg.curve(
                &Style::new(index, Stroke::Thin).class(),
                &view.pixels(&actual),
                "",
            );
            svg.text("b", [left, top - 30.0], Anchor::Start, &name);
            let entries = [
                (wide, "desired".into()),
                (Style::new(index, Stroke::Thin), "true".into()),
            ];
            legend(&mut svg, [left, top - 14.0], &entries);
            left += SIDE + 20.0 + LEFT + 22.0;
        }
        let deviation = thinned(&deviation);
        let view = View::new(
            [left, top],
            [SIDE + 20.0, SIDE],
            deviation.iter(),
            &[[0.0, 0.0]],
        );
        view.axes(
            &mut svg,
            [
                &format!("\u{394}{} [mm]", AXES[a]),
                &format!("\u{394}{} [mm]", AXES[b]),
            ],
        );
        let ([x, y], [right, bottom]) = (view.pixel([0.0, 0.0]), view.far_corner());
        svg.line("axis", [left, y], [right, y]);
        svg.line("axis", [x, top], [x, bottom]);
        svg.curve(
            &Style::new(index, Stroke::Thin).class(),
            &view.pixels(&deviation),
            "",
        );
        svg.text(
            "b",
            [left, top - 30.0],
            Anchor::Start,
            &format!("{name}: deviation"),
        );
        legend(
            &mut svg,
            [left, top - 14.0],
            &[(solid, "true less desired".into())],
        );
    }
    Some(svg)
}

/// The two of a level's axes along which its reference, or if that rests its
/// point, moves most.
fn plane(recording: &Recording, level: usize, axes: &str) -> [usize; 2] {
    let own: Vec<_> = (0..3).filter(|&axis| axes.contains(AXES[axis])).collect();
    let rest = own
        .iter()
        .all(|&axis| spread(recording.desired(level, axis)) < AT_REST);
    let size = |axis: usize| {
        if rest {
            spread(recording.actual(level, axis))
        } else {
            spread(recording.desired(level, axis))
        }
    };
    let mut order = own;
    order.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    order.truncate(2);
    order.sort_unstable();
    [
        order.first().copied().unwrap_or(0),
        order.get(1).copied().unwrap_or(1),
    ]
}

/// The true path of a level's point \[m\].
#[must_use]
pub fn path_of(recording: &Recording, level: usize) -> Vec<[f64; 3]> {
    if level >= recording.levels() {
        return Vec::new();
    }
    let axis = |axis| recording.actual(level, axis);
    let pairs = axis(0).iter().zip(axis(1)).zip(axis(2));
    pairs.map(|((x, y), z)| [*x, *y, *z]).collect()
}

/// "start", "5.7 s (A)" or "5.7 s".
#[must_use]
pub fn instant(t_s: f64, bands: &[Band]) -> String {
    let inside = |band: &&Band| t_s >= band.from - 1e-9 && t_s <= band.to + 1e-9;
    match bands.iter().find(inside) {
        _ if !t_s.is_finite() => "\u{2013}".to_string(),
        _ if t_s <= 0.0 => "start".to_string(),
        Some(band) => format!("{t_s:.1} s ({})", band.label),
        None => format!("{t_s:.1} s"),
    }
}

/// The arm at several instants from the side and from the front, with a path.
#[must_use]
pub fn snapshots(arms: &[ArmSnapshot], path: &[[f64; 3]]) -> String {
    let labels: Vec<_> = arms.iter().map(|arm| instant(arm.t_s, &[])).collect();
    postures("Arm postures", arms, &labels, path).standalone()
}

/// The same with a title and a label for every instant.
#[must_use]
pub fn postures(title: &str, arms: &[ArmSnapshot], labels: &[String], path: &[[f64; 3]]) -> Svg {
    const SIZE: [f64; 2] = [350.0, 350.0];
    let mut svg = Svg::new(
        "arm",
        [900.0, 0.0],
        title,
        "The arm as a stick figure at several instants, from the side and from the front.",
    );
    svg.text("t", [LEFT, 16.0], Anchor::Start, title);
    // The legend wraps: there may be as many postures as contacts.
    let (mut x, mut y) = (LEFT, 38.0);
    for (k, label) in labels.iter().enumerate() {
        let width = 50.0 + text_width(label, 12.0);
        if x + width > 900.0 - RIGHT {
            (x, y) = (LEFT, y + 19.0);
        }
        legend(&mut svg, [x, y], &[(arm_style(k), label.clone())]);
        x += width;
    }
    let top = y + 38.0;
    let views = [([0, 2], "Side view"), ([1, 2], "Front view")];
    let flat = |[a, b]: [usize; 2], p: &[f64; 3]| [p[a], p[b]];
    // Both views have the same scale.
    let all = |axes| {
        arms.iter()
            .flat_map(|arm| arm.joints)
            .chain(path.iter().copied())
            .map(move |p| flat(axes, &p))
    };
    let fitted = views.map(|(axes, _)| {
        let points: Vec<_> = all(axes).collect();
        View::new([0.0, top], SIZE, points.iter(), &[[0.0, 0.0]])
    });
    let scale = fitted[0].scale.min(fitted[1].scale);
    for (k, (mut view, (axes, name))) in fitted.into_iter().zip(views).enumerate() {
        view.scale = scale;
        view.corner[0] = LEFT + k as f64 * (SIZE[0] + LEFT + 22.0);
        view.axes(
            &mut svg,
            [
                &format!("{} [m]", AXES[axes[0]]),
                &format!("{} [m]", AXES[axes[1]]),
            ],
        );
        svg.text("b", [view.corner[0], top - 9.0], Anchor::Start, name);
        let line: Vec<_> = path.iter().map(|p| flat(axes, p)).collect();
        svg.curve("axis", &view.pixels(&thinned(&line)), "");
        let [bx, by] = view.pixel([0.0, 0.0]);
        svg.line("wire", [bx - 22.0, by], [bx + 22.0, by]);
        for (index, arm) in arms.iter().enumerate() {
            let style = arm_style(index);
            let class = style.class();
            let joints: Vec<_> = arm
                .joints
                .iter()
                .map(|p| view.pixel(flat(axes, p)))
                .collect();
            let links: Vec<_> = std::iter::once([bx, by])
                .chain(joints.iter().copied())
                .collect();
            svg.curve(&class, &links, r#" style="stroke-width:3""#);
            for joint in joints {
                svg.circle(&format!("bg s{}", style.colour), joint, 3.2);
            }
        }
    }
    svg.with_height(top + SIZE[1] + BELOW)
}

fn arm_style(index: usize) -> Style {
    let index = (index + 6) % super::palette::COLOURS;
    Style::new(
        index,
        [Stroke::Solid, Stroke::Dashed][usize::from(index % 2 == 1)],
    )
}

#[cfg(test)]
mod tests {
    use super::super::svg::well_formed;
    use super::*;

    #[test]
    fn postures_are_drawn_whatever_they_are() {
        let arm = |z: f64| ArmSnapshot {
            t_s: z,
            joints: [
                [0.0, 0.0, 0.31],
                [0.1, 0.0, 0.6],
                [0.3, 0.1, z],
                [0.4, 0.1, z],
            ],
        };
        for arms in [
            vec![],
            vec![arm(0.5)],
            (0..40).map(|k| arm(f64::from(k))).collect(),
            vec![arm(f64::NAN)],
        ] {
            let file = snapshots(&arms, &[[0.4, 0.1, 0.5], [0.4, f64::NAN, 0.5]]);
            well_formed(&file).unwrap();
            assert!(!file.contains("NaN"));
        }
    }

    #[test]
    fn instants_name_their_contact() {
        let band = Band {
            from: 3.0,
            to: 6.0,
            label: "A".into(),
        };
        assert_eq!(instant(5.7, std::slice::from_ref(&band)), "5.7 s (A)");
        assert_eq!(instant(0.0, &[band]), "start");
        assert_eq!(instant(7.0, &[]), "7.0 s");
    }
}
