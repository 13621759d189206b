//! The tree as serde reads it. Types are checked here and not by serde, which would speak
//! of the program's.

use std::fmt::Display;
use std::iter::{self, Peekable};

use serde::de::value::{MapAccessDeserializer, MapDeserializer};
use serde::de::{
    DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;

use super::tree::{Node, Value};
use crate::invalid::Invalid;

/// The key by which a table says which of several shapes it has.
const KIND: &str = "kind";

const TEXT: &str = "text in quotes";

impl Error for Invalid {
    fn custom<T: Display>(message: T) -> Self {
        Self::line(message)
    }

    fn unknown_field(given: &str, known: &'static [&'static str]) -> Self {
        Self::key(given, known)
    }

    /// Of choices alone: the types of all else are checked here.
    fn invalid_type(found: Unexpected<'_>, _: &dyn Expected) -> Self {
        match found {
            Unexpected::UnitVariant => Self::line("a word; allowed: a table that says its kind"),
            found => Self::line(format_args!("{found}; allowed: {TEXT}")),
        }
    }

    fn missing_field(key: &'static str) -> Self {
        Self::line(format_args!("missing key '{key}'"))
    }

    fn duplicate_field(key: &'static str) -> Self {
        Self::line(format_args!("key '{key}': given twice; allowed: once"))
    }
}

impl Value {
    fn refused(&self, allowed: &str) -> Invalid {
        let found = match self {
            Self::Other(name) => Unexpected::Other(name),
            Self::Switch(on) => Unexpected::Bool(*on),
            Self::Whole(number) => Unexpected::Signed(*number),
            Self::Number(number) => Unexpected::Float(*number),
            Self::Text(text) => Unexpected::Str(text),
            Self::List(_) => Unexpected::Seq,
            Self::Table(_) => Unexpected::Map,
        };
        Invalid::line(format_args!("{found}; allowed: {allowed}"))
    }
}

impl Node {
    /// The word, which must be a known one.
    fn choice(&self, known: &'static [&'static str]) -> Result<&str, Invalid> {
        match &self.value {
            Value::Text(word) if known.contains(&word.as_str()) => Ok(word),
            Value::Text(word) => Err(Invalid::unknown(word, known)),
            other => Err(other.refused(TEXT)),
        }
    }

    /// Reads an entry; an error in it says the way to it.
    fn read<'de, S: DeserializeSeed<'de>>(&'de self, seed: S) -> Result<S::Value, Invalid> {
        seed.deserialize(self).map_err(|error| match &self.step {
            Some(step) => error.inside(step.clone()),
            None => error,
        })
    }
}

/// The entries of a list or a table, one after the other.
struct Entries<I: Iterator>(Peekable<I>);

impl<'de, I: Iterator<Item = &'de Node>> SeqAccess<'de> for Entries<I> {
    type Error = Invalid;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Invalid> {
        self.0.next().map(|entry| entry.read(seed)).transpose()
    }
}

impl<'de, I: Iterator<Item = &'de Node>> MapAccess<'de> for Entries<I> {
    type Error = Invalid;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Invalid> {
        let key = self.0.peek().map(|entry| entry.key().into_deserializer());
        key.map(|key| seed.deserialize(key)).transpose()
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Invalid> {
        let entry = self.0.next().expect("a value follows its key");
        entry.read(seed)
    }
}

/// A method for values that look like the pattern.
macro_rules! only {
    ($($method:ident $pattern:pat => $allowed:expr;)+) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Invalid> {
            match self.value {
                $pattern => self.deserialize_any(visitor),
                _ => Err(self.value.refused($allowed)),
            }
        }
    )+};
}

impl<'de> Deserializer<'de> for &'de Node {
    type Error = Invalid;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Invalid> {
        match &self.value {
            Value::Other(_) => visitor.visit_unit(),
            Value::Switch(on) => visitor.visit_bool(*on),
            Value::Whole(number) => visitor.visit_i64(*number),
            Value::Number(number) => visitor.visit_f64(*number),
            Value::Text(text) => visitor.visit_borrowed_str(text),
            Value::List(entries) => visitor.visit_seq(Entries(entries.iter().peekable())),
            Value::Table(entries) => visitor.visit_map(Entries(entries.iter().peekable())),
        }
    }

    only! {
        deserialize_bool Value::Switch(_) => "true or false";
        deserialize_u64 Value::Whole(0..) => "a whole number from 0";
        deserialize_f64 Value::Whole(_) | Value::Number(_) => "a number";
        deserialize_str Value::Text(_) => TEXT;
        deserialize_string Value::Text(_) => TEXT;
        deserialize_seq Value::List(_) => "a list";
        deserialize_map Value::Table(_) => "a table";
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Invalid> {
        match &self.value {
            Value::List(entries) if entries.len() != length => {
                let count = entries.len();
                let text = format!("{count} values; allowed: {length}");
                Err(Invalid::line(text))
            }
            _ => self.deserialize_seq(visitor),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Invalid> {
        self.deserialize_map(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Invalid> {
        match self.value {
            Value::Other("null") => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    /// A choice is a word, or a table that says it as its kind.
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        known: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Invalid> {
        let Value::Table(entries) = &self.value else {
            return visitor.visit_enum(self.choice(known)?.into_deserializer());
        };
        let kind = entries.iter().find(|entry| entry.key() == KIND);
        let kind = kind.ok_or_else(|| Invalid::missing_field(KIND))?;
        let word = kind.choice(known).map_err(|error| error.in_table(KIND))?;
        let others = entries.iter().filter(|entry| entry.key() != KIND);
        let others = MapAccessDeserializer::new(Entries(others.peekable()));
        let choice = MapDeserializer::new(iter::once((word, others)));
        visitor.visit_enum(MapAccessDeserializer::new(choice))
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 u8 u16 u32 f32 char bytes byte_buf unit unit_struct newtype_struct
        tuple_struct identifier ignored_any
    }
}
