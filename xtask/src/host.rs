//! Instruction counts of the host, and figures of other libraries: read from the files
//! that the scripts beside them write.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::tools::{Trouble, failed, first_line};

/// Counts cycle and stages under callgrind.
const SCRIPT: &str = "controller-core/benches/instructions.sh";

/// What it writes: case, stage, largest count.
const COUNTS: &str = "controller-core/benches/instructions.txt";

/// What `tests/peers/run.sh` writes, which counts other libraries: too slow and with
/// too many dependencies for every run.
const PEERS: &str = "tests/peers/peers.json";

/// Instructions by case, then by stage; `cycle` for all of it.
pub type Counts = BTreeMap<String, BTreeMap<String, u64>>;

/// Another way to the same torques.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Peer {
    /// What it is.
    pub name: String,
    /// Versions of its parts.
    pub version: String,
    /// Largest number of instructions of a full cycle, by experiment.
    pub cycle: BTreeMap<String, u64>,
}

/// Counts anew. Returns the version of the tool, or None where it is not there and
/// the figures stay what they are.
pub fn count(root: &Path) -> Result<Option<String>, Trouble> {
    let Ok(version) = first_line("valgrind", &["--version"]) else {
        println!("no valgrind (apt-get install valgrind): the host's counts stay as committed");
        return Ok(None);
    };
    let output = Command::new(root.join(SCRIPT)).arg("--update").output()?;
    print!("{}", String::from_utf8_lossy(&output.stdout));
    if !output.status.success() {
        return Err(failed(SCRIPT, &output));
    }
    Ok(Some(version))
}

/// The committed counts.
pub fn counts(root: &Path) -> Result<Counts, Trouble> {
    parse(&fs::read_to_string(root.join(COUNTS))?)
}

/// The committed figures of other libraries.
pub fn peers(root: &Path) -> Result<Vec<Peer>, Trouble> {
    serde_json::from_str(&fs::read_to_string(root.join(PEERS))?)
        .map_err(|error| Trouble::Content(format!("{PEERS}: {error}")))
}

fn parse(text: &str) -> Result<Counts, Trouble> {
    let mut counts = Counts::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let read = || -> Option<(String, String, u64)> {
            let [case, stage, count] = words[..] else {
                return None;
            };
            let (levels, precision) = case.rsplit_once('-')?;
            let job = match levels {
                "2-levels" => "two-level",
                "3-levels" => "case-1",
                _ => return None,
            };
            let stage = match stage {
                "step" => "cycle".into(),
                stage => stage.replace('_', " "),
            };
            Some((format!("{job} {precision}"), stage, count.parse().ok()?))
        };
        let (case, stage, count) = read()
            .ok_or_else(|| Trouble::Content(format!("{COUNTS}: what is not understood: {line}")))?;
        counts.entry(case).or_default().insert(stage, count);
    }
    Ok(counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_and_stages_get_the_names_of_the_table() {
        let text =
            "2-levels-f64 step 9000\n3-levels-f32 task_rows 12\n3-levels-f32 observer_input 7\n";
        let counts = parse(text).expect("counts");
        assert_eq!(counts["two-level f64"]["cycle"], 9000);
        assert_eq!(counts["case-1 f32"]["task rows"], 12);
        assert_eq!(counts["case-1 f32"]["observer input"], 7);
        assert!(parse("2-levels-f64 step").is_err());
    }
}
