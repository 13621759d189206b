//! Where everything of a chart goes.
//!
//! Title, legend and letters stand above the plot areas, labels of limits and
//! line ends to their right: nothing is written over the data.

use super::super::svg::{Anchor, Svg, text_width};
use super::super::ticks::Ticks;
use super::bars;
use super::chart::{Chart, Panel, Style};
use super::decimate::decimate;
use super::range::{self, Axis};

/// Most points of a drawn line.
const POINTS: usize = 1500;
const FONT: f64 = 12.0;
const TITLE: f64 = 22.0;
const LEGEND_ROW: f64 = 19.0;
const LETTER_ROW: f64 = 15.0;
/// Rows of letters, for intervals that stand close.
const LETTER_ROWS: usize = 3;
const GAP: f64 = 16.0;
const SAMPLE: f64 = 26.0;
/// Labelled ticks of the vertical axis are about this far apart.
const TICK_STEP: f64 = 34.0;
/// Baselines of labels on the right are at least this far apart.
const LABEL_STEP: f64 = 13.0;

/// Left and right edge of the plot areas.
struct Frame {
    left: f64,
    right: f64,
    x: Axis,
}

/// A text over the bands.
struct Letter {
    x: f64,
    row: usize,
    class: &'static str,
    text: String,
}

impl Chart {
    /// Draws it.
    #[must_use]
    pub fn draw(&self) -> Svg {
        let ranges = range::horizontal(self.x_range, &self.panels);
        let left = left_margin(self);
        let right = self.width - right_margin(self);
        let x = Axis::linear(ranges, [left, right]);
        let frame = Frame { left, right, x };

        let entries = legend(self, left);
        let legend_rows = entries
            .iter()
            .map(|(_, at, _)| at[1] as usize + 1)
            .max()
            .unwrap_or(0);
        let letters = letters(self, &frame);
        let letter_rows = letters
            .iter()
            .map(|letter| letter.row + 1)
            .max()
            .unwrap_or(0);
        let legend_top = if self.title.is_empty() {
            4.0
        } else {
            TITLE + 4.0
        };
        let letters_top = legend_top + legend_rows as f64 * LEGEND_ROW;
        let top = letters_top + (letter_rows as f64 * LETTER_ROW).max(6.0) + 2.0;
        let heights: f64 = self.panels.iter().map(|panel| panel.height + GAP).sum();
        let bottom = top + heights - GAP;
        let height = bottom + 42.0;

        let mut svg = Svg::new(
            &self.id,
            [self.width, height],
            &self.title,
            &self.description,
        );
        if !self.title.is_empty() {
            svg.text("t", [left, 16.0], Anchor::Start, &self.title);
        }
        for (style, [x, row], label) in &entries {
            let y = legend_top + row * LEGEND_ROW + 9.0;
            svg.line(&style.class(), [*x, y], [x + SAMPLE, y]);
            svg.text("", [x + SAMPLE + 6.0, y + 4.0], Anchor::Start, label);
        }
        for letter in &letters {
            // The lowest row belongs to the first letters.
            let row = (letter_rows - 1 - letter.row) as f64;
            let y = letters_top + row * LETTER_ROW + 12.0;
            svg.text(letter.class, [letter.x, y], Anchor::Middle, &letter.text);
        }
        let mut y = top;
        for (index, panel) in self.panels.iter().enumerate() {
            let last = index + 1 == self.panels.len();
            draw_panel(&mut svg, self, panel, &frame, y, index, last);
            y += panel.height + GAP;
        }
        let middle = 0.5 * (frame.left + frame.right);
        svg.text("m", [middle, bottom + 34.0], Anchor::Middle, &self.x_label);
        svg
    }
}

fn draw_panel(
    svg: &mut Svg,
    chart: &Chart,
    panel: &Panel,
    frame: &Frame,
    top: f64,
    index: usize,
    last: bool,
) {
    let &Frame { left, right, x } = frame;
    let bottom = top + panel.height;
    let size = [right - left, panel.height];
    let y = Axis::of(panel, [bottom, top]);
    for (from, to) in visible_bands(chart, frame) {
        svg.rect("band", [from, top], [(to - from).max(0.6), panel.height]);
    }
    let across = x.ticks(80.0);
    // Rows of bars have no vertical axis.
    let up = match panel.strips.as_slice() {
        [] => y.ticks(TICK_STEP),
        _ => Ticks::default(),
    };
    grid(svg, &across, &up, frame, &y, [top, bottom]);
    for (from, to) in visible_bands(chart, frame) {
        svg.line("edge", [from, top], [from, bottom]);
        svg.line("edge", [to, top], [to, bottom]);
    }
    for (value, text) in &up.major {
        svg.text("m", [left - 7.0, y.pixel(*value) + 4.0], Anchor::End, text);
    }
    bars::strips(svg, panel, &x, [left, right], top);
    bars::edges(svg, panel, &x, [left, right], [top, bottom]);
    if last {
        for (value, text) in &across.major {
            svg.line(
                "axis",
                [x.pixel(*value), bottom],
                [x.pixel(*value), bottom + 4.0],
            );
            svg.text("m", [x.pixel(*value), bottom + 17.0], Anchor::Middle, text);
        }
    }
    let clip = svg.clip([left, top - 2.0], [size[0], size[1] + 4.0], index);
    let most = if chart.panels.len() > 3 {
        POINTS * 2 / 3
    } else {
        POINTS
    };
    for line in &panel.series {
        let points: Vec<_> = decimate(&line.points, most)
            .iter()
            .map(|p| [x.pixel(p[0]), y.pixel(p[1])])
            .collect();
        svg.curve(&line.style.class(), &points, &clip);
    }
    if panel.is_empty() {
        let middle = [0.5 * (left + right), 0.5 * (top + bottom) + 4.0];
        svg.text("m halo", middle, Anchor::Middle, "no data");
    }
    for limit in panel.limits.iter().filter(|limit| y.holds(limit.value)) {
        let at = y.pixel(limit.value);
        svg.line("limit", [left, at], [right, at]);
    }
    for mark in chart.marks.iter().filter(|mark| x.holds(mark.at)) {
        svg.line("mark", [x.pixel(mark.at), top], [x.pixel(mark.at), bottom]);
    }
    right_labels(svg, panel, right, &y, [top, bottom]);
    svg.curve("axis", &[[left, top], [left, bottom], [right, bottom]], "");
    svg.text_upwards("m", [14.0, 0.5 * (top + bottom)], &panel.y_label);
}

fn grid(
    svg: &mut Svg,
    across: &Ticks,
    up: &Ticks,
    frame: &Frame,
    y: &Axis,
    [top, bottom]: [f64; 2],
) {
    for &value in &up.minor {
        svg.line(
            "grid minor",
            [frame.left, y.pixel(value)],
            [frame.right, y.pixel(value)],
        );
    }
    for (value, _) in &up.major {
        svg.line(
            "grid",
            [frame.left, y.pixel(*value)],
            [frame.right, y.pixel(*value)],
        );
    }
    for (value, _) in &across.major {
        svg.line(
            "grid",
            [frame.x.pixel(*value), top],
            [frame.x.pixel(*value), bottom],
        );
    }
}

/// Labels of limits and line ends, moved apart where they would touch.
fn right_labels(svg: &mut Svg, panel: &Panel, right: f64, y: &Axis, [top, bottom]: [f64; 2]) {
    let limits = panel
        .limits
        .iter()
        .filter(|limit| limit.value.is_finite())
        .map(|limit| {
            if y.holds(limit.value) {
                (y.pixel(limit.value), "lim".to_string(), limit.label.clone())
            } else {
                (top, "lim".to_string(), format!("{} \u{2191}", limit.label))
            }
        });
    let ends = panel
        .series
        .iter()
        .filter(|_| panel.end_labels)
        .filter_map(|line| {
            let last = line.points.iter().rev().find(|p| p[1].is_finite())?;
            let class = format!("b f{}", line.style.colour % super::super::palette::COLOURS);
            Some((
                y.pixel(last[1]).clamp(top, bottom),
                class,
                line.label.clone(),
            ))
        });
    let mut labels: Vec<_> = limits.chain(ends).collect();
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wanted: Vec<_> = labels.iter().map(|label| label.0).collect();
    for ((_, class, text), at) in labels.iter().zip(apart(&wanted, [top, bottom])) {
        svg.text(class, [right + 7.0, at + 4.0], Anchor::Start, text);
    }
}

/// The wanted heights, in order, moved so that they are a label apart.
fn apart(wanted: &[f64], [top, bottom]: [f64; 2]) -> Vec<f64> {
    let mut at = wanted.to_vec();
    for k in 1..at.len() {
        at[k] = at[k].max(at[k - 1] + LABEL_STEP);
    }
    // What was pushed out at the bottom pushes back.
    let mut floor = bottom.max(top + LABEL_STEP * at.len() as f64);
    for value in at.iter_mut().rev() {
        *value = value.min(floor);
        floor = *value - LABEL_STEP;
    }
    at
}

/// Entries of the legend: style, left edge and row, label.
fn legend(chart: &Chart, left: f64) -> Vec<(Style, [f64; 2], String)> {
    let mut entries: Vec<(Style, [f64; 2], String)> = Vec::new();
    let (mut x, mut row) = (left, 0.0);
    let lines = chart.panels.iter().filter(|panel| !panel.end_labels);
    for line in lines.flat_map(|panel| &panel.series) {
        let known =
            |entry: &(Style, [f64; 2], String)| entry.2 == line.label && entry.0 == line.style;
        if line.label.is_empty() || entries.iter().any(known) {
            continue;
        }
        let width = SAMPLE + 6.0 + text_width(&line.label, FONT) + 18.0;
        if x > left && x + width > chart.width {
            x = left;
            row += 1.0;
        }
        entries.push((line.style, [x, row], line.label.clone()));
        x += width;
    }
    entries
}

fn visible_bands<'a>(chart: &'a Chart, frame: &'a Frame) -> impl Iterator<Item = (f64, f64)> + 'a {
    chart.bands.iter().filter_map(|band| {
        let clamp = |t: f64| frame.x.pixel(t).clamp(frame.left, frame.right);
        let (from, to) = (clamp(band.from), clamp(band.to));
        (to > from).then_some((from, to))
    })
}

/// Letters of bands and texts of marks, in as many rows as keep them apart.
fn letters(chart: &Chart, frame: &Frame) -> Vec<Letter> {
    let clamp = |t: f64| frame.x.pixel(t).clamp(frame.left, frame.right);
    let bands = chart
        .bands
        .iter()
        .filter(|band| clamp(band.to) > clamp(band.from));
    let bands = bands.map(|band| (0.5 * (clamp(band.from) + clamp(band.to)), "l", &band.label));
    let marks = chart.marks.iter().filter(|mark| frame.x.holds(mark.at));
    let marks = marks.map(|mark| (frame.x.pixel(mark.at), "lim b", &mark.label));
    let mut rows = [f64::NEG_INFINITY; LETTER_ROWS];
    let mut letters = Vec::new();
    let mut all: Vec<_> = bands.chain(marks).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (x, class, text) in all {
        let half = 0.5 * text_width(text, FONT) + 2.0;
        let x = x.clamp(frame.left, (chart.width - half).max(frame.left));
        if let Some(row) = rows.iter().position(|&end| x - half >= end) {
            rows[row] = x + half;
            let text = text.clone();
            letters.push(Letter {
                x,
                row,
                class,
                text,
            });
        }
    }
    letters
}

/// Room for tick labels and the axis title.
fn left_margin(chart: &Chart) -> f64 {
    let widths = chart.panels.iter().flat_map(|panel| {
        let axis = Axis::of(panel, [panel.height, 0.0]);
        let texts: Vec<_> = match panel.strips.as_slice() {
            [] => (axis.ticks(TICK_STEP).major.into_iter())
                .map(|(_, text)| text)
                .collect(),
            strips => strips.iter().map(|strip| strip.label.clone()).collect(),
        };
        texts.into_iter().map(|text| text_width(&text, FONT))
    });
    widths.fold(24.0, f64::max) + 34.0
}

/// Room for labels of limits and line ends.
fn right_margin(chart: &Chart) -> f64 {
    let widths = chart.panels.iter().flat_map(|panel| {
        let limits = panel
            .limits
            .iter()
            .map(|limit| text_width(&limit.label, FONT) + 14.0);
        let ends = panel.series.iter().filter(|_| panel.end_labels);
        limits.chain(ends.map(|line| text_width(&line.label, FONT)))
    });
    widths.fold(6.0, f64::max) + 14.0
}
