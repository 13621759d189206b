//! The numbers of faults and limits, which go over wires and into logs: the registry of
//! the core against the document and the C header, both ways.

use std::collections::BTreeSet;
use std::fs;
use std::ops::RangeInclusive;
use std::path::Path;

use controller_core::fault::{FaultKind, IndexSet, LimitKind, Status};

const FAULTS: RangeInclusive<u32> = 32..=95;
const LIMITS: RangeInclusive<u32> = 96..=159;

/// Published numbers keep their names for ever: this list only grows.
const PUBLISHED: [(u32, &str); 16] = [
    (32, "implausible"),
    (33, "non_finite_torque"),
    (34, "wrong_target"),
    (96, "saturated"),
    (97, "rank"),
    (98, "torque_rate"),
    (99, "joining"),
    (100, "degraded"),
    (101, "released"),
    (102, "shaped"),
    (103, "scaled"),
    (104, "bounded"),
    (105, "unresolved"),
    (106, "stuck"),
    (107, "changing"),
    (108, "stale"),
];

/// A row of the registry.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    number: u32,
    name: &'static str,
    meaning: &'static str,
}

fn faults() -> Vec<Entry> {
    let kinds = FaultKind::ALL.iter();
    let entry = |kind: &FaultKind| Entry {
        number: kind.number().into(),
        name: kind.name(),
        meaning: kind.meaning(),
    };
    kinds.map(entry).collect()
}

fn limits() -> Vec<Entry> {
    let kinds = LimitKind::ALL.iter();
    let entry = |kind: &LimitKind| Entry {
        number: kind.number().into(),
        name: kind.name(),
        meaning: kind.meaning(),
    };
    kinds.map(entry).collect()
}

/// (number, name) of C, as the macro with the registry hands them out.
macro_rules! names_of_c {
    (
        faults { $($fault:ident = $number:literal, $name:literal, $c:literal, $text:literal;)* }
        limits { $($limit:ident = $limit_number:literal, $limit_name:literal, $limit_c:literal,
            $limit_text:literal;)* }
    ) => {
        [
            [$(($number, concat!("STRATUM_FAULT_", $c))),*].as_slice(),
            [$(($limit_number, concat!("STRATUM_LIMIT_", $limit_c))),*].as_slice(),
        ]
    };
}
const NAMES_OF_C: [&[(u32, &str)]; 2] = controller_core::numbers!(names_of_c);

fn read(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    fs::read_to_string(root.join(path)).expect(path)
}

#[test]
fn numbers_are_unique_in_order_within_their_range_and_stay_what_they_are() {
    for (entries, range) in [(faults(), FAULTS), (limits(), LIMITS)] {
        assert!(!entries.is_empty());
        assert!(entries.iter().all(|entry| range.contains(&entry.number)));
        let pairs = entries.windows(2);
        assert!(pairs.into_iter().all(|two| two[0].number < two[1].number));
    }
    let all: Vec<Entry> = faults().into_iter().chain(limits()).collect();
    let names: BTreeSet<&str> = all.iter().map(|entry| entry.name).collect();
    assert_eq!(names.len(), all.len(), "a name is used once");
    for entry in &all {
        let lower = |c: char| c.is_ascii_lowercase() || c == '_';
        assert!(entry.name.chars().all(lower), "{entry:?}");
        assert!(!entry.meaning.is_empty(), "{entry:?}");
    }
    let given: Vec<_> = all.iter().map(|entry| (entry.number, entry.name)).collect();
    assert_eq!(given, PUBLISHED);
}

/// What a status reports is in the registry: each set of its own kind.
#[test]
fn a_status_names_its_limits_by_the_registry() {
    let with = |saturated, rank, rate, joining| Status {
        saturated: IndexSet(saturated),
        rank: IndexSet(rank),
        rate_limited: IndexSet(rate),
        joining: IndexSet(joining),
        ..Status::CLEAR
    };
    let numbers = |status: Status| -> Vec<u8> { status.limits().map(LimitKind::number).collect() };
    assert_eq!(numbers(Status::CLEAR), [0; 0]);
    assert_eq!(numbers(with(1, 0, 0, 0)), [96]);
    assert_eq!(numbers(with(0, 64, 0, 0)), [97]);
    let bounded = |at_least, at_greatest| Status {
        at_least: IndexSet(at_least),
        at_greatest: IndexSet(at_greatest),
        ..Status::CLEAR
    };
    assert_eq!(numbers(bounded(1, 0)), [104]);
    assert_eq!(numbers(bounded(0, 64)), [104]);
    let everything = Status {
        degraded: IndexSet(1),
        released: IndexSet(2),
        shaped: IndexSet(4),
        scaled: IndexSet(128),
        at_least: IndexSet(1),
        unresolved: true,
        stuck: IndexSet(1),
        changing: IndexSet(130),
        stale: IndexSet(4),
        ..with(5, 3, 1, 128)
    };
    assert_eq!(
        numbers(everything),
        LimitKind::ALL.iter().map(|k| *k as u8).collect::<Vec<_>>()
    );
}

/// (number, name, meaning) of the rows below a head `| number | name | meaning |`.
fn rows(document: &str) -> Vec<(u32, String, String)> {
    let (mut rows, mut inside) = (Vec::new(), false);
    for line in document.lines() {
        let cells: Vec<&str> = line.trim().split('|').map(str::trim).collect();
        match cells[..] {
            ["", "number", "name", "meaning", ""] => inside = true,
            ["", number, name, meaning, ""] if inside => {
                if let Ok(number) = number.parse() {
                    let name = name.trim_matches('`').into();
                    rows.push((number, name, meaning.into()));
                }
            }
            _ => inside = false,
        }
    }
    rows
}

#[test]
fn the_tables_of_the_document_are_the_registry() {
    let rows = rows(&read("docs/architecture.md"));
    for (entries, range) in [(faults(), FAULTS), (limits(), LIMITS)] {
        let table: Vec<_> = rows.iter().filter(|row| range.contains(&row.0)).collect();
        let lines = |number: u32, name: &str, meaning: &str| format!("{number} {name}: {meaning}");
        let table: Vec<String> = table
            .iter()
            .map(|(n, name, m)| lines(*n, name, m))
            .collect();
        let registry = entries.iter().map(|e| lines(e.number, e.name, e.meaning));
        assert_eq!(table, registry.collect::<Vec<_>>());
    }
    let known = |number: &u32| FAULTS.contains(number) || LIMITS.contains(number);
    assert!(rows.iter().all(|(number, ..)| known(number)), "{rows:?}");
}

/// Every name with one of the prefixes that the header gives a number, as macro or as
/// enumerator.
fn constants(header: &str) -> Vec<(u32, String)> {
    let code = header
        .lines()
        .map(|line| line.split("//").next().unwrap_or(line));
    let code: Vec<&str> = code.collect();
    let text = code.join("\n").replace(['=', ','], " ");
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut constants = Vec::new();
    for pair in words.windows(2) {
        let ours = ["STRATUM_FAULT_", "STRATUM_LIMIT_"]
            .iter()
            .any(|prefix| pair[0].starts_with(prefix));
        if let (true, Ok(number)) = (ours, pair[1].parse()) {
            constants.push((number, pair[0].to_string()));
        }
    }
    constants
}

#[test]
fn the_constants_of_the_header_are_the_registry() {
    let registry: Vec<(u32, String)> = NAMES_OF_C
        .concat()
        .iter()
        .map(|(number, name)| (*number, name.to_string()))
        .collect();
    // One spelling: the name of logs in capitals.
    for (entries, kind, names) in [
        (faults(), "FAULT", NAMES_OF_C[0]),
        (limits(), "LIMIT", NAMES_OF_C[1]),
    ] {
        let capitals = entries.iter().map(|entry| {
            let name = entry.name.to_uppercase();
            (entry.number, format!("STRATUM_{kind}_{name}"))
        });
        let names = names
            .iter()
            .map(|(number, name)| (*number, name.to_string()));
        assert!(capitals.eq(names), "{kind}");
    }
    let header = read("controller-capi/include/stratum.h");
    assert_eq!(constants(&header), registry);
}

#[test]
fn the_readers_of_tables_and_headers_see_what_is_wrong() {
    let table = "| number | name | meaning |\n|---|---|---|\n| 32 | `a` | b |\n\n| 33 | `c` | d |";
    assert_eq!(rows(table), [(32, "a".into(), "b".into())]);
    let header = "#define STRATUM_FAULT_A 32\n  STRATUM_LIMIT_B = 96, // STRATUM_LIMIT_C = 97\n\
                  STRATUM_LIMIT_D=98,\n#define STRATUM_OK 0\nif (x == STRATUM_FAULT_A)";
    assert_eq!(
        constants(header),
        [
            (32, "STRATUM_FAULT_A".to_string()),
            (96, "STRATUM_LIMIT_B".to_string()),
            (98, "STRATUM_LIMIT_D".to_string()),
        ]
    );
}
