//! Slots in order of priority.

use crate::ranges::MAX_LEVELS;

/// Slots of a [`TaskSet`](super::TaskSet), counted from 0, highest priority first; none twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    slots: [u8; MAX_LEVELS],
    count: u8,
}

impl Order {
    /// Of no slot.
    pub const NONE: Self = Self {
        slots: [0; MAX_LEVELS],
        count: 0,
    };

    /// Of these slots; none where one is beyond the last or stands twice.
    #[must_use]
    pub fn new(slots: &[usize]) -> Option<Self> {
        let mut order = Self::NONE;
        for &slot in slots {
            if slot >= MAX_LEVELS || order.contains(slot) {
                return None;
            }
            order.insert(order.count(), slot);
        }
        Some(order)
    }

    /// Number of slots.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count.into()
    }

    /// The slots, highest priority first.
    pub fn slots(&self) -> impl Iterator<Item = usize> + '_ {
        self.slots
            .iter()
            .take(self.count())
            .map(|&slot| slot.into())
    }

    /// Place of a slot, counted from 0.
    #[must_use]
    pub fn place(&self, slot: usize) -> Option<usize> {
        self.slots().position(|other| other == slot)
    }

    /// Whether a slot is in it.
    #[must_use]
    pub fn contains(&self, slot: usize) -> bool {
        self.place(slot).is_some()
    }

    /// Whether both have the same slots.
    #[must_use]
    pub fn has_the_slots_of(&self, other: &Self) -> bool {
        self.count == other.count && self.slots().all(|slot| other.contains(slot))
    }

    /// Puts a slot that is not in it at a place, or behind the last one.
    pub(crate) fn insert(&mut self, place: usize, slot: usize) {
        let (mut carried, count) = (slot as u8, self.count());
        for held in self.slots.iter_mut().take(count + 1).skip(place.min(count)) {
            core::mem::swap(held, &mut carried);
        }
        self.count = (self.count + 1).min(MAX_LEVELS as u8);
    }

    /// Takes a slot out.
    pub(crate) fn remove(&mut self, slot: usize) {
        let before = *self;
        *self = Self::NONE;
        for other in before.slots().filter(|&other| other != slot) {
            self.insert(MAX_LEVELS, other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(order: &Order) -> [Option<usize>; 4] {
        let mut slots = order.slots();
        [(); 4].map(|()| slots.next())
    }

    #[test]
    fn slots_are_put_in_and_taken_out_in_order() {
        let mut order = Order::new(&[0, 1]).expect("two");
        order.insert(0, 5);
        assert_eq!(listed(&order), [Some(5), Some(0), Some(1), None]);
        order.remove(0);
        order.insert(9, 3);
        assert_eq!(listed(&order), [Some(5), Some(1), Some(3), None]);
        assert_eq!(order.place(1), Some(1));
        assert_eq!(order.place(0), None);
    }

    #[test]
    fn no_slot_stands_twice_or_beyond_the_last() {
        assert_eq!(Order::new(&[1, 1]), None);
        assert_eq!(Order::new(&[MAX_LEVELS]), None);
        let all = [6, 5, 4, 3, 2, 1, 0];
        assert_eq!(Order::new(&all).map(|order| order.count()), Some(7));
    }

    #[test]
    fn a_full_order_stays_full() {
        let mut order = Order::new(&[0, 1, 2, 3, 4, 5, 6]).expect("all");
        order.insert(0, 3);
        assert_eq!(order.count(), MAX_LEVELS);
    }
}
