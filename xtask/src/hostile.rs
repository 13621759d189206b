//! The programs that damage what codecs, machines and sessions get, one after the other.

use crate::tools::{Outcome, cargo};

/// Package and example.
const PROGRAMS: [(&str, &str); 3] = [
    ("fri", "mutate"),
    ("fci", "mutate"),
    ("bridge", "mutate_session"),
];

/// Runs all of them with the same arguments, also behind one that fails.
pub fn run(words: &[&str]) -> Outcome {
    let mut fine = true;
    for (package, example) in PROGRAMS {
        println!("-- {package} {example}");
        let mut program = cargo("run");
        program.args(["--release", "-p", package]);
        program.args(["--example", example, "--"]).args(words);
        fine &= program.status()?.success();
    }
    Ok(fine)
}
