//! Seeded random states of the arm.

use arms::LWR_IV;
use controller_core::joint::{JointState, JointVector};
use hil_sim::plant::noise::Rng;

/// A source of random states within the limits of the arm.
pub struct States(Rng);

impl States {
    /// The same seed gives the same states.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Rng::new(seed, 7))
    }

    /// Uniform in -1..1.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.0.uniform() - 1.0
    }

    /// A vector with entries uniform in -1..1.
    pub fn vector(&mut self) -> JointVector<f64> {
        JointVector::from_fn(|_, _| self.signed())
    }

    /// Positions and speeds uniform within the limits.
    pub fn state(&mut self) -> JointState<f64> {
        let links = &LWR_IV.links;
        JointState {
            q: JointVector::from_fn(|i, _| self.signed() * links[i].position_range[1]),
            dq: JointVector::from_fn(|i, _| self.signed() * links[i].speed_limit),
        }
    }
}
