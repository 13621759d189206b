//! References that get too old.

use controller_core::task::{AfterStale, Stale};
use serde::Deserialize;

use crate::invalid::Invalid;
use crate::keys::allowed::Choice;
use crate::keys::keys;
use crate::keys::words::plain_choice;
use crate::ranges::STALE_S;

keys! {
    /// When the reference of a level that comes as a stream is too old, and what then.
    #[derive(Clone, Copy, Debug)]
    pub struct StaleSpec {
        /// Age from which on the level comes to rest.
        pub after_s: f64, "s", STALE_S;
        /// What follows once it rests.
        pub then: AfterStaleSpec = AfterStaleSpec::Hold, "", Choice;
    }
}

/// What a level does that came to rest because its reference is too old.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum AfterStaleSpec {
    /// It stays.
    Hold,
    /// It goes until there is a fresh one.
    Release,
}

plain_choice!(AfterStaleSpec);

impl StaleSpec {
    pub(super) fn validate(&self) -> Result<(), Invalid> {
        self.check_keys()
    }

    pub(super) fn of_core(self) -> Stale {
        Stale {
            age_s: self.after_s,
            then: match self.then {
                AfterStaleSpec::Hold => AfterStale::Hold,
                AfterStaleSpec::Release => AfterStale::Release,
            },
        }
    }
}
