//! Instruction counts of the host, and figures of other libraries: read from the files
//! that the scripts beside them write.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::tools::{Trouble, first_line, root, run};

/// Counts cycle and stages under callgrind.
const SCRIPT: &str = "controller-core/benches/instructions.sh";

/// What it writes: case, stage, largest count.
const COUNTS: &str = "controller-core/benches/instructions.txt";

/// What `tests/peers/run.sh` writes, which counts other libraries: too slow and with
/// too many dependencies for every run.
const PEERS: &str = "tests/peers/peers.json";

/// What cases of codec and session of a robot link begin with.
pub const LINK: &str = "link-";

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
pub fn count() -> Result<Option<String>, Trouble> {
    let Ok(version) = first_line("valgrind", &["--version"]) else {
        println!("no valgrind (apt-get install valgrind): the host's counts stay as committed");
        return Ok(None);
    };
    print!(
        "{}",
        run(Command::new(root().join(SCRIPT)).arg("--update"))?
    );
    Ok(Some(version))
}

/// The committed counts.
pub fn counts() -> Result<Counts, Trouble> {
    parse(&fs::read_to_string(root().join(COUNTS))?)
}

/// The committed figures of other libraries.
pub fn peers() -> Result<Vec<Peer>, Trouble> {
    Ok(serde_json::from_str(&fs::read_to_string(
        root().join(PEERS),
    )?)?)
}

fn parse(text: &str) -> Result<Counts, Trouble> {
    let mut counts = Counts::new();
    for line in text.lines() {
        let wrong = || Trouble::new(format!("{COUNTS}: what is not understood: {line}"));
        let words: Vec<&str> = line.split_whitespace().collect();
        let (case, stage, count) = match words[..] {
            [case, stage, count] => (case, stage, count.parse()?),
            _ => return Err(wrong()),
        };
        let (experiment, precision) = match case.split_once("-levels-") {
            Some(("2", precision)) => ("two-level", precision),
            Some(("3", precision)) => ("case-1", precision),
            // Another arm's: no column of the table.
            Some(_) => continue,
            // Of other numbers of rows: likewise.
            None if case.contains("-rows-") => continue,
            None if case.starts_with(LINK) => (case, ""),
            None => return Err(wrong()),
        };
        let stage = match stage {
            "step" => "cycle".into(),
            stage => stage.replace('_', " "),
        };
        let case = format!("{experiment} {precision}").trim_end().to_string();
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
        let link = parse("link-fci-10 session_audited 27000\n").expect("counts");
        assert_eq!(link["link-fci-10"]["session audited"], 27000);
        assert_eq!(
            parse("fr3-2-levels-f64 step 9300").expect("counts"),
            Counts::new()
        );
        assert!(parse("2-levels-f64 step").is_err());
    }
}
