//! A scenario as the bridge runs it: configuration of the session, and its
//! reference motion.

use bridge::session::SessionConfig;
use bridge::source::{Begin, ReferenceSource};
use controller_core::Reference;
use controller_core::law::null_space::NullDamping;

use super::{ReferenceSpec, Scenario, TimedTransition};
use crate::invalid::Invalid;
use crate::names::RobotInterface;
use crate::terminal::tell;

impl Scenario {
    /// The session that runs this scenario for `duration_s` \[s\] on an LWR whose
    /// torques act `dead_cycles` cycles after they arrive.
    ///
    /// # Errors
    /// Tasks that the core refuses.
    pub fn session_config(
        &self,
        dead_cycles: u8,
        duration_s: f64,
    ) -> Result<SessionConfig, Invalid> {
        self.session_config_for(RobotInterface::Lwr, dead_cycles, duration_s)
    }

    /// The same on a robot with this interface. Where speeds come from an estimator, which is late,
    /// the null-space damping is the inertia-shaped one.
    ///
    /// # Errors
    /// Tasks that the core refuses.
    pub fn session_config_for(
        &self,
        robot: RobotInterface,
        dead_cycles: u8,
        duration_s: f64,
    ) -> Result<SessionConfig, Invalid> {
        let mut controller = self.controller_config(dead_cycles)?;
        if robot == RobotInterface::Lwr {
            controller.null_space.damping = NullDamping::Inertia(self.null_space.damping_rate);
        }
        let arm = self.arm().parameters;
        Ok(SessionConfig {
            law: self.law.maker(),
            // A damaged datagram or two are no fault of the arm.
            doubted_max: 2,
            ..SessionConfig::new(&arm, controller, arm.flange_point(), duration_s)
        })
    }
}

/// The reference motion of a scenario, from wherever the arm is at the start.
#[derive(Clone, Debug)]
pub struct ScenarioSource {
    levels: Vec<ReferenceSpec>,
    origin: Reference<f64>,
    events: Events,
}

/// Changes of a scenario that are still to be begun.
#[derive(Clone, Debug, Default)]
pub struct Events {
    /// The next one last.
    changes: Vec<TimedTransition>,
}

impl Events {
    /// In the order of their times.
    #[must_use]
    pub fn new(mut changes: Vec<TimedTransition>) -> Self {
        changes.reverse();
        Self { changes }
    }

    /// Begins those whose time has come at `t_s` \[s\]. What cannot be is told and left out.
    pub fn begin(&mut self, t_s: f64, begin: &mut Begin<'_>) {
        while let Some((at_s, change)) = self.changes.pop_if(|(at_s, _)| *at_s <= t_s) {
            if let Err(error) = begin(&change) {
                tell(format_args!("the event at {at_s} s is left out: {error}"));
            }
        }
    }
}

impl ScenarioSource {
    /// Of all levels.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            levels: (scenario.levels.iter())
                .map(|level| level.reference.clone())
                .collect(),
            origin: Reference::hold(scenario.levels.len(), scenario.start()),
            events: Events::default(),
        }
    }

    /// With changes on the way, in the order of their times.
    #[must_use]
    pub fn changing(self, changes: Vec<TimedTransition>) -> Self {
        Self {
            events: Events::new(changes),
            ..self
        }
    }
}

impl ReferenceSource for ScenarioSource {
    fn start(&mut self, origin: &Reference<f64>) {
        self.origin.clone_from(origin);
    }

    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>> {
        let mut reference = self.origin.clone();
        for (level, target) in self.levels.iter().zip(reference.targets_mut()) {
            *target = level.sample(target, t_s);
        }
        Some(reference)
    }

    fn change(&mut self, t_s: f64, begin: &mut Begin<'_>) {
        self.events.begin(t_s, begin);
    }
}
