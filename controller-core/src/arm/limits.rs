//! What the law within limits may do with each joint.

use crate::joint::DOF;

/// How joints are kept within their ranges and speed limits. Plain `f64` data; joints base to
/// flange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    /// alpha \[rad/s2\]: largest acceleration that the law asks of a joint. It is part of how the
    /// arm feels: pushed harder, it resists.
    pub acceleration: [f64; DOF],
    /// A \[rad/s2\]: with so much a joint brakes before the end of its range; less where its
    /// [`EndApproach`](crate::arm::EndApproach) asks for it.
    pub braking: [f64; DOF],
    /// kv \[1/s\]: how fast the speed of a joint comes to what it may be.
    pub speed_gain: [f64; DOF],
    /// k \[1/s\]: how fast the last bit of the way to an end is gone.
    pub position_gain: f64,
    /// This far before the end of its range a joint stops \[rad\].
    pub margin: f64,
    /// Share of the speed limit that a joint may use.
    pub speed_share: f64,
}
