//! Where in a TOML text a value stands, so that errors can name the line.

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::invalid::{Invalid, Segment};

/// Reads a TOML text.
///
/// # Errors
/// Line, key and what is wrong there.
pub fn parse<T: DeserializeOwned>(text: &str) -> Result<T, Invalid> {
    let located = |error: &toml::de::Error, path: String| {
        let line = line_at(text, error.span().map_or(0, |span| span.start));
        let key = if path.is_empty() || path == "." {
            path
        } else {
            format!("{path}: ")
        };
        let key = key.trim_start_matches('.');
        Invalid::line(format_args!("line {line}: {key}{}", error.message()))
    };
    let deserializer =
        toml::Deserializer::parse(text).map_err(|error| located(&error, String::new()))?;
    serde_path_to_error::deserialize(deserializer).map_err(|error| {
        let path = error.path().to_string();
        located(error.inner(), path)
    })
}

/// The line, counted from 1, of the value that `path` leads to; of the last
/// part of the path that exists.
#[must_use]
pub fn line_of(text: &str, path: &[Segment]) -> usize {
    let Ok(document) = DeTable::parse(text) else {
        return 1;
    };
    let mut at = 0;
    let mut value = &DeValue::Table(document.into_inner());
    for segment in path {
        let next = match (segment, value) {
            (Segment::Key(key), DeValue::Table(table)) => table.get(key.as_str()),
            (Segment::Index(index), DeValue::Array(array)) => array.get(*index),
            _ => None,
        };
        let Some(next) = next else { break };
        at = next.span().start;
        value = next.get_ref();
    }
    line_at(text, at)
}

fn line_at(text: &str, offset: usize) -> usize {
    1 + text
        .bytes()
        .take(offset)
        .filter(|&byte| byte == b'\n')
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_by_their_path() {
        let text = "a = 1\n[[level]]\nb = 2\n[[level]]\nb = { c = 3 }\n";
        let key = |key: &str| Segment::Key(key.into());
        assert_eq!(line_of(text, &[key("a")]), 1);
        assert_eq!(
            line_of(text, &[key("level"), Segment::Index(0), key("b")]),
            3
        );
        assert_eq!(
            line_of(text, &[key("level"), Segment::Index(1), key("b"), key("c")]),
            5
        );
        assert_eq!(
            line_of(text, &[key("level"), Segment::Index(1), key("absent")]),
            4
        );
    }
}
