//! Tasks and gains that change at times of a scenario.

use controller_core::joint::DOF;
use serde::Deserialize;

use super::level::AxisGain;
use crate::invalid::Invalid;
use crate::keys::allowed::{And, Said};
use crate::keys::{Key, keys};
use crate::ranges::{CHANGE_S, GAIN, LEVELS, TIME_S};

/// A change of tasks or gains while the arm moves; in files a table that says its kind.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Event {
    /// A level that is `absent`, or was removed, comes.
    Add(Addition),
    /// A level goes.
    Remove(Removal),
    /// A level gets other gains.
    Gains(OtherGains),
    /// The levels get another order.
    Reorder(Reordering),
    /// The null space gets another compliance.
    NullSpace(OtherCompliance),
}

keys! {
    /// A level comes.
    #[derive(Clone, Debug)]
    pub struct Addition {
        /// When it begins.
        pub at_s: f64, "s", TIME_S;
        /// How long it takes.
        pub duration_s: f64 = 0.5, "s", CHANGE_S;
        /// Its number among the `[[level]]` tables, whatever its priority becomes.
        pub level: usize, "", And(LEVELS, "absent by then");
        /// Its place among the levels: 1 is the highest priority.
        pub place: Option<usize> = None => "below all others", "", Said("1 to one more than there are levels by then");
    }
}

keys! {
    /// A level goes.
    #[derive(Clone, Debug)]
    pub struct Removal {
        /// When it begins.
        pub at_s: f64, "s", TIME_S;
        /// How long it takes.
        pub duration_s: f64 = 0.5, "s", CHANGE_S;
        /// Its number among the `[[level]]` tables.
        pub level: usize, "", And(LEVELS, "there by then");
    }
}

keys! {
    /// A level gets other gains.
    #[derive(Clone, Debug)]
    pub struct OtherGains {
        /// When it begins.
        pub at_s: f64, "s", TIME_S;
        /// How long it takes.
        pub duration_s: f64 = 0.5, "s", CHANGE_S;
        /// Its number among the `[[level]]` tables.
        pub level: usize, "", And(LEVELS, "there by then");
        /// K_p.
        pub stiffness: AxisGain, "1/s2", And(GAIN, LIKE_LEVEL);
        /// K_d.
        pub damping: AxisGain, "1/s", And(GAIN, LIKE_LEVEL);
    }
}

keys! {
    /// The levels get another order.
    #[derive(Clone, Debug)]
    pub struct Reordering {
        /// When it begins.
        pub at_s: f64, "s", TIME_S;
        /// How long a level takes to go, and again to come where it is put.
        pub duration_s: f64 = 0.5, "s", CHANGE_S;
        /// The levels by their numbers, highest priority first.
        pub order: Vec<usize>, "", Said("each level that is there by then once");
    }
}

keys! {
    /// The null space gets another compliance.
    #[derive(Clone, Debug)]
    pub struct OtherCompliance {
        /// When it begins.
        pub at_s: f64, "s", TIME_S;
        /// How long it takes.
        pub duration_s: f64 = 0.5, "s", CHANGE_S;
        /// K_q, diagonal.
        pub stiffness: [f64; DOF], "Nm/rad", GAIN;
        /// D, diagonal.
        pub damping: [f64; DOF], "Nms/rad", GAIN;
        /// c of D = c M, which takes the place of `damping` in a loop with dead time and over FRI.
        pub damping_rate: f64 = 10.0, "1/s", GAIN;
    }
}

const LIKE_LEVEL: &str = "one for all axes of the level, or a list with one for each";

/// Kinds of events by their words, with their keys.
pub(crate) const EVENTS: [(&str, &[Key]); 5] = [
    ("add", Addition::KEYS),
    ("remove", Removal::KEYS),
    ("gains", OtherGains::KEYS),
    ("reorder", Reordering::KEYS),
    ("null-space", OtherCompliance::KEYS),
];

impl Event {
    /// Each of its keys by itself.
    pub(super) fn check(&self) -> Result<(), Invalid> {
        match self {
            Self::Add(event) => event.check_keys(),
            Self::Remove(event) => event.check_keys(),
            Self::Gains(event) => event.check_keys(),
            Self::Reorder(event) => event.check_keys(),
            Self::NullSpace(event) => event.check_keys(),
        }
    }

    /// When it begins \[s\].
    #[must_use]
    pub fn at_s(&self) -> f64 {
        match self {
            Self::Add(event) => event.at_s,
            Self::Remove(event) => event.at_s,
            Self::Gains(event) => event.at_s,
            Self::Reorder(event) => event.at_s,
            Self::NullSpace(event) => event.at_s,
        }
    }

    /// How long a level comes, goes or gets other gains \[s\].
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match self {
            Self::Add(event) => event.duration_s,
            Self::Remove(event) => event.duration_s,
            Self::Gains(event) => event.duration_s,
            Self::Reorder(event) => event.duration_s,
            Self::NullSpace(event) => event.duration_s,
        }
    }

    /// When it is over \[s\].
    #[must_use]
    pub fn ends_s(&self) -> f64 {
        // A level falls before it rises elsewhere.
        let times = if matches!(self, Self::Reorder(_)) {
            2.0
        } else {
            1.0
        };
        self.at_s() + times * self.duration_s()
    }

    /// "level 2 comes".
    #[must_use]
    pub fn label(&self) -> String {
        match self {
            Self::Add(event) => format!("level {} comes", event.level),
            Self::Remove(event) => format!("level {} goes", event.level),
            Self::Gains(event) => format!("other gains of level {}", event.level),
            Self::Reorder(event) => {
                let order: Vec<_> = event.order.iter().map(usize::to_string).collect();
                format!("order of the levels {}", order.join(", "))
            }
            Self::NullSpace(_) => "other compliance of the null space".to_string(),
        }
    }
}
