//! Counters of the link, cycle by cycle and answer by answer.

use fri::{InterfaceState, Quality};

use super::figures::{EVENTS_MAX, Event, LatencyFigures, LinkFigures};
use super::krc::Krc;
use super::rating::Rating;

/// What was counted.
#[derive(Clone, Debug, Default)]
pub struct Counters {
    /// What is reported as it is counted; the rest of it follows in the end.
    pub link: LinkFigures,
    /// Cycles of the scenario, and those of them in command state.
    scenario: u64,
    commanded: u64,
    latency_sum: f64,
    latency_squares: f64,
    latency_max: f64,
}

impl Counters {
    /// An answer that took `latency_s` \[s\].
    pub fn answer(&mut self, latency_s: f64, in_time: bool) {
        self.link.answers += 1;
        self.link.late += u64::from(!in_time);
        self.latency_sum += latency_s;
        self.latency_squares += latency_s * latency_s;
        self.latency_max = self.latency_max.max(latency_s);
    }

    /// A cycle that began in `state`.
    pub fn cycle(&mut self, state: InterfaceState, quality: Quality, scenario: bool) {
        let command = u64::from(state == InterfaceState::Command);
        self.link.state_cycles.command += command;
        self.link.state_cycles.monitor += 1 - command;
        self.scenario += u64::from(scenario);
        self.commanded += u64::from(scenario) * command;
        let levels = &mut self.link.quality_cycles;
        *match quality {
            Quality::Bad => &mut levels.bad,
            Quality::Ok => &mut levels.ok,
            Quality::Perfect => &mut levels.perfect,
            _ => &mut levels.unacceptable,
        } += 1;
    }

    /// Keeps an event while there is room.
    pub fn event(&mut self, event: Event) {
        if self.link.events.len() < EVENTS_MAX {
            self.link.events.push(event);
        }
    }

    /// All figures.
    pub fn figures(&self, krc: &Krc, rating: &Rating) -> LinkFigures {
        let share = |sum: f64, of: u64| (of > 0).then(|| sum / of as f64);
        let mean = |sum: f64| share(sum, self.link.answers);
        let latency = mean(self.latency_sum);
        let variance = latency
            .zip(mean(self.latency_squares))
            .map(|(mean, square)| (square - mean * mean).max(0.0));
        LinkFigures {
            command_share: share(self.commanded as f64, self.scenario),
            missed: rating.missed(),
            latency_ms: LatencyFigures {
                mean: latency.map(|t| t * 1e3),
                max: latency.map(|_| self.latency_max * 1e3),
            },
            jitter_ms: variance.map(|variance| variance.sqrt() * 1e3),
            fallbacks: krc.fallbacks(),
            recoveries: krc.entries().saturating_sub(1),
            ..self.link.clone()
        }
    }
}
