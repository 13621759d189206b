//! Choices that serde knows by their words, and values as TOML.

use serde::de::{Deserialize, Deserializer, Visitor};
use serde::forward_to_deserialize_any;

use crate::invalid::Invalid;

/// Asks a type for its words and reads nothing.
struct Ask<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for Ask<'_> {
    type Error = Invalid;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Invalid> {
        Err(Invalid::line("nothing to read"))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Invalid> {
        *self.0 = words;
        self.deserialize_any(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

/// The words of an enum, in the order of its variants; none of other types.
pub fn words<T: Deserialize<'static>>() -> &'static [&'static str] {
    let mut words: &[&str] = &[];
    // It reads nothing, so this fails.
    let _ = T::deserialize(Ask(&mut words));
    words
}

/// Words as a list of what may be written.
pub fn listed<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let quoted = words.into_iter().map(|word| format!("`\"{word}\"`"));
    quoted.collect::<Vec<_>>().join(", ")
}

/// A value as a file has it.
pub trait Toml {
    /// The value as TOML.
    fn toml(&self) -> String;
}

impl Toml for f64 {
    fn toml(&self) -> String {
        self.to_string()
    }
}

impl Toml for bool {
    fn toml(&self) -> String {
        self.to_string()
    }
}

impl Toml for usize {
    fn toml(&self) -> String {
        self.to_string()
    }
}

impl Toml for String {
    fn toml(&self) -> String {
        format!("\"{self}\"")
    }
}

impl<const N: usize> Toml for [f64; N] {
    fn toml(&self) -> String {
        let numbers = self.iter().map(f64::to_string);
        format!("[{}]", numbers.collect::<Vec<_>>().join(", "))
    }
}

/// Choices without anything of their own.
macro_rules! plain_choice {
    ($($choice:ty),+) => {$(
        impl $crate::keys::words::Toml for $choice {
            fn toml(&self) -> String {
                format!("\"{}\"", $crate::keys::words::words::<Self>()[*self as usize])
            }
        }
    )+};
}

pub(crate) use plain_choice;

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, serde::Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum Side {
        Left,
        FarRight,
    }

    plain_choice!(Side);

    #[test]
    fn choices_say_their_words() {
        assert_eq!(words::<Side>(), ["left", "far-right"]);
        assert_eq!(
            [Side::Left.toml(), Side::FarRight.toml()],
            ["\"left\"", "\"far-right\""]
        );
        assert!(words::<f64>().is_empty());
        assert_eq!(listed(["a", "b"]), "`\"a\"`, `\"b\"`");
    }
}
