//! Counters of the link, cycle by cycle and answer by answer.

use std::time::Duration;

use cell::timing::Times;

use super::figures::{Counted, EVENTS_MAX, Event, LatencyFigures, OwnLateness, Stamp};

/// From here on a measurement counts as late \[cycles\]: what it takes to compute one and a
/// usual wake-up are less.
const LATE: f64 = 0.1;

/// How late measurements left.
#[derive(Clone, Debug)]
struct Departures {
    stamp: Stamp,
    bound_s: f64,
    late: u64,
    times: Times,
}

impl Departures {
    fn figures(&self) -> OwnLateness {
        let times = self.times.figures();
        OwnLateness {
            cycles: self.late,
            bound_ms: self.bound_s * 1e3,
            p999_ms: times.p999_us * 1e-3,
            max_ms: times.max_us * 1e-3,
            stamp: self.stamp,
        }
    }
}

/// What was counted.
#[derive(Clone, Debug, Default)]
pub struct Counters {
    /// What is reported as it is counted; the rest of it follows in the end.
    counted: Counted,
    /// Cycles of the scenario, and those of them in command state.
    scenario: u64,
    commanded: u64,
    latency_sum: f64,
    latency_squares: f64,
    latency_max: f64,
    /// By the wall clock only.
    departures: Option<Departures>,
}

impl Counters {
    /// An answer that took `latency_s` \[s\].
    pub fn answer(&mut self, latency_s: f64, in_time: bool) {
        self.counted.answers += 1;
        self.counted.late += u64::from(!in_time);
        self.latency_sum += latency_s;
        self.latency_squares += latency_s * latency_s;
        self.latency_max = self.latency_max.max(latency_s);
    }

    /// Counts by the wall clock from now on, in cycles of `cycle_s` \[s\].
    pub fn keep_time(&mut self, stamp: Stamp, cycle_s: f64) {
        self.departures = Some(Departures {
            stamp,
            bound_s: LATE * cycle_s,
            late: 0,
            times: Times::new(),
        });
    }

    /// A measurement left `late_s` \[s\] after its time.
    pub fn departure(&mut self, late_s: f64) {
        if let Some(departures) = &mut self.departures {
            departures.late += u64::from(late_s > departures.bound_s);
            let late = Duration::try_from_secs_f64(late_s.max(0.0));
            departures.times.add(late.unwrap_or(Duration::MAX));
        }
    }

    /// A cycle; `commanded`: answers moved the arm when it began. `scenario`: its time ran.
    pub fn cycle(&mut self, commanded: bool, scenario: bool) {
        let commanded = u64::from(commanded);
        self.counted.state_cycles.command += commanded;
        self.counted.state_cycles.monitor += 1 - commanded;
        self.scenario += u64::from(scenario);
        self.commanded += u64::from(scenario) * commanded;
    }

    /// A torque that changed by `step_nm` \[Nm\] without the client.
    pub fn torque_step(&mut self, step_nm: f64) {
        let largest = &mut self.counted.largest_torque_step_nm;
        *largest = largest.max(step_nm);
    }

    /// What happened so far.
    pub fn events(&self) -> &[Event] {
        &self.counted.events
    }

    /// Keeps an event while there is room.
    pub fn event(&mut self, event: Event) {
        if self.counted.events.len() < EVENTS_MAX {
            self.counted.events.push(event);
        }
    }

    /// All figures that are counted here.
    pub fn figures(&self) -> Counted {
        let share = |sum: f64, of: u64| (of > 0).then(|| sum / of as f64);
        let mean = |sum: f64| share(sum, self.counted.answers);
        let latency = mean(self.latency_sum);
        let variance = latency
            .zip(mean(self.latency_squares))
            .map(|(mean, square)| (square - mean * mean).max(0.0));
        Counted {
            command_share: share(self.commanded as f64, self.scenario),
            latency_ms: LatencyFigures {
                mean: latency.map(|t| t * 1e3),
                max: latency.map(|_| self.latency_max * 1e3),
            },
            jitter_ms: variance.map(|variance| variance.sqrt() * 1e3),
            own_lateness: self.departures.as_ref().map(Departures::figures),
            ..self.counted.clone()
        }
    }
}
