//! The documents and the comments in the built-in scenarios say the declared ranges.

use cell::ranges::*;
use cell::scenario::BUILT_IN;

/// Ranges by how the first cell of their row below `heading` begins, in the order of the row.
fn rows(path: &str, heading: &str, rows: &[(&str, &[String])]) {
    let path = format!("{}/../docs/{path}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("the document");
    for (key, ranges) in rows {
        let mut lines = text.lines().skip_while(|line| *line != heading);
        let row = lines.find(|line| line.starts_with(&format!("| {key}")));
        let mut rest = row.unwrap_or_else(|| panic!("{path}: no row {key}"));
        for range in *ranges {
            let found = rest.split_once(range.as_str());
            (_, rest) = found.unwrap_or_else(|| panic!("{path}: {key} has to say {range}"));
        }
    }
}

/// The names of all arms.
fn arms() -> Vec<String> {
    arms::ALL
        .iter()
        .map(|arm| format!("`{}`", arm.name))
        .collect()
}

fn text(range: Range<f64>) -> String {
    range.to_string()
}

#[test]
fn the_tables_say_the_ranges() {
    rows(
        "explain.md",
        "## Input",
        &[
            (
                "`levels` |",
                &[LEVELS.to_string(), format!("at most {}", EXACT_ROWS.max)],
            ),
            ("`robot` |", &arms()),
            ("`point` |", &[text(OFFSET_M)]),
            ("`x`, `dx`, `ddx` |", &[text(QUATERNION_NORM)]),
        ],
    );
    rows(
        "architecture.md",
        "### Options of the plant",
        &[("`--dead-cycles N` |", &[DEAD_CYCLES.to_string()])],
    );
}

#[test]
fn the_built_in_scenarios_say_the_ranges() {
    for (name, scenario) in BUILT_IN {
        for (key, range) in [("duration_s", DURATION_S), ("cycle_ms", CYCLE_MS)] {
            let line = scenario.lines().find(|line| line.starts_with(key));
            let line = line.expect("the key");
            assert!(
                line.ends_with(&format!("# {range}")),
                "{name}: {line}: {range}"
            );
        }
    }
}
