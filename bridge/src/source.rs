//! Where the wanted motion comes from.

use controller_core::Reference;

/// Where the wanted motion comes from.
pub trait ReferenceSource {
    /// Time 0 is near and the arm rests: `origin` is where the levels are, and the
    /// posture.
    fn start(&mut self, origin: &Reference<f64>);

    /// The reference at `t_s` \[s\] >= 0. None where there is nothing to follow: every
    /// level comes to rest, and joins again when there is
    /// ([`controller_core::task::Followed`]). [`Target::Hold`](controller_core::Target::Hold)
    /// says the same of one level.
    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>>;
}
