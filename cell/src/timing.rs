//! Histograms of what a cycle takes.

use std::time::Duration;

use hdrhistogram::Histogram;
use serde::Serialize;

/// Longest time that is told apart \[us\]; longer ones count as this.
const LONGEST_US: u64 = 10_000_000;

/// Times in steps of 0.1 us, with three significant digits.
#[derive(Clone, Debug)]
pub struct Times {
    histogram: Histogram<u64>,
}

/// The figures of a histogram \[us\].
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TimeFigures {
    /// Number of times.
    pub count: u64,
    /// Half are below.
    pub p50_us: f64,
    /// 99 % are below.
    pub p99_us: f64,
    /// 99.9 % are below.
    pub p999_us: f64,
    /// The longest.
    pub max_us: f64,
}

impl Times {
    /// No times. All memory is taken here.
    #[must_use]
    pub fn new() -> Self {
        let histogram = Histogram::new_with_bounds(1, LONGEST_US * 10, 3);
        Self {
            histogram: histogram.unwrap_or_else(|error| unreachable!("constant bounds: {error}")),
        }
    }

    /// Adds one.
    pub fn add(&mut self, time: Duration) {
        let tenths = time.as_nanos() / 100;
        let tenths = u64::try_from(tenths).unwrap_or(u64::MAX);
        self.histogram.saturating_record(tenths.max(1));
    }

    /// The figures so far; zeros without times.
    #[must_use]
    pub fn figures(&self) -> TimeFigures {
        let at = |quantile| self.histogram.value_at_quantile(quantile) as f64 / 10.0;
        TimeFigures {
            count: self.histogram.len(),
            p50_us: at(0.5),
            p99_us: at(0.99),
            p999_us: at(0.999),
            max_us: self.histogram.max() as f64 / 10.0,
        }
    }
}

impl Default for Times {
    fn default() -> Self {
        Self::new()
    }
}

impl std::fmt::Display for TimeFigures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "p50 {:.1} us, p99 {:.1} us, p99.9 {:.1} us, max {:.1} us",
            self.p50_us, self.p99_us, self.p999_us, self.max_us
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_times() {
        let mut times = Times::new();
        for us in 1..=1000 {
            times.add(Duration::from_micros(us));
        }
        let figures = times.figures();
        assert_eq!(figures.count, 1000);
        // Three significant digits.
        assert!((figures.p50_us - 500.0).abs() <= 1.0, "{figures}");
        assert!((figures.p99_us - 990.0).abs() <= 1.0, "{figures}");
        assert!((figures.max_us - 1000.0).abs() <= 1.0, "{figures}");
    }

    #[test]
    fn extremes_are_kept() {
        let mut times = Times::new();
        times.add(Duration::ZERO);
        times.add(Duration::from_secs(3600));
        assert!(times.figures().max_us >= 9.9e6);
    }
}
