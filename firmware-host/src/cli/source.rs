//! Where references come from.

use bridge::source::ReferenceSource;
use cell::scenario::ScenarioSource;
use controller_core::Reference;

use crate::stream::{Stream, StreamFigures};

/// The scenario, or a stream.
pub(super) enum Source {
    Scenario(ScenarioSource),
    Stream(Stream),
}

impl Source {
    /// What came over the stream, if there is one.
    pub(super) fn figures(&self) -> Option<StreamFigures> {
        match self {
            Self::Scenario(_) => None,
            Self::Stream(stream) => Some(stream.figures()),
        }
    }
}

impl ReferenceSource for Source {
    fn start(&mut self, origin: &Reference<f64>) {
        match self {
            Self::Scenario(source) => source.start(origin),
            Self::Stream(source) => source.start(origin),
        }
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        match self {
            Self::Scenario(source) => source.sample(t_s),
            Self::Stream(source) => source.sample(t_s),
        }
    }
}
