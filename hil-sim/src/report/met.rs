//! When a run met which of its limits: intervals of time, exact to a two-thousandth of the run.

use controller_core::fault::Status;
use controller_core::joint::DOF;
use controller_core::ranges::MAX_LEVELS;
use record::run::LimitSample;

/// Gaps that are shorter, of the length of the run, are none: a drawing does not show them, and a
/// long run stays small.
const RESOLUTION: f64 = 1.0 / 2000.0;

/// What levels meet, the most important first, by name.
pub const OF_LEVELS: [&str; 5] = ["stuck", "released", "degraded", "shaped", "scaled"];

/// Intervals \[s\] in which something was so.
#[derive(Clone, Debug, Default)]
pub struct Spans(pub Vec<[f64; 2]>);

impl Spans {
    fn add(&mut self, [from, to]: [f64; 2], gap: f64) {
        match self.0.last_mut() {
            Some(last) if from - last[1] <= gap => last[1] = to,
            _ => self.0.push([from, to]),
        }
    }
}

/// When limits were met.
#[derive(Clone, Debug)]
pub struct Met {
    cycle_s: f64,
    gap: f64,
    /// Per level, in the order of [`OF_LEVELS`].
    pub levels: Vec<[Spans; OF_LEVELS.len()]>,
    /// The null space got less than it asked for.
    pub null_scaled: Spans,
    /// Bounds were kept by a cut.
    pub unresolved: Spans,
    /// Per joint: it may not go further up, further down.
    pub joints: [[Spans; 2]; DOF],
}

impl Met {
    /// Nothing yet, in a run of `duration_s` \[s\] in cycles of `cycle_s` \[s\].
    #[must_use]
    pub fn new(levels: usize, duration_s: f64, cycle_s: f64) -> Self {
        Self {
            cycle_s,
            gap: (RESOLUTION * duration_s).max(0.5 * cycle_s),
            levels: vec![Default::default(); levels],
            null_scaled: Spans::default(),
            unresolved: Spans::default(),
            joints: Default::default(),
        }
    }

    /// Adds the cycle that begins at `t_s` \[s\].
    pub fn add(&mut self, t_s: f64, limits: &LimitSample) {
        let (span, gap) = ([t_s, t_s + self.cycle_s], self.gap);
        let add = |spans: &mut Spans, on: bool| {
            if on {
                spans.add(span, gap);
            }
        };
        let Status {
            stuck,
            released,
            degraded,
            shaped,
            scaled,
            ..
        } = limits.status;
        for (level, of_level) in self.levels.iter_mut().enumerate() {
            let met = [stuck, released, degraded, shaped, scaled];
            for (spans, set) in of_level.iter_mut().zip(met) {
                add(spans, set.contains(level));
            }
        }
        add(&mut self.null_scaled, scaled.contains(MAX_LEVELS));
        add(&mut self.unresolved, limits.status.unresolved);
        for (joint, [up, down]) in self.joints.iter_mut().enumerate() {
            let side = limits.at_bound(joint);
            add(up, side > 0);
            add(down, side < 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::fault::IndexSet;

    #[test]
    fn cycles_in_a_row_are_one_interval_and_long_runs_stay_small() {
        let mut met = Met::new(2, 10.0, 0.002);
        for cycle in 0..5000 {
            let limits = LimitSample {
                status: Status {
                    // Every other cycle of the first second, and one at 5 s.
                    released: IndexSet(if cycle < 500 && cycle % 2 == 0 { 2 } else { 0 }),
                    at_least: IndexSet(u8::from(cycle == 2500) << 3),
                    ..Status::default()
                },
                null_share: 1.0,
                null_power: 0.0,
            };
            met.add(f64::from(cycle) * 0.002, &limits);
        }
        let [_, released, ..] = &met.levels[1];
        let [[from, to]] = released.0.as_slice() else {
            panic!("{released:?}")
        };
        assert!(*from == 0.0 && (to - 0.998).abs() < 1e-12);
        assert!(met.levels[0].iter().all(|spans| spans.0.is_empty()));
        let [up, down] = &met.joints[3];
        assert!(up.0.is_empty() && down.0.len() == 1);
        assert!((down.0[0][1] - down.0[0][0] - 0.002).abs() < 1e-12);
    }
}
