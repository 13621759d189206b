//! What the events of a scenario make of its levels, one after the other.

use controller_core::gain::diagonal;
use controller_core::law::null_space::{Damping, NullDamping, NullSpace, Posture};
use controller_core::{Change, Controller, Order, Transition};

use super::arm::EquippedArm;
use super::event::{Event, Reordering};
use super::level::{AxisGain, LevelSpec};
use crate::invalid::Invalid;
use crate::ranges::Range;

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

/// What of a scenario events change, and the events.
pub(super) struct Changing<'a> {
    pub levels: &'a [LevelSpec],
    pub events: &'a [Event],
    pub arm: EquippedArm,
    pub posture: Posture,
}

/// Levels and gains as the events before have left them.
struct Course<'a> {
    of: &'a Changing<'a>,
    /// Indices of levels, highest priority first.
    order: Vec<usize>,
    gains: Vec<[AxisGain; 2]>,
    dead_cycles: u8,
}

impl<'a> Course<'a> {
    fn new(of: &'a Changing<'a>, dead_cycles: u8) -> Self {
        let levels = of.levels;
        Self {
            of,
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
                let spec = &self.of.levels[level];
                let mut task = spec.task(level, &self.of.arm);
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
                let spec = &self.of.levels[level];
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
                posture: self.of.posture,
            }),
        })
    }

    /// Index of a level.
    fn level(&self, number: usize) -> Result<usize, Invalid> {
        let numbers = Range::new(1, self.of.levels.len());
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

/// A change that is prepared, with the time when it begins \[s\].
pub type TimedTransition = (f64, Transition<f64>);

impl Changing<'_> {
    /// The events as `controller`, of this scenario, is to begin them, in the order of their times.
    ///
    /// # Errors
    /// An event that the core refuses, for example one of tasks of the exact law.
    pub(super) fn transitions(
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
        prepared.collect()
    }

    /// The events in the order of their times, for a loop with `dead_cycles` cycles between
    /// measurement and torque.
    ///
    /// # Errors
    /// The first event that cannot be, after those before it.
    pub(super) fn changes(&self, dead_cycles: u8) -> Result<Vec<TimedChange>, Invalid> {
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
