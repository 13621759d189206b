//! Where references come from, and changes of tasks and gains.

use bridge::source::{Begin, ReferenceSource};
use cell::scenario::{Events, ScenarioSource};
use controller_core::Reference;

use crate::changes::Changes;
use crate::stream::{Stream, StreamFigures};

/// What is wanted of a robot.
pub(super) struct Source {
    pub motion: Motion,
    /// Those of the scenario.
    pub events: Events,
    /// What is typed, or sent beside references.
    pub changes: Changes,
}

/// The scenario, or a stream.
pub(super) enum Motion {
    Scenario(ScenarioSource),
    Stream(Stream),
}

impl Source {
    /// What came over the stream, if there is one.
    pub(super) fn figures(&self) -> Option<StreamFigures> {
        match &self.motion {
            Motion::Scenario(_) => None,
            Motion::Stream(stream) => Some(stream.figures()),
        }
    }
}

impl ReferenceSource for Source {
    fn start(&mut self, origin: &Reference<f64>) {
        match &mut self.motion {
            Motion::Scenario(source) => source.start(origin),
            Motion::Stream(source) => source.start(origin),
        }
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        match &mut self.motion {
            Motion::Scenario(source) => source.sample(t_s),
            Motion::Stream(source) => source.sample(t_s),
        }
    }

    fn change(&mut self, t_s: f64, begin: &mut Begin<'_>) {
        self.events.begin(t_s, begin);
        self.changes.begin(begin);
    }
}
