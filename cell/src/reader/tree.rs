//! What a text says, and where: one tree for both formats.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::invalid::{Invalid, Segment};

/// A value at its place in a text.
#[derive(Debug)]
pub struct Node {
    /// The last step on the way to it; none of the whole text.
    pub step: Option<Segment>,
    /// Offset in the text.
    at: usize,
    pub value: Value,
}

/// What can be written.
#[derive(Debug)]
pub enum Value {
    /// What no key takes, by name: a date. "null" is as good as no key at all.
    Other(&'static str),
    Switch(bool),
    Whole(i64),
    Number(f64),
    Text(String),
    List(Vec<Node>),
    /// Every entry's step is its key.
    Table(Vec<Node>),
}

impl Node {
    /// The tree of a TOML text.
    ///
    /// # Errors
    /// No TOML.
    pub fn of_toml(text: &str) -> Result<Self, Invalid> {
        let document = DeTable::parse(text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            Invalid::line(error.message())
                .within(format_args!("'{}'", around(text, at)))
                .within(format_args!("line {}", line(text, at)))
        })?;
        let document = Spanned::new(0..0, DeValue::Table(document.into_inner()));
        Ok(Self::toml(None, document))
    }

    fn toml(step: Option<Segment>, value: Spanned<DeValue<'_>>) -> Self {
        let at = value.span().start;
        let value = match value.into_inner() {
            DeValue::String(text) => Value::Text(text.into_owned()),
            // What does not fit is beyond every range.
            DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix())
                .map_or(Value::Number(f64::INFINITY), Value::Whole),
            DeValue::Float(digits) => Value::Number(digits.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(on) => Value::Switch(on),
            DeValue::Datetime(_) => Value::Other("date"),
            DeValue::Array(list) => {
                let list = list.into_iter().enumerate();
                let entry = |(index, value)| Self::toml(Some(Segment::Index(index)), value);
                Value::List(list.map(entry).collect())
            }
            DeValue::Table(table) => {
                let key = |key: Spanned<DeString<'_>>| Segment::Key(key.into_inner().into_owned());
                let entry = |(name, value)| Self::toml(Some(key(name)), value);
                Value::Table(table.into_iter().map(entry).collect())
            }
        };
        Self { step, at, value }
    }

    /// The tree of a JSON text.
    ///
    /// # Errors
    /// No JSON.
    pub fn of_json(text: &str) -> Result<Self, Invalid> {
        // This bounds the depth, too.
        serde_json::from_str::<serde_json::Value>(text)
            .and_then(|_| Self::json(text, None, serde_json::from_str(text)?))
            .map_err(|error| {
                let lines = text
                    .split_inclusive('\n')
                    .take(error.line().saturating_sub(1));
                let at = lines.map(str::len).sum::<usize>() + error.column();
                let thing = format_args!("'{}'", around(text, at)).to_string();
                Invalid::new(thing, error, "JSON, which has finite numbers only")
            })
    }

    fn json(text: &str, step: Option<Segment>, raw: &RawValue) -> serde_json::Result<Self> {
        let own = raw.get();
        // It is a part of the text.
        let at = own.as_ptr().addr() - text.as_ptr().addr();
        let value = match own.as_bytes() {
            [b'{', ..] => {
                let Entries(table) = serde_json::from_str(own)?;
                let entry = |(key, value)| Self::json(text, Some(Segment::Key(key)), value);
                Value::Table(table.into_iter().map(entry).collect::<Result<_, _>>()?)
            }
            [b'[', ..] => {
                let list = serde_json::from_str::<Vec<&RawValue>>(own)?
                    .into_iter()
                    .enumerate();
                let entry = |(index, value)| Self::json(text, Some(Segment::Index(index)), value);
                Value::List(list.map(entry).collect::<Result<_, _>>()?)
            }
            [b'"', ..] => Value::Text(serde_json::from_str(own)?),
            [b't' | b'f', ..] => Value::Switch(serde_json::from_str(own)?),
            [b'n', ..] => Value::Other("null"),
            _ => match serde_json::from_str(own) {
                Ok(whole) => Value::Whole(whole),
                Err(_) => Value::Number(serde_json::from_str(own)?),
            },
        };
        Ok(Self { step, at, value })
    }

    /// Its key in a table.
    pub fn key(&self) -> &str {
        match &self.step {
            Some(Segment::Key(key)) => key,
            _ => "",
        }
    }

    /// The offset of the value that `path` leads to; of the last part of the path that exists.
    pub fn offset(&self, path: &[Segment]) -> usize {
        let (Value::List(entries) | Value::Table(entries)) = &self.value else {
            return self.at;
        };
        let next = entries
            .iter()
            .find(|entry| entry.step.as_ref() == path.first());
        match (next, path) {
            (Some(next), [_, rest @ ..]) => next.offset(rest),
            _ => self.at,
        }
    }
}

/// The entries of a JSON object as written: a key may come twice.
struct Entries<'a>(Vec<(String, &'a RawValue)>);

impl<'de> Deserialize<'de> for Entries<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let entries = std::iter::from_fn(|| map.next_entry().transpose());
                entries.collect::<Result<_, _>>().map(Entries)
            }
        }
        deserializer.deserialize_map(Reader)
    }
}

/// The line of an offset, counted from 1.
pub fn line(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|&byte| byte == b'\n').count()
}

/// The line that an offset is in; of a long one what is near.
fn around(text: &str, at: usize) -> &str {
    const NEAR: usize = 40;
    let at = text.floor_char_boundary(at);
    let (before, after) = text.split_at(at);
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let end = after.find('\n').map_or(text.len(), |length| at + length);
    let start = text.ceil_char_boundary(start.max(at.saturating_sub(NEAR)));
    let end = text.floor_char_boundary(end.min(at + NEAR));
    text[start..end].trim()
}
