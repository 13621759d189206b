//! A scenario as the bridge runs it: configuration of the session, and its
//! reference motion.

use bridge::session::SessionConfig;
use bridge::source::ReferenceSource;
use controller_core::Reference;
use controller_core::law::null_space::NullDamping;

use super::{ReferenceSpec, Scenario};
use crate::invalid::Invalid;

impl Scenario {
    /// The session that runs this scenario for `duration_s` \[s\] on a robot whose
    /// torques act `dead_cycles` cycles after they arrive. The null-space damping
    /// is the inertia-shaped one: speeds come from an estimator, which is late.
    ///
    /// # Errors
    /// Tasks that the core refuses.
    pub fn session_config(
        &self,
        dead_cycles: u8,
        duration_s: f64,
    ) -> Result<SessionConfig, Invalid> {
        let mut controller = self.controller_config(dead_cycles)?;
        controller.null_space.damping = NullDamping::Inertia(self.null_space.damping_rate);
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
}
