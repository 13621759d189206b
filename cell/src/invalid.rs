//! Errors of what a user typed or wrote: one line that names the thing, the
//! value and what is allowed.

use std::fmt::{self, Write as _};

/// Something given from outside that cannot be used. Exit code 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Invalid {
    text: String,
    /// The way to the table that holds the value.
    place: Vec<Segment>,
    /// The value's key there, where there is one.
    key: Option<String>,
}

/// Most letters of a value that are shown, and of a line.
const VALUE: usize = 300;
const LINE: usize = 1200;

/// A step on the way to a value in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Segment {
    /// A key of a table.
    Key(String),
    /// An entry of a list, counted from 0.
    Index(usize),
}

impl Invalid {
    /// "`thing`: `value`; allowed: `allowed`". The first word of `thing` is the key
    /// of the value, if it is from a file.
    pub fn new(
        thing: impl fmt::Display,
        value: impl fmt::Display,
        allowed: impl fmt::Display,
    ) -> Self {
        let (thing, value) = (thing.to_string(), shortened(value.to_string(), VALUE));
        Self {
            key: thing.split(' ').next().map(String::from),
            ..Self::line(format_args!("{thing}: {value}; allowed: {allowed}"))
        }
    }

    /// A sentence that already says all three.
    pub fn line(text: impl fmt::Display) -> Self {
        Self {
            text: text.to_string(),
            place: Vec::new(),
            key: None,
        }
    }

    /// An unknown name: says which are known, the nearest one first.
    pub fn name(thing: &str, given: &str, known: &[&str]) -> Self {
        let unknown = Self::unknown(given, known);
        Self {
            key: Some(thing.to_string()),
            ..Self::line(format_args!("{thing}: {unknown}"))
        }
    }

    /// The same of a key in a file.
    #[must_use]
    pub fn key(given: &str, known: &[&str]) -> Self {
        Self {
            key: Some(given.to_string()),
            ..Self::name("key", given, known)
        }
    }

    /// The same where the place already says what it is.
    #[must_use]
    pub fn unknown(given: &str, known: &[&str]) -> Self {
        let given = &shortened(given.to_string(), VALUE);
        let nearest = match nearest(given, known) {
            Some(name) => format!(", did you mean '{name}'?"),
            None => ";".to_string(),
        };
        let all = match known {
            [] => "none".to_string(),
            known => known.join(", "),
        };
        Self::line(format_args!("unknown '{given}'{nearest} allowed: {all}"))
    }

    /// The same error, found in `place`, which is not a part of the file.
    #[must_use]
    pub fn within(self, place: impl fmt::Display) -> Self {
        Self::line(format_args!("{place}: {self}"))
    }

    /// The same error, found one step further inside a file.
    #[must_use]
    pub fn inside(mut self, step: Segment) -> Self {
        self.place.insert(0, step);
        self
    }

    /// The same error, found in the table `key` of a file.
    #[must_use]
    pub fn in_table(self, key: &str) -> Self {
        self.inside(Segment::Key(key.to_string()))
    }

    /// The same error, found in entry `index` (from 0) of the list `key` of a file.
    #[must_use]
    pub fn in_list(self, key: &str, index: usize) -> Self {
        self.inside(Segment::Index(index)).in_table(key)
    }

    /// The way to the value in its file; empty if unknown.
    #[must_use]
    pub fn path(&self) -> Vec<Segment> {
        let key = self.key.clone().map(Segment::Key);
        self.place.iter().cloned().chain(key).collect()
    }
}

impl Invalid {
    /// The way to the value and the sentence, as they came.
    fn sentence(&self) -> Result<String, fmt::Error> {
        let mut f = String::new();
        for (number, step) in self.place.iter().enumerate() {
            match step {
                Segment::Key(key) if number == 0 => f.write_str(key)?,
                Segment::Key(key) => write!(f, ": {key}")?,
                Segment::Index(index) => write!(f, " {}", index + 1)?,
            }
        }
        let gap = if self.place.is_empty() { "" } else { ": " };
        write!(f, "{gap}{}", self.text)?;
        Ok(f)
    }
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A value may carry line breaks of its own, or orders for the terminal.
        let text = shortened(self.sentence()?, LINE);
        for (number, word) in text.split_whitespace().enumerate() {
            f.write_str(if number == 0 { "" } else { " " })?;
            for letter in word.chars() {
                match obeyed(letter) {
                    true => write!(f, "{}", letter.escape_unicode())?,
                    false => f.write_char(letter)?,
                }
            }
        }
        Ok(())
    }
}

/// Whether a terminal obeys the letter instead of showing it: control characters, and
/// marks that turn the direction of the text.
fn obeyed(letter: char) -> bool {
    let turns = matches!(letter, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}'
        | '\u{2066}'..='\u{2069}');
    letter.is_control() || turns
}

/// A text without its middle where it is longer than `most` letters.
fn shortened(text: String, most: usize) -> String {
    let length = text.chars().count();
    if length <= most {
        return text;
    }
    let head: String = text.chars().take(most * 2 / 3).collect();
    let tail: String = text.chars().skip(length - most / 3).collect();
    format!("{head} [.. {length} letters ..] {tail}")
}

impl std::error::Error for Invalid {}

/// The known name that `given` was most likely meant to be.
fn nearest<'a>(given: &str, known: &[&'a str]) -> Option<&'a str> {
    let given = given.to_lowercase();
    // Of short names the similarity is low even with one slip.
    let slip = |name: &str| strsim::osa_distance(&given, name) == 1;
    known
        .iter()
        .map(|name| (strsim::jaro_winkler(&given, name), *name))
        .filter(|(similarity, name)| *similarity > 0.7 || slip(name))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_shown_and_not_obeyed() {
        let error = Invalid::new("name", "a\u{1b}[31m\u{7}b\u{202e}c", "letters");
        let shown = r"name: a\u{1b}[31m\u{7}b\u{202e}c; allowed: letters";
        assert_eq!(error.to_string(), shown);
        assert_eq!(error.within("file").to_string(), format!("file: {shown}"));
    }

    #[test]
    fn long_values_are_cut_and_what_is_allowed_is_not() {
        let long = "\u{e4}".repeat(3_000_000);
        for error in [
            Invalid::new("name", &long, "letters"),
            Invalid::name("name", &long, &["letters"]),
            Invalid::line(format_args!("name: {long}; allowed: letters")).within(&long),
        ] {
            let text = error.to_string();
            assert!(text.chars().count() < 1300, "{}", text.len());
            assert!(text.contains("letters ..]") && text.ends_with("allowed: letters"));
        }
    }

    #[test]
    fn errors_are_one_line_and_suggest_the_nearest_name() {
        let known = ["hierarchical", "no-observer", "acceleration-level"];
        assert_eq!(
            Invalid::name("controller", "hierarchial", &known).to_string(),
            "controller: unknown 'hierarchial', did you mean 'hierarchical'? \
             allowed: hierarchical, no-observer, acceleration-level"
        );
        assert!(
            Invalid::name("command", "rnu", &["run", "serve"])
                .to_string()
                .contains("did you mean 'run'?")
        );
        assert!(
            !Invalid::name("controller", "zzz\nqq", &known)
                .to_string()
                .contains('\n')
        );
        assert!(
            Invalid::name("controller", "xyz", &known)
                .to_string()
                .contains("; allowed")
        );
    }
}
