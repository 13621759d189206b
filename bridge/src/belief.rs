//! Which measured positions are believed. A datagram may be damaged and well-formed all
//! the same: one position that no arm can have reached is a lost cycle. Several in a row
//! are what the robot says.

use controller_core::arm::ArmParameters;
use controller_core::joint::JointVector;
use controller_core::ranges::SPEED_FACTOR;

/// Doubts in a row.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Belief {
    doubted: u8,
}

impl Belief {
    /// Whether the arm cannot have moved by `way` \[rad\] in `interval_s` \[s\]; of a row of
    /// them that of the first `most`.
    pub fn doubts(
        &mut self,
        most: u8,
        arm: &ArmParameters,
        way: &JointVector<f64>,
        interval_s: f64,
    ) -> bool {
        let mut joints = way.iter().zip(&arm.links);
        let follows =
            joints.all(|(way, link)| way.abs() <= SPEED_FACTOR * link.speed_limit * interval_s);
        self.doubted = if follows {
            0
        } else {
            self.doubted.saturating_add(1)
        };
        (1..=most).contains(&self.doubted)
    }
}
