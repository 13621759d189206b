//! What the declarations of the keys say is what docs/keys.md says and what the reader does.

mod keys {
    pub mod files;
    pub mod values;
}

use std::fs;

use cell::document::{self, Table};
use cell::keys::numbers::Span;
use cell::keys::{Absent, Key};
use keys::files::{self, Files};
use keys::values;

/// `docs/keys.md`, which is written where `UPDATE_DOCS` is set.
#[test]
fn the_document_is_what_the_keys_say() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/keys.md");
    let text = document::text();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(path, &text).expect("the document is written");
    }
    let committed = fs::read_to_string(path).expect("the document");
    let mut lines = text.lines().zip(committed.lines());
    let differing = lines.find(|(made, there)| made != there);
    assert!(
        text == committed,
        "docs/keys.md is another than the keys make, first {differing:?}: UPDATE_DOCS=1 cargo \
         test -p cell --test keys"
    );
}

/// The valid files are what the other tests change one key of.
#[test]
fn the_valid_files_are_read() {
    for files in files::all() {
        for table in &files.tables {
            let text = files.base(table).to_string();
            (files.read)(&text).unwrap_or_else(|error| panic!("{table:?}: {error}"));
        }
    }
}

/// Just inside of every range is accepted, just outside is refused by the reader, which names the
/// key and says the range of the document.
#[test]
fn what_is_allowed_is_what_the_reader_takes() {
    for files in files::all() {
        for (table, key) in every_key(&files) {
            let place = format!("{} of [{}]", key.name, table.path);
            let given = files.value(table, key.name);
            let span = (key.span)();
            let [inside, outside] = match span {
                Some(span) => values::beside(&span, &given),
                None => values::cases(table.path, key.name, &given)
                    .unwrap_or_else(|| [values::listed(key), vec!["no such word".into()]]),
            };
            assert!(!inside.is_empty() && !outside.is_empty(), "{place}");
            for value in inside {
                let read = files.with(table, key.name, Some(value.clone()));
                // What else is checked, with other keys, is what a remark is about.
                let other = (key.allowed)().contains("; ");
                match read {
                    Err(error) if other && !says(&error, key, span) => {}
                    read => assert!(read.is_ok(), "{place}: {value}: {read:?}"),
                }
            }
            for value in outside {
                let read = files.with(table, key.name, Some(value.clone()));
                let error = read.expect_err(&format!("{place}: {value}"));
                assert!(says(&error, key, span), "{place}: {value}: {error}");
            }
        }
    }
}

/// Whether an error is about a key and, where it has a range, says that.
fn says(error: &str, key: &Key, span: Option<Span>) -> bool {
    let range = span.map(|span| span.range.to_string());
    // Below the range of whole numbers there may be none at all.
    let whole = error.contains("a whole number from 0");
    let ranged = range.is_none_or(|range| whole || error.ends_with(&format!("allowed: {range}")));
    error.contains(key.name) && ranged
}

/// A file without a key gets what the document says: an error, the same as with the default, or
/// what a sentence tells.
#[test]
fn a_file_without_a_key_gets_its_default() {
    for files in files::all() {
        for (table, key) in every_key(&files) {
            let place = format!("{} of [{}]", key.name, table.path);
            let without = files.with(table, key.name, None);
            match (key.absent)() {
                Absent::Refused => {
                    let error = without.expect_err(&place);
                    let missing = format!("missing key '{}'", key.name);
                    // A point is a word as well: what lacks a key may be either.
                    let neither = table.path == "level.point" && error.contains(key.name);
                    assert!(error.ends_with(&missing) || neither, "{place}: {error}");
                }
                Absent::Value(toml) => {
                    let file: toml::Table = format!("value = {toml}").parse().expect(&place);
                    let with = files.with(table, key.name, Some(file["value"].clone()));
                    assert!(with.is_ok() && without == with, "{place}: {toml}");
                    let given = files.with(table, key.name, Some(files.value(table, key.name)));
                    assert!(with != given, "{place}: the valid file says the default");
                }
                Absent::Said(words) => {
                    assert!(without.is_ok(), "{place}: {without:?}");
                    assert!(!words.is_empty(), "{place}");
                }
            }
        }
    }
}

/// The kinds of references in the document are those that the reader knows, each for the tasks
/// that it says.
#[test]
fn kinds_of_references_are_for_their_tasks() {
    let [scenarios, _] = files::all();
    let references = |table: &&Table| table.path == "level.reference";
    let kinds = scenarios.tables.iter().filter(references);
    let kinds: Vec<_> = kinds.collect();
    let unknown = scenarios.with(kinds[0], "kind", Some("no such kind".into()));
    let words: Vec<_> = kinds.iter().filter_map(|table| table.kind).collect();
    let error = unknown.expect_err("no such kind");
    assert!(
        error.ends_with(&format!("allowed: {}", words.join(", "))),
        "{error}"
    );
    for table in kinds {
        for (task, about) in [
            ("position", "For positions."),
            ("orientation", "For orientations."),
        ] {
            let mut file = scenarios.base(table);
            file["level"][0]
                .as_table_mut()
                .expect("a level")
                .insert("task".into(), task.into());
            let read = (scenarios.read)(&file.to_string());
            let fits = [about, "For both."].contains(&table.about);
            assert_eq!(read.is_ok(), fits, "{table:?} {task}: {read:?}");
        }
    }
}

fn every_key(files: &Files) -> impl Iterator<Item = (&Table, &'static Key)> {
    let tables = files.tables.iter();
    tables.flat_map(|table| table.keys.iter().map(move |key| (table, key)))
}
