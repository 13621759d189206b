//! Tasks and gains that change at times of a scenario.

use controller_core::gain::diagonal;
use controller_core::joint::DOF;
use controller_core::law::null_space::{Damping, NullDamping, NullSpace};
use controller_core::{Change, Controller, Order, Transition};
use serde::Deserialize;

use super::Scenario;
use super::level::AxisGain;
use crate::invalid::Invalid;
use crate::keys::allowed::{And, Said};
use crate::keys::{Key, keys};
use crate::ranges::{CHANGE_S, GAIN, LEVELS, Range, TIME_S};

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

/// An event as the controller core takes it.
#[derive(Clone, Debug)]
pub struct TimedChange {
    /// When it begins \[s\].
    pub at_s: f64,
    /// How long it takes \[s\].
    pub duration_s: f64,
    /// What changes.
    pub change: Change,
}

/// Levels and gains as the events before have left them.
struct Course<'a> {
    scenario: &'a Scenario,
    /// Indices of levels, highest priority first.
    order: Vec<usize>,
    gains: Vec<[AxisGain; 2]>,
    dead_cycles: u8,
}

impl<'a> Course<'a> {
    fn new(scenario: &'a Scenario, dead_cycles: u8) -> Self {
        let levels = &scenario.levels;
        Self {
            scenario,
            order: (0..levels.len())
                .filter(|&index| !levels[index].absent)
                .collect(),
            gains: (levels.iter())
                .map(|level| [level.stiffness.clone(), level.damping.clone()])
                .collect(),
            dead_cycles,
        }
    }

    /// What an event makes of it.
    fn change(&mut self, event: &Event) -> Result<Change, Invalid> {
        Ok(match event {
            Event::Add(addition) => {
                let level = self.level(addition.level)?;
                if self.order.contains(&level) {
                    let given = format!("{}, which is there", level + 1);
                    return Err(Invalid::new("level", given, "a level that is absent"));
                }
                let places = Range::new(1, self.order.len() + 1);
                let place = places.check("place", addition.place.unwrap_or(places.max))? - 1;
                self.order.insert(place, level);
                let [stiffness, damping] = &self.gains[level];
                let spec = &self.scenario.levels[level];
                let mut task = spec.task(level, &self.scenario.arm());
                task.gains = spec.gains(stiffness, damping);
                Change::Add {
                    slot: level,
                    task,
                    place,
                }
            }
            Event::Remove(removal) => {
                let level = self.present(removal.level)?;
                self.order.retain(|&other| other != level);
                Change::Remove { slot: level }
            }
            Event::Gains(other) => {
                let level = self.present(other.level)?;
                let spec = &self.scenario.levels[level];
                spec.check_gain("stiffness", &other.stiffness)?;
                spec.check_gain("damping", &other.damping)?;
                self.gains[level] = [other.stiffness.clone(), other.damping.clone()];
                Change::Gains {
                    slot: level,
                    gains: spec.gains(&other.stiffness, &other.damping),
                }
            }
            Event::Reorder(Reordering { order: given, .. }) => {
                let order: Vec<_> = given.iter().map(|number| number.wrapping_sub(1)).collect();
                let (mut sorted, mut there) = (order.clone(), self.order.clone());
                sorted.sort_unstable();
                there.sort_unstable();
                match Order::new(&order) {
                    Some(slots) if sorted == there => {
                        self.order = order;
                        Change::Reorder(slots)
                    }
                    _ => {
                        let numbers: Vec<_> = there.iter().map(|index| index + 1).collect();
                        let allowed = format!("each of {numbers:?} once");
                        return Err(Invalid::new("order", format!("{given:?}"), allowed));
                    }
                }
            }
            Event::NullSpace(other) => Change::NullSpace(NullSpace {
                stiffness: diagonal(other.stiffness),
                damping: match self.dead_cycles {
                    0 => NullDamping::Joint(diagonal(other.damping)),
                    _ => NullDamping::Inertia(other.damping_rate),
                },
                posture: self.scenario.null_space.posture.of_core(),
            }),
        })
    }

    /// Index of a level.
    fn level(&self, number: usize) -> Result<usize, Invalid> {
        let numbers = Range::new(1, self.scenario.levels.len());
        Ok(numbers.check("level", number)? - 1)
    }

    /// The same of one that is there.
    fn present(&self, number: usize) -> Result<usize, Invalid> {
        let level = self.level(number)?;
        if self.order.contains(&level) {
            return Ok(level);
        }
        let given = format!("{}, which is absent", level + 1);
        Err(Invalid::new("level", given, "a level that is there"))
    }
}

impl Event {
    fn check(&self) -> Result<(), Invalid> {
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

/// A change that is prepared, with the time when it begins \[s\].
pub type TimedTransition = (f64, Transition<f64>);

impl Scenario {
    /// The events as `controller`, of this scenario, is to begin them, in the order of their times.
    ///
    /// # Errors
    /// An event that the core refuses, for example one of tasks of the exact law.
    pub fn transitions(
        &self,
        controller: &Controller<f64>,
    ) -> Result<Vec<TimedTransition>, Invalid> {
        let dead_cycles = match controller.compliance().damping {
            Damping::Joint(_) => 0,
            Damping::Inertia(_) => 1,
        };
        let changes = self.changes(dead_cycles)?;
        let prepared = changes.iter().map(|timed| {
            let (at_s, change) = (timed.at_s, &timed.change);
            let prepared = controller.transition(change, timed.duration_s);
            let at = |error| Invalid::line(format_args!("event at {at_s} s: {error}"));
            Ok((at_s, prepared.map_err(at)?))
        });
        let within = |error: Invalid| error.within(&self.name);
        prepared.collect::<Result<_, _>>().map_err(within)
    }

    /// The events in the order of their times, for a loop with `dead_cycles` cycles between
    /// measurement and torque.
    ///
    /// # Errors
    /// The first event that cannot be, after those before it.
    pub fn changes(&self, dead_cycles: u8) -> Result<Vec<TimedChange>, Invalid> {
        let mut events: Vec<_> = self.events.iter().enumerate().collect();
        events.sort_by(|(_, a), (_, b)| a.at_s().total_cmp(&b.at_s()));
        let mut course = Course::new(self, dead_cycles);
        let mut changes = Vec::new();
        for (number, event) in events {
            let place = |error: Invalid| error.in_list("event", number);
            event.check().map_err(place)?;
            let change = course.change(event).map_err(place)?;
            changes.push(TimedChange {
                at_s: event.at_s(),
                duration_s: event.duration_s(),
                change,
            });
        }
        Ok(changes)
    }
}
