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
/// Size of a path's plot area \[px\].
const AREA: [f64; 2] = [350.0, 330.0];
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
fn legend(svg: &mut Svg, [mut x, y]: [f64; 2], entries: &[(Style, &str)]) {
    for (style, label) in entries {
        svg.line(&style.class(), [x, y], [x + 26.0, y]);
        svg.text("", [x + 32.0, y + 4.0], Anchor::Start, label);
        x += entry_width(label);
    }
}

fn entry_width(label: &str) -> f64 {
    50.0 + text_width(label, 12.0)
}

/// Curves \[mm\] in a plot area under a name and a legend, around zero if that is what
/// they deviate from.
struct Area<'a> {
    name: &'a str,
    axes: [String; 2],
    around_zero: bool,
    curves: &'a [(Style, Vec<[f64; 2]>)],
    legend: &'a [(Style, &'a str)],
}

impl Area<'_> {
    fn draw(&self, svg: &mut Svg, [left, top]: [f64; 2]) {
        let points = self.curves.iter().flat_map(|(_, points)| points);
        let zero = self.around_zero.then_some(&[0.0, 0.0]);
        let view = View::new([left, top], AREA, points.chain(zero));
        view.axes(svg, &self.axes);
        if self.around_zero {
            let ([x, y], [right, bottom]) = (view.pixel([0.0, 0.0]), view.far_corner());
            svg.line("axis", [left, y], [right, y]);
            svg.line("axis", [x, top], [x, bottom]);
        }
        for (style, points) in self.curves {
            svg.curve(&style.class(), &view.pixels(points), "");
        }
        svg.text("b", [left, top - 30.0], Anchor::Start, self.name);
        legend(svg, [left, top - 14.0], self.legend);
    }
}

/// Desired and true path of every level with at least two axes, and its
/// deviation; none if there is no such level.
#[must_use]
pub fn paths(run: &Run<'_>) -> Option<Svg> {
    const TOP: f64 = 72.0;
    let recording = run.recording;
    let levels = (run.scenario.levels.iter().enumerate()).take(recording.levels());
    let drawn: Vec<_> = levels
        .filter(|(_, level)| level.axes.len() >= 2 && !recording.t().is_empty())
        .collect();
    if drawn.is_empty() {
        return None;
    }
    let step = AREA[1] + BELOW + TOP;
    let title = format!("Path \u{2013} {}", run.label());
    let mut svg = Svg::new(
        "path",
        [900.0, step * drawn.len() as f64 + 6.0],
        &title,
        "Desired and true path of the controlled points in their plane, and the deviation.",
    );
    svg.text("t", [LEFT, 16.0], Anchor::Start, &title);
    for (place, (index, level)) in drawn.into_iter().enumerate() {
        let [a, b] = plane(recording, index, &level.axes);
        let moves = spread(recording.desired(index, a)) + spread(recording.desired(index, b));
        let series = |pick: fn(&Recording, usize, usize) -> &[f64]| {
            let pairs = pick(recording, index, a)
                .iter()
                .zip(pick(recording, index, b));
            pairs.map(|(u, v)| [u * 1e3, v * 1e3]).collect::<Vec<_>>()
        };
        let (desired, actual) = (series(Recording::desired), series(Recording::actual));
        let pairs = desired.iter().zip(&actual);
        let deviation: Vec<_> = pairs.map(|(d, x)| [x[0] - d[0], x[1] - d[1]]).collect();
        let name = format!("Level {}, {}", index + 1, level.label());
        let (wide, thin) = (Style::new(6, Stroke::Wide), Style::new(index, Stroke::Thin));
        let mut corner = [LEFT, place as f64 * step + TOP];
        if moves > AT_REST {
            let path = Area {
                name: &name,
                axes: [a, b].map(|axis| format!("{} [mm]", AXES[axis])),
                around_zero: false,
                curves: &[(wide, thinned(&desired)), (thin, thinned(&actual))],
                legend: &[(wide, "desired"), (thin, "true")],
            };
            path.draw(&mut svg, corner);
            corner[0] += AREA[0] + LEFT + 22.0;
        }
        let deviation = Area {
            name: &format!("{name}: deviation"),
            axes: [a, b].map(|axis| format!("\u{394}{} [mm]", AXES[axis])),
            around_zero: true,
            curves: &[(thin, thinned(&deviation))],
            legend: &[(Style::solid(index), "true less desired")],
        };
        deviation.draw(&mut svg, corner);
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
    [0, 1].map(|k| order.get(k).copied().unwrap_or(k))
}

/// The true path of the first level's point \[m\].
fn first_path(recording: &Recording) -> Vec<[f64; 3]> {
    if recording.levels() == 0 {
        return Vec::new();
    }
    let axis = |axis| recording.actual(0, axis);
    let pairs = axis(0).iter().zip(axis(1)).zip(axis(2));
    pairs.map(|((x, y), z)| [*x, *y, *z]).collect()
}

/// "start", "5.7 s (A)" or "5.7 s".
fn instant(t_s: f64, bands: &[Band]) -> String {
    let inside = |band: &&Band| t_s >= band.from - 1e-9 && t_s <= band.to + 1e-9;
    match bands.iter().find(inside) {
        _ if !t_s.is_finite() => "\u{2013}".to_string(),
        _ if t_s <= 0.0 => "start".to_string(),
        Some(band) => format!("{t_s:.1} s ({})", band.label),
        None => format!("{t_s:.1} s"),
    }
}

/// The arm at several instants from the side and from the front, with the path of the
/// first level's point.
#[must_use]
pub fn postures(run: &Run<'_>, title: &str) -> Svg {
    let (arms, bands) = (&run.recording.arms, run.bands());
    let labels: Vec<_> = arms.iter().map(|arm| instant(arm.t_s, &bands)).collect();
    let gravity = run.recording.arm().parameters.gravity;
    stick_figures(title, arms, &labels, &first_path(run.recording), gravity)
}

/// Where gravity points, in the upper right corner of a view that ends at `right` and begins
/// at `top`; nothing where it points into the view.
fn gravity_arrow(svg: &mut Svg, [right, top]: [f64; 2], [x, y]: [f64; 2]) {
    const LENGTH: f64 = 36.0;
    let size = x.hypot(y);
    if size < 1.0 {
        return;
    }
    let along = [x / size, -y / size];
    let at = |forward: f64, aside: f64| {
        [
            right - 30.0 + along[0] * forward - along[1] * aside,
            top + 30.0 + along[1] * forward + along[0] * aside,
        ]
    };
    let tip = at(LENGTH / 2.0, 0.0);
    svg.line("wire", at(-LENGTH / 2.0, 0.0), tip);
    for aside in [-5.0, 5.0] {
        svg.line("wire", tip, at(LENGTH / 2.0 - 8.0, aside));
    }
    let [x, y] = at(0.0, 14.0);
    svg.text("m", [x, y + 4.0], Anchor::Middle, "g");
}

fn stick_figures(
    title: &str,
    arms: &[ArmSnapshot],
    labels: &[String],
    path: &[[f64; 3]],
    gravity: [f64; 3],
) -> Svg {
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
        let width = entry_width(label);
        if x + width > 900.0 - RIGHT {
            (x, y) = (LEFT, y + 19.0);
        }
        legend(&mut svg, [x, y], &[(arm_style(k), label)]);
        x += width;
    }
    let top = y + 38.0;
    let views = [([0, 2], "Side view"), ([1, 2], "Front view")];
    let flat = |[a, b]: [usize; 2], p: &[f64; 3]| [p[a], p[b]];
    // Both views have the same scale.
    let all = |axes| {
        arms.iter()
            .flat_map(|arm| arm.corners.iter().copied())
            .chain(path.iter().copied())
            .map(move |p| flat(axes, &p))
    };
    let fitted = views.map(|(axes, _)| {
        let points: Vec<_> = all(axes).collect();
        View::new([0.0, top], SIZE, points.iter().chain(&[[0.0, 0.0]]))
    });
    let scale = fitted[0].scale.min(fitted[1].scale);
    for (k, (mut view, (axes, name))) in fitted.into_iter().zip(views).enumerate() {
        view.scale = scale;
        view.corner[0] = LEFT + k as f64 * (SIZE[0] + LEFT + 22.0);
        view.axes(&mut svg, &axes.map(|axis| format!("{} [m]", AXES[axis])));
        svg.text("b", [view.corner[0], top - 9.0], Anchor::Start, name);
        let line: Vec<_> = path.iter().map(|p| flat(axes, p)).collect();
        svg.curve("axis", &view.pixels(&thinned(&line)), "");
        let [bx, by] = view.pixel([0.0, 0.0]);
        svg.line("wire", [bx - 22.0, by], [bx + 22.0, by]);
        // Of an arm that stands upright it is where one expects it.
        if gravity[0] != 0.0 || gravity[1] != 0.0 || gravity[2] > 0.0 {
            let corner = [view.far_corner()[0], view.corner[1]];
            gravity_arrow(&mut svg, corner, flat(axes, &gravity));
        }
        for (index, arm) in arms.iter().enumerate() {
            let style = arm_style(index);
            let corners: Vec<_> = arm
                .corners
                .iter()
                .map(|p| view.pixel(flat(axes, p)))
                .collect();
            svg.curve(&style.class(), &corners, r#" style="stroke-width:3""#);
            for corner in corners.into_iter().skip(1) {
                svg.circle(&format!("bg s{}", style.colour), corner, 3.2);
            }
        }
    }
    svg.with_height(top + SIZE[1] + BELOW)
}

fn arm_style(index: usize) -> Style {
    Style::alternating((index + 6) % super::palette::COLOURS)
}

#[cfg(test)]
mod tests {
    use super::super::svg::well_formed;
    use super::*;

    #[test]
    fn postures_are_drawn_whatever_they_are() {
        let arm = |z: f64| ArmSnapshot {
            t_s: z,
            corners: vec![
                [0.0, 0.0, 0.0],
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
            let labels: Vec<_> = arms.iter().map(|arm| instant(arm.t_s, &[])).collect();
            let path = [[0.4, 0.1, 0.5], [0.4, f64::NAN, 0.5]];
            for gravity in [[0.0, 0.0, -9.81], [0.0, 0.0, 9.81], [9.81, 0.0, 0.0]] {
                let file = stick_figures("Arm", &arms, &labels, &path, gravity).standalone();
                well_formed(&file).unwrap();
                assert!(!file.contains("NaN"));
                assert_eq!(file.contains(">g</text>"), gravity[2] >= 0.0);
            }
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
