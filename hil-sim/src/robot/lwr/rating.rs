//! How good the link is: statistics of the answers to the last cycles, and the
//! level that they add up to.

use fri::Quality;

use super::options::RatingOptions;

/// Cycles that count.
pub const WINDOW: usize = 100;

/// Statistics of the window, as a measurement datagram carries them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Share of cycles answered in time.
    pub answer_rate: f64,
    /// Mean time from a measurement to its answer, of answers in time \[s\].
    pub latency_s: f64,
    /// Standard deviation of that time \[s\].
    pub jitter_s: f64,
    /// Share of cycles without answer in time.
    pub miss_rate: f64,
}

/// The answers to the last 100 cycles.
#[derive(Clone, Debug)]
pub struct Rating {
    options: RatingOptions,
    cycle_s: f64,
    /// Latency of the answer to a cycle \[s\], none where it was missing; a ring.
    window: [Option<f64>; WINDOW],
    /// Cycles rated so far.
    cycles: u64,
    missed: u64,
    row: u32,
    statistics: Statistics,
    quality: Quality,
}

impl Rating {
    /// No cycle yet: unacceptable.
    #[must_use]
    pub fn new(options: RatingOptions, cycle_s: f64) -> Self {
        Self {
            options,
            cycle_s,
            window: [None; WINDOW],
            cycles: 0,
            missed: 0,
            row: 0,
            statistics: Statistics::default(),
            quality: Quality::Unacceptable,
        }
    }

    /// Adds a cycle: the time from its measurement to its answer \[s\], none if no
    /// answer came within the cycle.
    pub fn add(&mut self, latency_s: Option<f64>) {
        self.window[(self.cycles % WINDOW as u64) as usize] = latency_s;
        self.cycles += 1;
        if latency_s.is_none() {
            self.missed += 1;
            self.row += 1;
        } else {
            self.row = 0;
        }
        self.statistics = self.average();
        self.quality = self.level();
    }

    fn average(&self) -> Statistics {
        let rated = (self.cycles as usize).min(WINDOW);
        // In order of the ring, not of time: a fixed order is all that matters.
        let answers = || self.window[..rated].iter().flatten();
        let count = answers().count();
        let rate = count as f64 / rated as f64;
        let mean = |sum: f64| if count > 0 { sum / count as f64 } else { 0.0 };
        let latency = mean(answers().sum());
        let variance = mean(answers().map(|t| (t - latency) * (t - latency)).sum());
        Statistics {
            answer_rate: rate,
            latency_s: latency,
            jitter_s: variance.sqrt(),
            miss_rate: 1.0 - rate,
        }
    }

    fn level(&self) -> Quality {
        let (options, now) = (&self.options, &self.statistics);
        if self.cycles < WINDOW as u64 || self.broken() || now.answer_rate < options.bad_rate {
            Quality::Unacceptable
        } else if now.answer_rate < options.ok_rate {
            Quality::Bad
        } else if now.answer_rate < options.perfect_rate
            || now.jitter_s > options.perfect_jitter * self.cycle_s
        {
            Quality::Ok
        } else {
            Quality::Perfect
        }
    }

    /// Whether more answers are missing in a row than is bearable.
    #[must_use]
    pub fn broken(&self) -> bool {
        self.row > self.options.misses_max
    }

    /// Answers missing in a row, until now.
    #[must_use]
    pub fn row(&self) -> u32 {
        self.row
    }

    /// Cycles without answer in time, since the first one.
    #[must_use]
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// Averages over the window.
    #[must_use]
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// The level.
    #[must_use]
    pub fn quality(&self) -> Quality {
        self.quality
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rated(latency: impl Fn(usize) -> Option<f64>, cycles: usize) -> Rating {
        let mut rating = Rating::new(RatingOptions::default(), 0.002);
        (0..cycles).for_each(|n| rating.add(latency(n)));
        rating
    }

    /// `missing` of every hundred, evenly spread.
    fn missing(missing: usize) -> Quality {
        let spread = |n: usize| (n * missing) / WINDOW != ((n + 1) * missing) / WINDOW;
        rated(|n| (!spread(n)).then_some(1e-4), 300).quality()
    }

    #[test]
    fn the_first_rating_takes_a_whole_window() {
        assert_eq!(rated(|_| Some(0.0), 99).quality(), Quality::Unacceptable);
        assert_eq!(rated(|_| Some(0.0), 100).quality(), Quality::Perfect);
    }

    #[test]
    fn levels_begin_at_their_thresholds() {
        for (count, expected) in [
            (0, Quality::Perfect),
            (1, Quality::Perfect),
            (2, Quality::Ok),
            (5, Quality::Ok),
            (6, Quality::Bad),
            (20, Quality::Bad),
            (21, Quality::Unacceptable),
        ] {
            assert_eq!(missing(count), expected, "{count}");
        }
    }

    #[test]
    fn jitter_costs_perfection() {
        // Alternating by +-a has the standard deviation a.
        let jitter = |a: f64| move |n: usize| Some(1e-3 + if n.is_multiple_of(2) { a } else { -a });
        let calm = rated(jitter(0.49e-3), 200);
        assert_eq!(calm.quality(), Quality::Perfect);
        assert!((calm.statistics().jitter_s - 0.49e-3).abs() < 1e-12);
        assert!((calm.statistics().latency_s - 1e-3).abs() < 1e-12);
        assert_eq!(rated(jitter(0.51e-3), 200).quality(), Quality::Ok);
    }

    #[test]
    fn eleven_misses_in_a_row_are_unacceptable_at_once() {
        let gap = |from: usize, count: usize| {
            rated(
                move |n| (!(from..from + count).contains(&n)).then_some(0.0),
                from + count,
            )
        };
        assert_eq!(gap(200, 10).quality(), Quality::Bad);
        let broken = gap(200, 11);
        assert_eq!(broken.quality(), Quality::Unacceptable);
        assert!(broken.broken() && broken.missed() == 11);
        assert!((broken.statistics().miss_rate - 0.11).abs() < 1e-12);
    }
}
