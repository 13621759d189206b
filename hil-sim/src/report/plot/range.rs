//! Ranges of axes and the way from values to pixels.

use super::super::ticks::{self, Ticks};
use super::chart::{Panel, Scale};

/// A limit this many times above the data still widens the axis; beyond, it
/// would flatten the lines and is only named.
const LIMIT_REACH: f64 = 3.0;

/// Values beyond this are drawn at the edge.
const HUGE: f64 = 1e30;

/// One axis: values `low..=high` onto pixels `from..=to`.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    log: bool,
}

impl Axis {
    /// An even axis.
    pub fn linear([low, high]: [f64; 2], [from, to]: [f64; 2]) -> Self {
        Self {
            low,
            high,
            from,
            to,
            log: false,
        }
    }

    /// The vertical axis of a panel between two pixels, the lower one first.
    pub fn of(panel: &Panel, pixels: [f64; 2]) -> Self {
        Self {
            log: panel.is_log(),
            ..Self::linear(vertical(panel), pixels)
        }
    }

    /// The pixel of a value; NaN stays NaN.
    pub fn pixel(&self, value: f64) -> f64 {
        let share = if self.log {
            // As `max`, but for NaN.
            let value = if value < self.low { self.low } else { value };
            (value / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.from + share * (self.to - self.from)
    }

    /// Whether a value lies on the axis.
    pub fn holds(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }

    /// Round values along it, about one for every `spacing` pixels.
    pub fn ticks(&self, spacing: f64) -> Ticks {
        let count = (((self.to - self.from).abs() / spacing) as usize).max(2);
        if self.log {
            return ticks::logarithmic(self.low, self.high, count);
        }
        // Two values at least, or nothing can be read off.
        let mut ticks = ticks::linear(self.low, self.high, count);
        for more in count + 1..2 * count + 2 {
            if ticks.major.len() > 1 {
                break;
            }
            ticks = ticks::linear(self.low, self.high, more);
        }
        ticks
    }
}

/// Smallest and largest finite value, if any.
fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values
        .filter(|v| v.is_finite())
        .map(|v| v.clamp(-HUGE, HUGE))
        .fold(None, |extent: Option<[f64; 2]>, v| {
            Some(extent.map_or([v, v], |[low, high]| [low.min(v), high.max(v)]))
        })
}

/// Ends of the horizontal axis: as given, or those of the data.
pub fn horizontal(given: Option<[f64; 2]>, panels: &[Panel]) -> [f64; 2] {
    let data = || {
        let lines = panels.iter().flat_map(|panel| &panel.series);
        extent(lines.flat_map(|line| line.points.iter().map(|p| p[0])))
    };
    let usable = |[low, high]: &[f64; 2]| low.is_finite() && high.is_finite() && high > low;
    given
        .filter(usable)
        .or_else(data)
        .map_or([0.0, 1.0], |[low, high]| {
            if high > low {
                [low, high]
            } else {
                [low, low + 1.0]
            }
        })
}

fn vertical(panel: &Panel) -> [f64; 2] {
    if let Scale::Within(ends) = panel.scale {
        return ends;
    }
    let values = || {
        panel
            .series
            .iter()
            .flat_map(|line| line.points.iter().map(|p| p[1]))
    };
    let limits = panel
        .limits
        .iter()
        .map(|limit| limit.value)
        .filter(|v| v.is_finite());
    if let Scale::Log { floor } = panel.scale {
        let [low, high] =
            extent(values().filter(|&v| v > 0.0).chain(limits)).unwrap_or([floor, 1.0]);
        let low = low.max(floor);
        let high = high.max(low);
        // Some air, and at least most of a decade.
        let pad = (high / low).powf(0.06).max(1.6);
        return [(low / pad).max(floor * 0.8), high * pad];
    }
    let data = extent(values());
    let largest = data.map_or(0.0, |[low, high]| low.abs().max(high.abs()));
    let near = limits.filter(|v| data.is_none() || v.abs() <= LIMIT_REACH * largest);
    let zero = (panel.scale == Scale::FromZero).then_some(0.0);
    let all = data.into_iter().flatten().chain(near).chain(zero);
    let Some([low, high]) = extent(all) else {
        return [0.0, 1.0];
    };
    if high - low <= 1e-9 * largest || high <= low {
        let air = if largest > 0.0 { 0.2 * largest } else { 1.0 };
        let from_zero = zero.is_some() && low >= 0.0;
        return [if from_zero { 0.0 } else { low - air }, high + air];
    }
    let pad = 0.06 * (high - low);
    let is_zero = |edge: f64| zero.is_some() && edge == 0.0;
    [
        if is_zero(low) { low } else { low - pad },
        if is_zero(high) { high } else { high + pad },
    ]
}
