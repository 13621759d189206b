//! A controller within limits around a plant, with changes on the way.

use cell::names::PlantKind;
use controller_core::arm::ArmParameters;
use controller_core::joint::{JointState, JointVector};
use controller_core::{
    Change, Controller, ControllerConfig, Measurement, Reference, State, Step, Target,
};
use hil_sim::plant::Plant;
use stratum_tests::oracle::closed_loop::{circle, no_contact};

/// Cycle \[s\].
pub const CYCLE_S: f64 = 0.002;

/// Controller, state and plant.
pub struct Run {
    pub controller: Controller<f64>,
    pub state: State<f64>,
    pub plant: Plant,
    pub cycle: u32,
    last: Option<JointVector<f64>>,
    /// Largest step of a torque so far \[Nm\], and when \[s\].
    pub step: f64,
    pub stepped_at_s: f64,
}

impl Run {
    /// At rest in `start` \[rad\].
    pub fn new(
        arm: &ArmParameters,
        config: &ControllerConfig,
        kind: PlantKind,
        start: JointVector<f64>,
        seed: u64,
    ) -> Self {
        Self {
            controller: Controller::new(arm, config).expect("a valid configuration"),
            state: State::new(),
            plant: Plant::new(kind, arm, start, config.cycle_s, seed),
            cycle: 0,
            last: None,
            step: 0.0,
            stepped_at_s: 0.0,
        }
    }

    pub fn t_s(&self) -> f64 {
        f64::from(self.cycle) * CYCLE_S
    }

    /// Begins a change of half a second.
    pub fn begin(&mut self, change: &Change) {
        let transition = self.controller.transition(change, 0.5).expect("a change");
        let begun = self.controller.begin(&mut self.state, &transition);
        begun.expect("a change of these tasks");
    }

    /// Starts counting steps of the torque anew.
    pub fn count_anew(&mut self) {
        (self.step, self.stepped_at_s) = (0.0, self.t_s());
    }

    pub fn measurement(&mut self) -> Measurement<f64> {
        let JointState { q, dq } = self.plant.measure();
        Measurement {
            q,
            dq,
            interval_s: CYCLE_S,
        }
    }

    /// A cycle.
    pub fn cycle(&mut self, reference: &Reference<f64>) -> Step<f64> {
        let measurement = self.measurement();
        let step = self
            .controller
            .step(&mut self.state, &measurement, reference);
        self.act(&step);
        step
    }

    /// The torque of a cycle acts until the next.
    pub fn act(&mut self, step: &Step<f64>) {
        let most = self.last.map_or(0.0, |last| (step.torque - last).amax());
        if most > self.step {
            (self.step, self.stepped_at_s) = (most, self.t_s());
        }
        self.last = Some(step.torque);
        let t_s = self.t_s();
        self.plant.advance(t_s, &step.torque, no_contact);
        self.cycle += 1;
    }
}

/// A position on a circle in the YZ plane from `origin` on, blended in from t = 0.
pub fn on_circle(origin: &Target<f64>, t_s: f64) -> Target<f64> {
    match origin {
        Target::Position { x, .. } => circle(0.1, 6.0).sample(x, t_s),
        other => *other,
    }
}
