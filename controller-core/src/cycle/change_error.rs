//! Why a change of tasks or gains is refused.

use core::fmt;

use crate::error::ConfigError;
use crate::ranges::CHANGE_RANGE_S;
use crate::task::Order;

/// Why a change is refused; nothing is changed then. Slots count from 0, as in
/// [`Change`](super::Change).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ChangeError {
    /// The task, the gains or the compliance themselves. It calls a slot its number from 1.
    Config(ConfigError),
    /// The time it is to take.
    Duration {
        /// \[s\].
        value: f64,
    },
    /// A slot that the controller has no room for.
    Slot {
        /// The slot.
        slot: usize,
        /// Slots there are.
        slots: usize,
    },
    /// A slot that has a task, or one of another kind that is still leaving.
    SlotTaken {
        /// The slot.
        slot: usize,
    },
    /// A slot that has no task.
    SlotEmpty {
        /// The slot.
        slot: usize,
    },
    /// A place behind the last one.
    Place {
        /// The place, from 0.
        place: usize,
        /// Levels there are.
        levels: usize,
    },
    /// More rows than the controller has room for.
    Rows {
        /// Of all tasks, with those that are still leaving.
        rows: usize,
        /// What there is room for.
        allowed: usize,
    },
    /// An order of other slots than those with a task.
    Order {
        /// What was given.
        given: Order,
        /// The slots with a task.
        wanted: Order,
    },
    /// Tasks of the exact law neither come nor go: at a change it would step.
    ExactLaw,
    /// A compliance whose damping is of another kind than that of the controller.
    DampingKind,
    /// A compliance whose posture comes from elsewhere than that of the controller.
    Posture,
}

impl From<ConfigError> for ChangeError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

/// Slots as they are written: counted from 0, highest priority first.
struct Listed<'a>(&'a Order);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.count() == 0 {
            return f.write_str("none");
        }
        for (place, slot) in self.0.slots().enumerate() {
            let comma = if place > 0 { ", " } else { "" };
            write!(f, "{comma}{slot}")?;
        }
        Ok(())
    }
}

impl fmt::Display for ChangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Config(error) => error.fmt(f),
            Self::Duration { value } => {
                let [min, max] = CHANGE_RANGE_S;
                write!(
                    f,
                    "duration of the change: {value} s; allowed {min} to {max} s"
                )
            }
            Self::Slot { slot, slots } => {
                write!(f, "slot {slot}: allowed 0 to {}", slots.saturating_sub(1))
            }
            Self::SlotTaken { slot } => {
                write!(f, "slot {slot} has a task; allowed: a slot without one")
            }
            Self::SlotEmpty { slot } => {
                write!(f, "slot {slot} has no task; allowed: a slot with one")
            }
            Self::Place { place, levels } => {
                write!(f, "place {place} among the levels: allowed 0 to {levels}")
            }
            Self::Rows { rows, allowed } => {
                write!(
                    f,
                    "rows of all tasks together: {rows}; allowed at most {allowed}"
                )
            }
            Self::Order { given, wanted } => write!(
                f,
                "order of the slots: {}; allowed: each of {} once",
                Listed(given),
                Listed(wanted)
            ),
            Self::ExactLaw => f.write_str(
                "tasks of the exact law: neither added, removed nor reordered; \
                 allowed: gains and the null space",
            ),
            Self::DampingKind => f.write_str(
                "damping of the null space: of another kind than the controller's; \
                 allowed: the same kind",
            ),
            Self::Posture => f.write_str(
                "posture of the null space: from elsewhere than the controller's; \
                 allowed: the same source",
            ),
        }
    }
}

impl core::error::Error for ChangeError {}
