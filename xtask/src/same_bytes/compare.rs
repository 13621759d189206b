//! Differences between the results of two programs.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use super::csv;
use super::difference::{Difference, short};
use super::group::Group;

/// The exit codes, with what the new program said about its own.
pub fn exits(outputs: &[Output; 2]) -> Vec<Difference> {
    let [base, new] = outputs;
    if base.status == new.status {
        return Vec::new();
    }
    let said = String::from_utf8_lossy(&new.stderr);
    let said = said.lines().last().unwrap_or_default();
    vec![Difference::nameless(format!(
        "base {}, new {} {said}",
        base.status, new.status
    ))]
}

/// Every CSV and JSON file below the two folders, those of one side included.
pub fn folders(folders: &[PathBuf; 2], group: &mut Group<'_>) -> io::Result<()> {
    let [base, new] = [names(&folders[0])?, names(&folders[1])?];
    for name in base.union(&new) {
        group.count += 1;
        let shown = name.to_string_lossy();
        let alone = |side| vec![Difference::nameless(format!("only in {side}"))];
        if !new.contains(name) {
            group.add(&shown, 0, alone("base"));
        } else if !base.contains(name) {
            group.add(&shown, 0, alone("new"));
        } else {
            let (base, new) = (
                fs::read(folders[0].join(name))?,
                fs::read(folders[1].join(name))?,
            );
            let found = if has_extension(name, "csv") {
                named(&base, &new, csv::differences)
            } else {
                json_bytes(&base, &new)
            };
            group.add(&shown, base.len(), found);
        }
    }
    Ok(())
}

/// Paths of the results below a folder, from there. A folder that was not made has none.
fn names(folder: &Path) -> io::Result<BTreeSet<PathBuf>> {
    let mut found = BTreeSet::new();
    let mut left = vec![PathBuf::new()];
    while let Some(inner) = left.pop() {
        if !folder.join(&inner).is_dir() {
            continue;
        }
        for entry in fs::read_dir(folder.join(&inner))? {
            let entry = entry?;
            let path = inner.join(entry.file_name());
            if entry.file_type()?.is_dir() {
                left.push(path);
            } else if has_extension(&path, "csv") || has_extension(&path, "json") {
                found.insert(path);
            }
        }
    }
    Ok(found)
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found == extension)
}

/// Differences between two JSON files. Beside an excused difference the layout, such as
/// the order of keys, is not looked at.
pub fn json_bytes(base: &[u8], new: &[u8]) -> Vec<Difference> {
    named(base, new, |base, new| {
        let mut found = Vec::new();
        if let (Ok(base), Ok(new)) = (serde_json::from_str(base), serde_json::from_str(new)) {
            json("", Some(&base), Some(&new), &mut found);
        }
        found
    })
}

/// The differences that `find` can name, or else the first byte that differs: bytes
/// that differ are always a difference.
fn named(base: &[u8], new: &[u8], find: impl Fn(&str, &str) -> Vec<Difference>) -> Vec<Difference> {
    if base == new {
        return Vec::new();
    }
    let found = match (str::from_utf8(base), str::from_utf8(new)) {
        (Ok(base), Ok(new)) => find(base, new),
        _ => Vec::new(),
    };
    if found.is_empty() {
        vec![first_byte(base, new)]
    } else {
        found
    }
}

fn first_byte(base: &[u8], new: &[u8]) -> Difference {
    let at = base.iter().zip(new).take_while(|(b, n)| b == n).count();
    let line = base[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
    let column = base[..at]
        .iter()
        .rev()
        .take_while(|&&byte| byte != b'\n')
        .count()
        + 1;
    let rest = |bytes: &[u8]| {
        let rest = String::from_utf8_lossy(&bytes[at..]).into_owned();
        format!("{:?}", rest.lines().next().unwrap_or_default())
    };
    let (base, new) = (rest(base), rest(new));
    Difference::nameless(format!(
        "line {line}, column {column}: base {}, new {}",
        short(&base),
        short(&new)
    ))
}

/// Values are compared as they are written: 0 and -0 differ.
fn json(path: &str, base: Option<&Value>, new: Option<&Value>, found: &mut Vec<Difference>) {
    match (base, new) {
        (Some(Value::Object(base)), Some(Value::Object(new))) => {
            let keys: BTreeSet<&String> = base.keys().chain(new.keys()).collect();
            for key in keys {
                let dot = if path.is_empty() { "" } else { "." };
                let inner = format!("{path}{dot}{key}");
                json(&inner, base.get(key), new.get(key), found);
            }
        }
        (Some(Value::Array(base)), Some(Value::Array(new))) => {
            for i in 0..base.len().max(new.len()) {
                json(&format!("{path}[{i}]"), base.get(i), new.get(i), found);
            }
        }
        _ => {
            let text = |value: Option<&Value>| value.map_or("absent".into(), Value::to_string);
            let (base, new) = (text(base), text(new));
            if base != new {
                found.push(Difference::at(path, &base, &new));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CSV: &str = "t,q1\n0.0e0,1.5e0\n";
    const JSON: &str = r#"{"levels": [{"rms_mm": 0.5}, {"rms_mm": 0.0}], "seed": 1}"#;

    fn texts(found: &[Difference]) -> Vec<&str> {
        found
            .iter()
            .map(|difference| difference.text.as_str())
            .collect()
    }

    fn json_texts(new: &str) -> Vec<String> {
        let found = json_bytes(JSON.as_bytes(), new.as_bytes());
        texts(&found).into_iter().map(String::from).collect()
    }

    #[test]
    fn a_value_is_found_by_its_path() {
        assert!(json_texts(JSON).is_empty());
        assert_eq!(
            json_texts(&JSON.replace("0.5", "0.5000000000000001")),
            ["levels[0].rms_mm: base 0.5, new 0.5000000000000001"]
        );
        assert_eq!(
            json_texts(&JSON.replace("0.0", "-0.0")),
            ["levels[1].rms_mm: base 0.0, new -0.0"]
        );
        assert_eq!(
            json_texts(&JSON.replace("\"seed\": 1", "\"link\": null")),
            ["link: base absent, new null", "seed: base 1, new absent"]
        );
    }

    #[test]
    fn bytes_that_mean_the_same_are_found() {
        assert_eq!(
            json_texts(&JSON.replace("\"seed\": 1", "\"seed\":  1")),
            [r#"line 1, column 56: base "1}", new " 1}""#]
        );
        assert_eq!(
            json_texts("")[0].split(':').next(),
            Some("line 1, column 1")
        );
    }

    #[test]
    fn files_of_one_side_and_of_both_are_found() -> io::Result<()> {
        let root = std::env::temp_dir().join(format!("same-bytes-{}", std::process::id()));
        let both = ["base", "new"].map(|side| root.join(side));
        for folder in &both {
            fs::create_dir_all(folder.join("runs/a"))?;
            fs::write(folder.join("trace.csv"), CSV)?;
        }
        fs::write(both[0].join("runs/a/summary.json"), JSON)?;
        fs::write(
            both[1].join("runs/a/summary.json"),
            JSON.replace("0.5", "0.6"),
        )?;
        fs::write(both[1].join("verdicts.json"), "[]")?;
        fs::write(both[1].join("report.html"), "")?;
        let mut group = Group::new("paper", "files", &[]);
        folders(&both, &mut group)?;
        fs::remove_dir_all(&root)?;
        let bytes = CSV.len() + JSON.len();
        assert_eq!(
            group.lines(),
            [
                format!("paper: 3 files, {bytes} bytes, 2 differ").as_str(),
                "  runs/a/summary.json: levels[0].rms_mm: base 0.5, new 0.6",
                "  verdicts.json: only in new"
            ]
        );
        Ok(())
    }
}
