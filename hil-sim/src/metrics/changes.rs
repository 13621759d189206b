//! What a change of tasks or gains did to the torque and to the levels.

use std::fmt;

use cell::scenario::{Event, Scenario, Unit};
use controller_core::joint::DOF;
use serde::Serialize;

use record::run::Sample;

/// Figures of one change, from its begin to its end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangeFigures {
    /// What changed.
    pub what: String,
    /// When it began \[s\].
    pub from_s: f64,
    /// When it was over \[s\].
    pub to_s: f64,
    /// Largest step of a joint's torque from one cycle to the next \[Nm\].
    pub torque_step_nm: f64,
    /// The joint, from 1; 0 where nothing stepped.
    pub joint: usize,
    /// Largest error of each level \[mm\], of orientations \[mrad\]; null of levels that come, go
    /// or are not there.
    pub level_max: Vec<Option<f64>>,
    /// Units of the levels.
    #[serde(skip)]
    units: Vec<&'static str>,
}

impl ChangeFigures {
    /// Of the events of a scenario, before the first cycle.
    pub(super) fn of(scenario: &Scenario) -> Vec<Self> {
        let units = scenario
            .levels
            .iter()
            .map(|level| Unit::of(level.task).suffix());
        let units: Vec<_> = units.collect();
        let of_event = |event: &Event| Self {
            what: event.label(),
            from_s: event.at_s(),
            to_s: event.ends_s(),
            torque_step_nm: 0.0,
            joint: 0,
            level_max: vec![None; scenario.levels.len()],
            units: units.clone(),
        };
        scenario.events.iter().map(of_event).collect()
    }

    /// Adds a cycle; `steps` is by how much each torque changed \[Nm\].
    pub(super) fn add(&mut self, sample: &Sample, steps: &[f64; DOF], presence: &Presence) {
        if sample.t_s < self.from_s - 1e-9 || sample.t_s > self.to_s + 1e-9 {
            return;
        }
        for (joint, &step) in (1..).zip(steps) {
            if step > self.torque_step_nm {
                (self.torque_step_nm, self.joint) = (step, joint);
            }
        }
        for (index, (most, shown)) in self.level_max.iter_mut().zip(&sample.levels).enumerate() {
            if presence.is_there(index, sample.t_s) {
                let error = shown.error * 1e3;
                *most = Some(most.map_or(error, |most| most.max(error)));
            }
        }
    }
}

impl fmt::Display for ChangeFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} from {} to {} s: torque stepped by at most {:.3} Nm",
            self.what, self.from_s, self.to_s, self.torque_step_nm
        )?;
        for (number, (most, unit)) in (1..).zip(self.level_max.iter().zip(&self.units)) {
            if let Some(most) = most {
                write!(f, ", level {number} was off by at most {most:.3} {unit}")?;
            }
        }
        Ok(())
    }
}

/// When each level is there, all of it.
#[derive(Clone, Debug, Default)]
pub struct Presence(Vec<Vec<[f64; 2]>>);

impl Presence {
    /// By the events of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let of_level = |(index, absent): (usize, bool)| {
            let mut since = (!absent).then_some(f64::NEG_INFINITY);
            let mut there = Vec::new();
            let mut events: Vec<_> = scenario.events.iter().collect();
            events.sort_by(|a, b| a.at_s().total_cmp(&b.at_s()));
            for event in events {
                match event {
                    Event::Add(addition) if addition.level == index + 1 => {
                        since = Some(event.ends_s());
                    }
                    Event::Remove(removal) if removal.level == index + 1 => {
                        there.extend(since.take().map(|since| [since, removal.at_s]));
                    }
                    _ => {}
                }
            }
            there.extend(since.map(|since| [since, f64::INFINITY]));
            there
        };
        let levels = scenario.levels.iter().map(|level| level.absent);
        Self(levels.enumerate().map(of_level).collect())
    }

    /// Whether a level, counted from 0, is there at a time \[s\].
    #[must_use]
    pub fn is_there(&self, level: usize, t_s: f64) -> bool {
        let there = self.0.get(level).into_iter().flatten();
        there.clone().any(|[from, to]| t_s >= *from && t_s <= *to)
    }
}
