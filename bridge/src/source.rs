//! Where the wanted motion comes from.

use controller_core::{ChangeError, Reference, Transition};

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

    /// Changes of tasks and gains that are due at `t_s` \[s\], before the reference is asked for:
    /// each is handed to `begin`, which says why one cannot be. None unless a source has some.
    fn change(&mut self, t_s: f64, begin: &mut Begin<'_>) {
        let _ = (t_s, begin);
    }
}

/// Begins a change of tasks or gains in a session.
pub type Begin<'a> = dyn FnMut(&Transition<f64>) -> Result<(), ChangeError> + 'a;
