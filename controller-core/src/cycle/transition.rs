//! Changes of tasks and gains while the arm moves.

use super::change_error::ChangeError;
use super::config::check_damping;
use super::controller::Controller;
use super::data::State;
use super::tasks::ActiveTasks;
use crate::error::ConfigError;
use crate::law::gain_bound;
use crate::law::null_space::{Compliance, NullSpace};
use crate::ranges::{CHANGE_RANGE_S, MAX_LEVELS};
use crate::real::Real;
use crate::task::{Axes, Capacity, Level, Order, Task, TaskGains, gains_on};

/// What is to become of the tasks or gains of a state. Slots count from 0
/// ([`TaskSet`](crate::task::TaskSet)).
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it in")]
pub enum Change {
    /// A task in a slot that has none, or back into one that it is leaving. Its target is joined
    /// from where the arm is.
    Add {
        /// The slot.
        slot: usize,
        /// The task.
        task: Task,
        /// So many of the others stay above it; or [`Change::BELOW_ALL`].
        place: usize,
    },
    /// The task of a slot goes. The last one may, too: then the whole arm is compliant.
    Remove {
        /// The slot.
        slot: usize,
    },
    /// All slots with a task, highest priority first.
    Reorder(Order),
    /// Other gains of a task.
    Gains {
        /// The slot.
        slot: usize,
        /// The gains.
        gains: TaskGains,
    },
    /// Another compliance of what the tasks leave; its damping is of the kind that there is.
    NullSpace(NullSpace),
}

impl Change {
    /// The place of a task below all others.
    pub const BELOW_ALL: usize = usize::MAX;
}

/// A [`Change`] that was checked and converted, to be begun between any two cycles.
#[derive(Clone, Debug)]
pub struct Transition<T: Real> {
    prepared: Prepared<T>,
    duration_s: T,
}

#[derive(Clone, Debug)]
enum Prepared<T: Real> {
    Add { level: Level<T>, place: usize },
    Remove { slot: usize },
    Reorder(Order),
    Gains { slot: usize, gains: TaskGains },
    NullSpace(Compliance<T>),
}

impl<T: Real> Controller<T> {
    /// What the controller has room for.
    #[must_use]
    pub fn capacity(&self) -> Capacity {
        self.capacity
    }

    /// Checks a change, which is to take `duration_s` \[s\], and converts it. A damping of the null
    /// space is searched through for its fastest mode, which takes far longer than a cycle: outside
    /// of it.
    ///
    /// # Errors
    /// What about it cannot be, whichever state it is for.
    pub fn transition(
        &self,
        change: &Change,
        duration_s: f64,
    ) -> Result<Transition<T>, ChangeError> {
        let [min, max] = CHANGE_RANGE_S;
        if !(duration_s >= min && duration_s <= max) {
            return Err(ChangeError::Duration { value: duration_s });
        }
        let prepared = match change {
            &Change::Add {
                slot,
                ref task,
                place,
            } => {
                self.check_tasks_may_change()?;
                self.check_slot(slot)?;
                task.validate(slot + 1)?;
                self.check_gains(&task.gains, task.axes, slot)?;
                let level = Level::new(task, slot, &self.arm, self.law.limits);
                Prepared::Add { level, place }
            }
            &Change::Remove { slot } => {
                self.check_tasks_may_change()?;
                self.check_slot(slot)?;
                Prepared::Remove { slot }
            }
            Change::Reorder(order) => {
                self.check_tasks_may_change()?;
                Prepared::Reorder(*order)
            }
            &Change::Gains { slot, gains } => {
                self.check_slot(slot)?;
                Prepared::Gains { slot, gains }
            }
            Change::NullSpace(null_space) => Prepared::NullSpace(self.compliance_of(null_space)?),
        };
        Ok(Transition {
            prepared,
            duration_s: T::from_f64(duration_s),
        })
    }

    /// Begins a change of the tasks of a state, in little time. What is on its way to something
    /// else goes on from where it is.
    ///
    /// # Errors
    /// Why the tasks of this state cannot be changed so; nothing is changed then.
    pub fn begin(
        &self,
        state: &mut State<T>,
        transition: &Transition<T>,
    ) -> Result<(), ChangeError> {
        let tasks = &mut state.data.tasks;
        let duration_s = transition.duration_s;
        let rate = T::ONE / duration_s;
        let wanted = tasks.wanted(&self.levels);
        match &transition.prepared {
            Prepared::Add { level, place } => {
                self.check_addition(tasks, level, *place)?;
                tasks.add(&self.own(), level, (*place, rate));
            }
            &Prepared::Remove { slot } => {
                self.check_taken(&wanted, slot)?;
                tasks.remove(&self.own(), slot, rate);
            }
            Prepared::Reorder(order) => {
                if !order.has_the_slots_of(&wanted) {
                    return Err(ChangeError::Order {
                        given: *order,
                        wanted,
                    });
                }
                tasks.reorder(&self.own(), order, rate);
            }
            Prepared::Gains { slot, gains } => {
                self.check_taken(&wanted, *slot)?;
                let all = tasks.levels(&self.levels).all();
                if let Some(level) = all.iter().find(|level| level.slot == *slot) {
                    let axes = level.axes;
                    gains.validate(slot + 1, axes)?;
                    self.check_gains(gains, axes, *slot)?;
                    tasks.set_gains(&self.own(), *slot, &gains_on(gains, axes), duration_s);
                }
            }
            Prepared::NullSpace(compliance) => {
                tasks.set_compliance(&self.own(), compliance, duration_s);
            }
        }
        Ok(())
    }

    /// Slots with a task, highest priority first: what is wanted, whether it is in force already
    /// or not.
    #[must_use]
    pub fn order(&self, state: &State<T>) -> Order {
        state.data.tasks.wanted(&self.levels)
    }

    fn check_tasks_may_change(&self) -> Result<(), ChangeError> {
        if self.law.limits {
            Ok(())
        } else {
            Err(ChangeError::ExactLaw)
        }
    }

    fn check_slot(&self, slot: usize) -> Result<(), ChangeError> {
        let slots = self.capacity.levels.min(MAX_LEVELS);
        if slot < slots {
            Ok(())
        } else {
            Err(ChangeError::Slot { slot, slots })
        }
    }

    fn check_gains(&self, gains: &TaskGains, axes: Axes, slot: usize) -> Result<(), ConfigError> {
        let cycle_s = self.cycle_s.to_f64();
        gain_bound::check(gains, axes, slot + 1, cycle_s, self.dead_cycles)
    }

    fn check_taken(&self, wanted: &Order, slot: usize) -> Result<(), ChangeError> {
        if wanted.contains(slot) {
            Ok(())
        } else {
            Err(ChangeError::SlotEmpty { slot })
        }
    }

    fn check_addition(
        &self,
        tasks: &ActiveTasks<T>,
        level: &Level<T>,
        place: usize,
    ) -> Result<(), ChangeError> {
        let (wanted, slot) = (tasks.wanted(&self.levels), level.slot);
        let mut leaving = tasks.levels(&self.levels).in_order().iter();
        let other = leaving.any(|own| own.slot == slot && !own.tracks_as(level));
        if wanted.contains(slot) || other {
            return Err(ChangeError::SlotTaken { slot });
        }
        if place > wanted.count() && place != Change::BELOW_ALL {
            return Err(ChangeError::Place {
                place,
                levels: wanted.count(),
            });
        }
        let rows = tasks.rows_beside(&self.own(), slot) + level.size;
        if rows > self.capacity.rows {
            return Err(ChangeError::Rows {
                rows,
                allowed: self.capacity.rows,
            });
        }
        Ok(())
    }

    /// As a configuration's is checked, in the precision of the controller.
    fn compliance_of(&self, null_space: &NullSpace) -> Result<Compliance<T>, ChangeError> {
        null_space.validate()?;
        let compliance = Compliance::new(null_space);
        if null_space.posture != self.compliance.posture {
            return Err(ChangeError::Posture);
        }
        if !compliance.has_the_kind_of(&self.compliance) {
            return Err(ChangeError::DampingKind);
        }
        check_damping(
            &self.arm,
            null_space,
            self.cycle_s.to_f64(),
            self.dead_cycles,
        )?;
        Ok(compliance)
    }
}
