//! What may stand behind a key: text for the document, check for the reader.

use std::marker::PhantomData;

use controller_core::Axes;
use controller_core::joint::Vector3;
use serde::Deserialize;

use super::numbers::{Numbers, Span};
use super::words::{listed, words};
use crate::invalid::Invalid;
use crate::names::{Named, letters, simple};
use crate::ranges::{NAME_LETTERS, Range};

/// What is allowed of a value of type `T`.
pub trait Allowed<T> {
    /// As a sentence of the document has it.
    fn text(&self) -> String;

    /// The numbers, where nothing else counts.
    fn span(&self) -> Option<Span> {
        None
    }

    /// # Errors
    /// The value of `key` is not allowed.
    fn check(&self, key: &str, value: &T) -> Result<(), Invalid>;
}

/// Numbers, each within the range.
impl<T: Numbers> Allowed<T> for Range<f64> {
    fn text(&self) -> String {
        match T::how_many() {
            one if one.is_empty() => self.to_string(),
            many => format!("{many}, each {self}"),
        }
    }

    fn span(&self) -> Option<Span> {
        Some(Span {
            range: *self,
            whole: false,
            count: T::how_many().parse().ok(),
        })
    }

    fn check(&self, key: &str, value: &T) -> Result<(), Invalid> {
        let numbers = value.numbers();
        for (place, &number) in numbers.iter().enumerate() {
            match numbers {
                [_] => self.check(key, number)?,
                // As the reader says which one.
                _ => self.check(format_args!("{key} {}", place + 1), number)?,
            };
        }
        Ok(())
    }
}

/// A whole number.
impl Allowed<usize> for Range<usize> {
    fn text(&self) -> String {
        self.to_string()
    }

    fn span(&self) -> Option<Span> {
        Some(Span {
            range: Range::new(self.min as f64, self.max as f64),
            whole: true,
            count: None,
        })
    }

    fn check(&self, key: &str, value: &usize) -> Result<(), Invalid> {
        self.check(key, *value).map(drop)
    }
}

/// So many entries of a list; what they are is in words.
pub struct Count(pub Range<usize>, pub &'static str);

impl<T> Allowed<Vec<T>> for Count {
    fn text(&self) -> String {
        let Self(range, things) = self;
        match range.min == range.max {
            true => format!("{} {things}", range.min),
            false => format!("{range} {things}"),
        }
    }

    fn check(&self, key: &str, value: &Vec<T>) -> Result<(), Invalid> {
        let Self(range, things) = self;
        if range.contains(value.len()) {
            return Ok(());
        }
        Err(Invalid::new(
            key,
            format_args!("{} {things}", value.len()),
            Allowed::<Vec<T>>::text(self),
        ))
    }
}

/// So many lists of numbers, each of these within the range.
pub struct Lists(pub Count, pub Range<f64>);

impl<T: Numbers> Allowed<Vec<T>> for Lists {
    fn text(&self) -> String {
        let Self(count, range) = self;
        let (count, each) = (Allowed::<Vec<T>>::text(count), Allowed::<T>::text(range));
        format!("{count} of {each}")
    }

    fn check(&self, key: &str, value: &Vec<T>) -> Result<(), Invalid> {
        let Self(count, range) = self;
        count.check(key, value)?;
        let mut each = value.iter();
        each.try_for_each(|numbers| Allowed::check(range, key, numbers))
    }
}

/// A vector whose length is within the range.
pub struct Length(pub Range<f64>);

impl Allowed<[f64; 3]> for Length {
    fn text(&self) -> String {
        format!("3, together of length {}", self.0)
    }

    fn check(&self, key: &str, value: &[f64; 3]) -> Result<(), Invalid> {
        let length = Vector3::from(*value).norm();
        self.0.check(format_args!("{key} length"), length).map(drop)
    }
}

/// As the first says; the words say what else is checked, with the values of other keys.
pub struct And<A>(pub A, pub &'static str);

impl<T, A: Allowed<T>> Allowed<T> for And<A> {
    fn text(&self) -> String {
        format!("{}; {}", self.0.text(), self.1)
    }

    fn span(&self) -> Option<Span> {
        self.0.span()
    }

    fn check(&self, key: &str, value: &T) -> Result<(), Invalid> {
        self.0.check(key, value)
    }
}

/// What the words say, which is checked with the values of other keys.
pub struct Said(pub &'static str);

impl<T> Allowed<T> for Said {
    fn text(&self) -> String {
        self.0.to_string()
    }

    fn check(&self, _: &str, _: &T) -> Result<(), Invalid> {
        Ok(())
    }
}

/// A word of a choice, or true or false: the reader knows no other.
pub struct Choice;

impl<T: Deserialize<'static>> Allowed<T> for Choice {
    fn text(&self) -> String {
        match words::<T>() {
            [] => "`true`, `false`".to_string(),
            words => listed(words.iter().copied()),
        }
    }

    fn check(&self, _: &str, _: &T) -> Result<(), Invalid> {
        Ok(())
    }
}

/// The name of one of `T`.
pub struct NameOf<T>(pub PhantomData<T>);

impl<T: Named> Allowed<String> for NameOf<T> {
    fn text(&self) -> String {
        listed(T::ALL.iter().map(|(name, _)| *name))
    }

    fn check(&self, _: &str, value: &String) -> Result<(), Invalid> {
        T::from_name(value).map(drop)
    }
}

/// A name that may become one of a folder or a constant.
pub struct Simple;

impl Allowed<String> for Simple {
    fn text(&self) -> String {
        letters()
    }

    fn check(&self, key: &str, value: &String) -> Result<(), Invalid> {
        simple(key, value)
    }
}

/// A name that is shown.
pub struct Shown;

impl Allowed<String> for Shown {
    fn text(&self) -> String {
        format!("{NAME_LETTERS} letters that print")
    }

    fn check(&self, key: &str, value: &String) -> Result<(), Invalid> {
        let count = value.chars().count();
        if NAME_LETTERS.contains(count) && !value.chars().any(char::is_control) {
            return Ok(());
        }
        Err(Invalid::new(key, value, self.text()))
    }
}

/// Axes of a task.
pub struct AxesOf;

impl Allowed<String> for AxesOf {
    fn text(&self) -> String {
        "letters of xyz in this order, such as xyz, xy, z".to_string()
    }

    fn check(&self, key: &str, value: &String) -> Result<(), Invalid> {
        match Axes::from_name(value) {
            Some(_) => Ok(()),
            None => Err(Invalid::new(key, value, self.text())),
        }
    }
}
