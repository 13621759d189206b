//! A difference between two results, by the name that a reader of the file knows.

/// A place where the two differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// CSV column or JSON path; empty where it is neither and nothing excuses it.
    pub name: String,
    /// The place and both values.
    pub text: String,
}

impl Difference {
    /// At a JSON path.
    pub fn at(path: &str, base: &str, new: &str) -> Self {
        Self {
            name: path.into(),
            text: format!("{path}: base {}, new {}", short(base), short(new)),
        }
    }

    /// That nothing excuses.
    pub fn nameless(text: String) -> Self {
        Self {
            name: String::new(),
            text,
        }
    }

    /// Whether its name has one of these parts.
    pub fn excused(&self, parts: &[String]) -> bool {
        parts.iter().any(|part| self.name.contains(part))
    }
}

/// Enough to recognise a value by.
pub fn short(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_excused_by_a_part_of_it() {
        let parts = ["rms".to_string()];
        assert!(Difference::at("levels[0].rms_mm", "0", "1").excused(&parts));
        assert!(!Difference::at("seed", "0", "1").excused(&parts));
        assert!(!Difference::nameless("rms".into()).excused(&parts));
    }
}
