//! A plot area to scale.

use super::super::svg::{Anchor, Svg};
use super::super::ticks;

/// Room for tick labels and the title of the vertical axis \[px\].
pub const LEFT: f64 = 66.0;

/// A plot area with the same scale on both axes.
pub struct View {
    pub corner: [f64; 2],
    size: [f64; 2],
    centre: [f64; 2],
    pub scale: f64,
}

impl View {
    /// Fits all points into the area at `corner`.
    pub fn new<'a>(
        corner: [f64; 2],
        size: [f64; 2],
        points: impl Iterator<Item = &'a [f64; 2]>,
    ) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for point in points.filter(|p| p[0].is_finite() && p[1].is_finite()) {
            for k in 0..2 {
                low[k] = low[k].min(point[k].clamp(-1e9, 1e9));
                high[k] = high[k].max(point[k].clamp(-1e9, 1e9));
            }
        }
        if low[0] > high[0] {
            (low, high) = ([-1.0; 2], [1.0; 2]);
        }
        let span = |k: usize| (1.12 * (high[k] - low[k])).max(1e-9);
        Self {
            corner,
            size,
            centre: [0, 1].map(|k| 0.5 * (low[k] + high[k])),
            scale: (size[0] / span(0)).min(size[1] / span(1)),
        }
    }

    pub fn pixel(&self, point: [f64; 2]) -> [f64; 2] {
        [
            self.corner[0] + 0.5 * self.size[0] + (point[0] - self.centre[0]) * self.scale,
            self.corner[1] + 0.5 * self.size[1] - (point[1] - self.centre[1]) * self.scale,
        ]
    }

    pub fn pixels(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        points.iter().map(|&p| self.pixel(p)).collect()
    }

    pub fn far_corner(&self) -> [f64; 2] {
        [0, 1].map(|k| self.corner[k] + self.size[k])
    }

    /// Grid, tick labels and titles of both axes.
    pub fn axes(&self, svg: &mut Svg, labels: &[String; 2]) {
        let [left, top] = self.corner;
        let [right, bottom] = self.far_corner();
        let range = |k: usize| {
            let half = 0.5 * self.size[k] / self.scale;
            [self.centre[k] - half, self.centre[k] + half]
        };
        // The same step on both axes, wide enough for the labels of the
        // horizontal one.
        let spacing = 60.0 / self.scale;
        let [low, high] = range(0);
        for (value, text) in ticks::spaced(low, high, spacing).major {
            let x = self.pixel([value, 0.0])[0];
            svg.line("grid", [x, top], [x, bottom]);
            svg.text("m", [x, bottom + 17.0], Anchor::Middle, &text);
        }
        let [low, high] = range(1);
        for (value, text) in ticks::spaced(low, high, spacing).major {
            let y = self.pixel([0.0, value])[1];
            svg.line("grid", [left, y], [right, y]);
            svg.text("m", [left - 7.0, y + 4.0], Anchor::End, &text);
        }
        svg.curve("axis", &[[left, top], [left, bottom], [right, bottom]], "");
        svg.text(
            "m",
            [0.5 * (left + right), bottom + 34.0],
            Anchor::Middle,
            &labels[0],
        );
        svg.text_upwards("m", [left - LEFT + 15.0, 0.5 * (top + bottom)], &labels[1]);
    }
}
