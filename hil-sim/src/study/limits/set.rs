//! The sets of runs.

use cell::invalid::Invalid;
use cell::names::Named;

use super::case::Case;
use super::ground::Ground;
use super::{ordered, passes, push, random, saturation, straight, wrist};

/// A set of runs of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// Scenarios near and beyond limits, one by one.
    Ordered,
    /// Passes through and beyond singularities.
    Pass,
    /// Passes through the wrist singularity.
    Wrist,
    /// Violent random motions.
    Random,
    /// Pushes into the ends of ranges.
    Push,
    /// A push that comes to no limit.
    Give,
    /// Torque at its limits.
    Saturation,
    /// A straight arm that is pulled back.
    Straight,
}

impl Named for Set {
    const THING: &'static str = "set";
    const ALL: &'static [(&'static str, Self)] = &[
        ("ordered", Self::Ordered),
        ("pass", Self::Pass),
        ("wrist", Self::Wrist),
        ("random", Self::Random),
        ("push", Self::Push),
        ("give", Self::Give),
        ("saturation", Self::Saturation),
        ("straight", Self::Straight),
    ];
}

impl Set {
    /// Sets that there may be files of.
    pub const IN_FILES: [Self; 4] = [Self::Pass, Self::Wrist, Self::Random, Self::Push];

    /// Number of its runs.
    #[must_use]
    pub fn size(self) -> usize {
        match self {
            Self::Ordered => ordered::count(),
            Self::Pass => 100,
            Self::Wrist => 60,
            Self::Random => 200,
            Self::Push => 24,
            Self::Give | Self::Saturation => 1,
            Self::Straight => straight::count(),
        }
    }

    /// Whether more of its runs can be drawn.
    #[must_use]
    pub fn is_drawn(self) -> bool {
        Self::IN_FILES.contains(&self)
    }

    /// Whether it is for any arm; the others name postures or points of the LWR.
    #[must_use]
    pub fn is_for_any_arm(self) -> bool {
        matches!(self, Self::Pass | Self::Random | Self::Straight)
    }

    /// The run `number` (from 0).
    ///
    /// # Errors
    /// An arm that there is no such run for.
    pub fn case(self, ground: &Ground, number: usize) -> Result<Case, Invalid> {
        match self {
            Self::Ordered => ordered::case(number),
            Self::Pass => passes::pass(ground, number),
            Self::Wrist => wrist::pass(ground, number),
            Self::Random => random::motion(ground, number),
            Self::Push => push::hard(ground, number),
            Self::Give => push::soft(ground),
            Self::Saturation => saturation::jumps(ground),
            Self::Straight => straight::pull(ground, number),
        }
    }
}
