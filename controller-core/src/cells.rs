//! What something consists of: its numbers and flags by name, for tools that write a cycle down.

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
    /// Flags of joints, rows or slots: bit i of number i + 1.
    fn set(&mut self, name: &'static str, bits: &mut u8);
    /// A small number.
    fn count(&mut self, name: &'static str, value: &mut u8);
}
