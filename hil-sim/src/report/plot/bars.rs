//! Bars: when something was so.

use super::super::palette::COLOURS;
use super::super::svg::{Anchor, Svg};
use super::chart::{Panel, STRIP};
use super::range::Axis;

/// Height of a bar in its row, and of one along an edge \[px\].
const BAR: f64 = 11.0;
const EDGE: f64 = 5.0;

/// What is shorter is drawn so wide \[px\].
const NARROWEST: f64 = 1.2;

/// The rows of a panel that begins at `top`, with their labels.
pub fn strips(svg: &mut Svg, panel: &Panel, x: &Axis, [left, right]: [f64; 2], top: f64) {
    for (row, strip) in panel.strips.iter().enumerate() {
        let y = top + STRIP * row as f64;
        let middle = y + 0.5 * STRIP;
        svg.line("grid", [left, middle], [right, middle]);
        svg.text("m", [left - 7.0, middle + 4.0], Anchor::End, &strip.label);
        let class = format!("f{}", strip.colour % COLOURS);
        bars(
            svg,
            &class,
            &strip.spans,
            x,
            [left, right],
            [middle - 0.5 * BAR, BAR],
        );
    }
}

/// Along the edges of a panel between `top` and `bottom`.
pub fn edges(svg: &mut Svg, panel: &Panel, x: &Axis, sides: [f64; 2], [top, bottom]: [f64; 2]) {
    for (spans, y) in panel.edges.iter().zip([top, bottom - EDGE]) {
        bars(svg, "lim", spans, x, sides, [y, EDGE]);
    }
}

fn bars(
    svg: &mut Svg,
    class: &str,
    spans: &[[f64; 2]],
    x: &Axis,
    [left, right]: [f64; 2],
    [y, height]: [f64; 2],
) {
    for &[from, to] in spans {
        let [from, to] = [from, to].map(|t| x.pixel(t).clamp(left, right));
        let width = (to - from).max(NARROWEST);
        svg.rect(class, [from.min(right - width), y], [width, height]);
    }
}
