//! Where in a TOML text a value stands, so that errors can name the line.

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::invalid::{Invalid, Segment};
use crate::reworded::{is_about_a_key, reworded};

/// Reads a TOML text.
///
/// # Errors
/// Line, key and what is wrong there.
pub fn parse<T: DeserializeOwned>(text: &str) -> Result<T, Invalid> {
    let line = |error: &toml::de::Error| {
        let line = line_at(text, error.span().map_or(0, |span| span.start));
        format!("line {line}")
    };
    let deserializer = toml::Deserializer::parse(text).map_err(|error| {
        // There is no key to name yet, so the line itself is shown.
        let at = line_at(text, error.span().map_or(0, |span| span.start));
        let shown: String = text
            .lines()
            .nth(at - 1)
            .unwrap_or("")
            .chars()
            .take(60)
            .collect();
        let shown = format!("'{}'", shown.trim());
        Invalid::line(error.message())
            .within(shown)
            .within(line(&error))
    })?;
    serde_path_to_error::deserialize(deserializer).map_err(|error| {
        let message = error.inner().message();
        let mut place = places(error.path());
        if is_about_a_key(message) {
            place.pop();
        }
        place.insert(0, line(error.inner()));
        reworded(message).within(place.join(": "))
    })
}

/// The way to a value as errors write it: entries of lists are counted from 1.
fn places(path: &serde_path_to_error::Path) -> Vec<String> {
    use serde_path_to_error::Segment;
    let mut places: Vec<String> = Vec::new();
    for segment in path {
        match (segment, places.last_mut()) {
            (Segment::Seq { index }, Some(list)) => *list += &format!(" {}", index + 1),
            (Segment::Map { key }, _) => places.push(key.clone()),
            _ => (),
        }
    }
    places
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
