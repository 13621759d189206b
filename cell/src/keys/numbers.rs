//! Numbers as values of keys: one, a fixed number of them, or none.

use crate::ranges::Range;

/// What reads as numbers that share a range.
pub trait Numbers {
    /// How many there are, as words; empty of one.
    fn how_many() -> String;

    /// The numbers.
    fn numbers(&self) -> &[f64];
}

impl Numbers for f64 {
    fn how_many() -> String {
        String::new()
    }

    fn numbers(&self) -> &[f64] {
        std::slice::from_ref(self)
    }
}

impl<const N: usize> Numbers for [f64; N] {
    fn how_many() -> String {
        N.to_string()
    }

    fn numbers(&self) -> &[f64] {
        self
    }
}

impl<T: Numbers> Numbers for Option<T> {
    fn how_many() -> String {
        T::how_many()
    }

    fn numbers(&self) -> &[f64] {
        self.as_ref().map_or(&[], T::numbers)
    }
}

/// A range as numbers, whatever its type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The range.
    pub range: Range<f64>,
    /// Whether the numbers are whole.
    pub whole: bool,
    /// How many numbers the key has as a list; none of one number.
    pub count: Option<usize>,
}
