//! Counters of the link, cycle by cycle and answer by answer.

use fri::{InterfaceState, Quality};

use super::figures::{
    EVENTS_MAX, Event, LatencyFigures, LinkFigures, QualityCycles, Rejected, StateCycles,
};
use super::krc::Krc;
use super::rating::Rating;

/// What was counted.
#[derive(Clone, Debug, Default)]
pub struct Counters {
    states: StateCycles,
    /// Cycles of the scenario, and those of them in command state.
    scenario: u64,
    commanded: u64,
    qualities: QualityCycles,
    /// Accepted answers.
    pub answers: u64,
    /// Of these, too late for their cycle.
    pub late: u64,
    /// Not used.
    pub rejected: Rejected,
    /// Lost, repeated, overtaken answers.
    pub lost: u64,
    /// See `lost`.
    pub repeated: u64,
    /// See `lost`.
    pub old: u64,
    latency_sum: f64,
    latency_squares: f64,
    latency_max: f64,
    /// Largest change of a torque \[Nm\].
    pub step: f64,
    events: Vec<Event>,
}

impl Counters {
    /// An answer that took `latency_s` \[s\].
    pub fn answer(&mut self, latency_s: f64, in_time: bool) {
        self.answers += 1;
        self.late += u64::from(!in_time);
        self.latency_sum += latency_s;
        self.latency_squares += latency_s * latency_s;
        self.latency_max = self.latency_max.max(latency_s);
    }

    /// A cycle that began in `state`.
    pub fn cycle(&mut self, state: InterfaceState, quality: Quality, scenario: bool) {
        let command = u64::from(state == InterfaceState::Command);
        self.states.command += command;
        self.states.monitor += 1 - command;
        self.scenario += u64::from(scenario);
        self.commanded += u64::from(scenario) * command;
        match quality {
            Quality::Bad => self.qualities.bad += 1,
            Quality::Ok => self.qualities.ok += 1,
            Quality::Perfect => self.qualities.perfect += 1,
            _ => self.qualities.unacceptable += 1,
        }
    }

    /// Keeps an event while there is room.
    pub fn event(&mut self, t_s: Option<f64>, robot_t_s: f64, text: String) {
        if self.events.len() < EVENTS_MAX {
            self.events.push(Event {
                t_s,
                robot_t_s,
                text,
            });
        }
    }

    /// The events so far.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// All figures.
    pub fn figures(&self, krc: &Krc, rating: &Rating) -> LinkFigures {
        let mean = |sum: f64| (self.answers > 0).then(|| sum / self.answers as f64);
        let latency = mean(self.latency_sum);
        let variance = latency
            .zip(mean(self.latency_squares))
            .map(|(mean, square)| (square - mean * mean).max(0.0));
        LinkFigures {
            state_cycles: self.states,
            command_share: (self.scenario > 0)
                .then(|| self.commanded as f64 / self.scenario as f64),
            quality_cycles: self.qualities,
            answers: self.answers,
            missed: rating.missed(),
            late: self.late,
            rejected: self.rejected,
            lost: self.lost,
            repeated: self.repeated,
            old: self.old,
            latency_ms: LatencyFigures {
                mean: latency.map(|t| t * 1e3),
                max: (self.answers > 0).then_some(self.latency_max * 1e3),
            },
            jitter_ms: variance.map(|variance| variance.sqrt() * 1e3),
            fallbacks: krc.fallbacks(),
            recoveries: krc.entries().saturating_sub(1),
            largest_torque_step_nm: self.step,
            events: self.events.clone(),
        }
    }
}
