//! What something consists of: its numbers and flags by name, for tools that write a cycle down.

use crate::fault::IndexSet;

/// Sees numbers and flags, always in the same order, and may change them.
pub trait Cells<T> {
    /// What follows belongs to the level at a place, or to none.
    fn level(&mut self, place: Option<usize>) {
        let _ = place;
    }
    /// Numbers that belong together.
    fn numbers(&mut self, name: &'static str, values: &mut [T]);
    /// One flag.
    fn flag(&mut self, name: &'static str, value: &mut bool);
    /// Flags of joints, rows or slots.
    fn set(&mut self, name: &'static str, value: &mut IndexSet);
    /// A small number.
    fn count(&mut self, name: &'static str, value: &mut u8);
}
