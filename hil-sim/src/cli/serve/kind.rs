//! Which robot is served, and which options are whose.

use cell::invalid::Invalid;
use cell::names::Named;

/// Which robot it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// KUKA's LWR, by FRI.
    Lwr,
    /// An arm with Franka's control interface.
    Fci,
}

impl Named for Kind {
    const THING: &'static str = "--robot";
    const ALL: &'static [(&'static str, Self)] = &[("lwr", Self::Lwr), ("fci", Self::Fci)];
}

impl Kind {
    /// The scenario, if none is given.
    pub(super) fn scenario(self) -> &'static str {
        match self {
            Self::Lwr => "two-level",
            Self::Fci => "two-level-fr3",
        }
    }

    /// Refuses what is of another robot: options of `owner`, and whether they are given.
    pub(super) fn refuse(self, owner: Self, options: &[(&str, bool)]) -> Result<(), Invalid> {
        match options.iter().find(|(_, given)| *given) {
            Some((option, _)) if self != owner => {
                let given = format!("given with --robot {}", self.name());
                let allowed = format!("it with --robot {}", owner.name());
                Err(Invalid::new(option, given, allowed))
            }
            _ => Ok(()),
        }
    }
}
