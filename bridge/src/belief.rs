//! Which measurements are believed. A datagram may be damaged and well-formed all the
//! same: one position that no arm can have reached, or speed of none, is a lost cycle. Several in a row
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
    /// Whether the arm cannot have moved by `way` \[rad\] in `interval_s` \[s\], or as fast as
    /// `dq` \[rad/s\] where that is measured; of a row of them that of the first `most`.
    pub fn doubts(
        &mut self,
        most: u8,
        arm: &ArmParameters,
        way: &JointVector<f64>,
        dq: Option<&JointVector<f64>>,
        interval_s: f64,
    ) -> bool {
        let within = |values: &JointVector<f64>, time_s: f64| {
            let mut joints = values.iter().zip(&arm.links);
            joints.all(|(value, link)| value.abs() <= SPEED_FACTOR * link.speed_limit * time_s)
        };
        let follows = within(way, interval_s) && dq.is_none_or(|dq| within(dq, 1.0));
        self.doubted = if follows {
            0
        } else {
            self.doubted.saturating_add(1)
        };
        (1..=most).contains(&self.doubted)
    }
}
