//! What differs between the results of two programs, by the names that a reader of the
//! files knows.

use std::collections::BTreeMap;
use std::process::Output;

use serde_json::Value;

/// Lines for the differences of a file, and of a group.
const LINES: [usize; 2] = [3, 12];

/// Values by name, a CSV column or a JSON path, and by line; 0 in JSON.
type Values = BTreeMap<(String, usize), String>;

/// Files that are counted together.
#[derive(Default)]
pub struct Group<'a> {
    name: &'a str,
    /// What is counted.
    unit: &'static str,
    /// Parts of names that may differ.
    ignore: &'a [String],
    count: usize,
    bytes: usize,
    /// How many files differ, and how many only where they may.
    differ: usize,
    excused: usize,
    lines: Vec<String>,
}

impl<'a> Group<'a> {
    /// An empty one.
    pub fn new(name: &'a str, unit: &'static str, ignore: &'a [String]) -> Self {
        Self {
            name,
            unit,
            ignore,
            ..Self::default()
        }
    }

    /// Takes the exit codes, with what the new program said about its own.
    pub fn add_exits(&mut self, [base, new]: &[Output; 2]) {
        if base.status != new.status {
            let said = String::from_utf8_lossy(&new.stderr);
            let said = said.lines().last().unwrap_or_default();
            let (base, new) = (base.status, new.status);
            self.note("exit code", vec![format!("base {base}, new {new} {said}")]);
        }
    }

    /// Takes a file of both sides, CSV or JSON; None where a side does not have it. Bytes that
    /// differ although no value does are a difference that nothing excuses; beside an excused
    /// one the layout, such as the order of keys, is not looked at.
    pub fn add(&mut self, file: &str, base: Option<&[u8]>, new: Option<&[u8]>) {
        self.count += 1;
        self.bytes += base.map_or(0, <[u8]>::len);
        if base == new {
            return;
        }
        let (Some(base), Some(new)) = (base, new) else {
            let side = if new.is_none() { "base" } else { "new" };
            return self.note(file, vec![format!("only in {side}")]);
        };
        let [base, new] = [base, new].map(String::from_utf8_lossy);
        let read = if file.ends_with(".csv") { csv } else { json };
        let named = differences(&read(&base), &read(&new));
        let excused = |name: &String| self.ignore.iter().any(|part| name.contains(part));
        let found: Vec<String> = (named.iter())
            .filter(|(name, _)| !excused(name))
            .map(|(_, text)| text.clone())
            .collect();
        if named.is_empty() {
            self.note(file, vec![first_line(&base, &new)]);
        } else if found.is_empty() {
            self.excused += 1;
        } else {
            self.note(file, found);
        }
    }

    fn note(&mut self, file: &str, mut found: Vec<String>) {
        self.differ += 1;
        let more = found.len().saturating_sub(LINES[0]);
        if more > 0 {
            found.truncate(LINES[0]);
            found.push(format!("{more} more"));
        }
        self.lines
            .extend(found.iter().map(|text| format!("  {file}: {text}")));
    }

    /// The counts, then the first differences.
    fn report(&self) -> Vec<String> {
        let Self {
            name,
            unit,
            count,
            bytes,
            differ,
            excused,
            ..
        } = self;
        let mut head = format!("{name}: {count} {unit}, {bytes} bytes, {differ} differ");
        if !self.ignore.is_empty() {
            head += &format!(", {excused} excused");
        }
        let shown = self.lines.iter().take(LINES[1]).cloned();
        let more = self.lines.len().checked_sub(LINES[1] + 1);
        let more = more.map(|more| format!("  and {} more lines", more + 1));
        [head].into_iter().chain(shown).chain(more).collect()
    }

    /// Prints counts and differences, the latter only as many as are read.
    /// Whether nothing differs but what may.
    pub fn print(&self) -> bool {
        println!("{}", self.report().join("\n"));
        self.differ == 0
    }
}

/// For each name where it differs first, with both values, and how often.
fn differences(base: &Values, new: &Values) -> BTreeMap<String, String> {
    let mut found = BTreeMap::<String, (String, usize)>::new();
    let keys: BTreeMap<_, _> = base.iter().chain(new).collect();
    for key @ (name, line) in keys.into_keys() {
        let [base, new] =
            [base, new].map(|values| values.get(key).map_or("absent", String::as_str));
        if base != new {
            let place = if *line == 0 {
                name.clone()
            } else {
                format!("line {line}, column {name}")
            };
            let first = || (format!("{place}: base {base:.60}, new {new:.60}"), 0);
            found.entry(name.clone()).or_insert_with(first).1 += 1;
        }
    }
    let text = |(first, count)| match count {
        1 => first,
        _ => format!("{first}; lines that differ: {count}"),
    };
    found
        .into_iter()
        .map(|(name, found)| (name, text(found)))
        .collect()
}

fn csv(text: &str) -> Values {
    let names: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let mut values = Values::new();
    for (line, text) in (2..).zip(text.lines().skip(1)) {
        for (index, cell) in text.split(',').enumerate() {
            let name = names
                .get(index)
                .map_or(index.to_string(), |name| name.to_string());
            values.insert((name, line), cell.into());
        }
    }
    values
}

/// Values are compared as they are written: 0 and -0 differ.
fn json(text: &str) -> Values {
    fn collect(path: &str, value: &Value, values: &mut Values) {
        match value {
            Value::Object(inner) => {
                for (key, value) in inner {
                    let dot = if path.is_empty() { "" } else { "." };
                    collect(&format!("{path}{dot}{key}"), value, values);
                }
            }
            Value::Array(inner) => {
                for (index, value) in inner.iter().enumerate() {
                    collect(&format!("{path}[{index}]"), value, values);
                }
            }
            _ => _ = values.insert((path.into(), 0), value.to_string()),
        }
    }
    let mut values = Values::new();
    if let Ok(value) = serde_json::from_str(text) {
        collect("", &value, &mut values);
    }
    values
}

/// Bytes that differ are always a difference, whatever they mean.
fn first_line(base: &str, new: &str) -> String {
    let lines = base.split('\n').zip(new.split('\n'));
    let first = (1..).zip(lines).find(|(_, (base, new))| base != new);
    first.map_or("one is longer".into(), |(number, (base, new))| {
        format!("line {number}: base {base:?}, new {new:?}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CSV: &str = "t,q1\n0.0e0,1.5e0\n1.0e0,1.5e0\n";
    const JSON: &str = r#"{"levels": [{"rms_mm": 0.5}, {"rms_mm": 0.0}], "seed": 1}"#;

    /// What is reported of a file that the base has as `base`.
    fn report(file: &str, base: &str, new: &str, ignore: &[&str]) -> Vec<String> {
        let ignore: Vec<String> = ignore.iter().map(|part| part.to_string()).collect();
        let mut group = Group::new("paper", "files", &ignore);
        group.add(file, Some(base.as_bytes()), Some(new.as_bytes()));
        group.report()
    }

    fn csv_line(new: &str) -> String {
        report("a.csv", CSV, new, &[])[1].clone()
    }

    fn json_line(new: &str) -> String {
        report("a.json", JSON, new, &[])[1].clone()
    }

    #[test]
    fn equal_files_are_counted() {
        assert_eq!(
            report("a.csv", CSV, CSV, &[]),
            ["paper: 1 files, 29 bytes, 0 differ"]
        );
    }

    #[test]
    fn a_cell_is_found_by_line_and_column() {
        assert_eq!(
            csv_line(&CSV.replace("1.5", "-1.5")),
            "  a.csv: line 2, column q1: base 1.5e0, new -1.5e0; lines that differ: 2"
        );
        assert_eq!(
            csv_line(&CSV.replace("1.0e0,1.5e0\n", "")),
            "  a.csv: line 3, column q1: base 1.5e0, new absent"
        );
        assert_eq!(
            csv_line("t,q1,s\n0.0e0,1.5e0,7\n1.0e0,1.5e0,7\n"),
            "  a.csv: line 2, column s: base absent, new 7; lines that differ: 2"
        );
        assert_eq!(
            csv_line("q1,t\n1.5e0,0.0e0\n1.5e0,1.0e0\n"),
            r#"  a.csv: line 1: base "t,q1", new "q1,t""#
        );
    }

    #[test]
    fn a_value_is_found_by_its_path() {
        assert_eq!(
            json_line(&JSON.replace("0.5", "0.5000000000000001")),
            "  a.json: levels[0].rms_mm: base 0.5, new 0.5000000000000001"
        );
        assert_eq!(
            json_line(&JSON.replace("0.0", "-0.0")),
            "  a.json: levels[1].rms_mm: base 0.0, new -0.0"
        );
        assert_eq!(
            json_line(&JSON.replace("\"seed\"", "\"link\"")),
            "  a.json: link: base absent, new 1"
        );
    }

    #[test]
    fn bytes_that_mean_the_same_are_found() {
        assert!(json_line(&JSON.replace(": 1", ":  1")).starts_with("  a.json: line 1: base "));
        assert!(
            csv_line(CSV.trim_end()).ends_with(r#"new """#)
                || csv_line(CSV.trim_end()).ends_with("longer")
        );
    }

    #[test]
    fn a_name_is_excused_by_a_part_of_it() {
        let new = JSON.replace("0.5", "0.6");
        assert_eq!(
            report("a.json", JSON, &new, &["rms"]),
            ["paper: 1 files, 57 bytes, 0 differ, 1 excused"]
        );
        let new = new.replace(": 1", ": 2");
        assert_eq!(
            report("a.json", JSON, &new, &["rms"]),
            [
                "paper: 1 files, 57 bytes, 1 differ, 0 excused",
                "  a.json: seed: base 1, new 2"
            ]
        );
    }

    #[test]
    fn a_file_of_one_side_and_many_differences_take_few_lines() {
        let mut group = Group::new("paper", "files", &[]);
        for index in 0..9 {
            let name = format!("{index}.json");
            group.add(&name, Some(b"[1, 2, 3, 4, 5]"), Some(b"[0, 0, 0, 0, 0]"));
        }
        group.add("verdicts.json", None, Some(b"[]"));
        let lines = group.report();
        assert_eq!(lines[0], "paper: 10 files, 135 bytes, 10 differ");
        assert_eq!(lines[4], "  0.json: 2 more");
        assert_eq!(lines[13], "  and 25 more lines");
        assert_eq!(group.lines[36], "  verdicts.json: only in new");
    }
}
