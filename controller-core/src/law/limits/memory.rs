//! What the law within limits remembers from one cycle to the next.

use super::projection::Projection;
use super::way_out::WayOut;
use crate::joint::JointVector;
use crate::ranges::MAX_LEVELS;
use crate::real::Real;

/// With it, and what else comes into it, a cycle can be made again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitMemory<T: Real> {
    /// dev \[m/s2\] of each level: what the bounds of the joints took from it, smoothed.
    pub disturbance: [T; MAX_LEVELS],
    /// x of the way out, of which the null space has n; none where no arm is bent.
    pub way_out: Option<JointVector<T>>,
}

impl<T: Real> LimitMemory<T> {
    /// What is remembered for the next cycle.
    #[must_use]
    pub fn of(projection: &Projection<T>, way_out: &WayOut<T>) -> Self {
        Self {
            disturbance: projection.smoothed,
            way_out: way_out.is_begun.then_some(way_out.motion),
        }
    }

    /// Remembers it.
    pub fn restore(&self, projection: &mut Projection<T>, way_out: &mut WayOut<T>) {
        projection.smoothed = self.disturbance;
        way_out.is_begun = self.way_out.is_some();
        if let Some(motion) = self.way_out {
            way_out.motion = motion;
        }
    }
}
