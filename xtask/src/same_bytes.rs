//! Two builds of `hil-sim` and every byte of their results: whether a change of the
//! code changed a number.

mod builds;
mod differences;
mod states;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::tools::{Outcome, Trouble, files, good, target};
use builds::Source;
use differences::Group;

const SCENARIOS: [&str; 4] = ["two-level", "case-1", "case-2", "hand"];
const PLANTS: [&str; 2] = ["ideal", "realistic"];

/// Exit codes of `hil-sim` with which its results are there: pass, fail, stopped.
const VERDICTS: [i32; 3] = [0, 1, 3];

/// Builds what has to be built, runs both and says what differs. The results stay where
/// they are unless they are equal.
pub fn run(words: &[&str]) -> Outcome {
    let (sources, ignore) = parse(words)?;
    // Of this process alone: another comparison may run at the same time.
    let work = target().join(format!("same-bytes/out-{}", std::process::id()));
    // Each side works on a copy of its program. The base's is made before the new one is
    // built, because the build may write to the very file that is the base.
    let sides = ["base", "new"].map(|side| work.join(side));
    for (source, side) in sources.iter().zip(&sides) {
        println!("{}: {source:?}", side.display());
        fs::create_dir_all(side)?;
        fs::copy(source.program()?, side.join("hil-sim"))?;
    }
    let equal = compare(&sides, &work.join("states"), &ignore)?;
    if equal {
        fs::remove_dir_all(&work)?;
        let but = if ignore.is_empty() {
            ""
        } else {
            " but for names with "
        };
        println!("equal in every byte{but}{}", ignore.join(" or "));
    } else {
        println!("not equal; the results are in {}", work.display());
    }
    Ok(equal)
}

/// Base and new build, and parts of names of CSV columns and JSON paths that may differ.
fn parse(words: &[&str]) -> Result<([Source; 2], Vec<String>), Trouble> {
    let allowed = "allowed: BASE [NEW] [--ignore PART]...";
    let (mut names, mut ignore) = (Vec::new(), Vec::new());
    let mut words = words.iter();
    while let Some(&word) = words.next() {
        match (word, word.starts_with('-')) {
            ("--ignore", _) => {
                let part = words.next().filter(|part| !part.is_empty());
                let none = || Trouble::usage(format!("--ignore: none; {allowed}"));
                ignore.push(part.ok_or_else(none)?.to_string());
            }
            (option, true) => return Err(Trouble::usage(format!("option: '{option}'; {allowed}"))),
            (name, false) => names.push(name),
        }
    }
    let sources = match names[..] {
        [base] => [Source::named("BASE", base)?, Source::WorkingTree],
        [base, new] => [Source::named("BASE", base)?, Source::named("NEW", new)?],
        _ => {
            return Err(Trouble::usage(format!(
                "builds: {}; {allowed}",
                names.len()
            )));
        }
    };
    Ok((sources, ignore))
}

fn compare(sides: &[PathBuf; 2], states: &Path, ignore: &[String]) -> Outcome {
    let mut equal = true;
    for scenario in SCENARIOS {
        for plant in PLANTS {
            let name = format!("{scenario}-{plant}");
            equal &= results(sides, &name, &["run", scenario, "--plant", plant], ignore)?;
        }
    }
    equal &= results(sides, "paper", &["paper"], ignore)?;
    fs::create_dir_all(states)?;
    let mut group = Group::new("explain", "states", ignore);
    for (index, state) in states::all().iter().enumerate() {
        let name = format!("../states/{index:03}.json");
        fs::write(states.join(&name), format!("{state:#}\n"))?;
        let outputs = run_both(sides, &["explain", &name], &[0])?;
        group.add_exits(&outputs);
        let [base, new] = outputs.map(|output| output.stdout);
        group.add(&name, Some(&base), Some(&new));
    }
    Ok(group.print() && equal)
}

/// What a command writes to its output folder.
fn results(sides: &[PathBuf; 2], name: &str, arguments: &[&str], ignore: &[String]) -> Outcome {
    let arguments = [arguments, &["--out", name]].concat();
    let outputs = run_both(sides, &arguments, &VERDICTS)?;
    let folders = sides.each_ref().map(|side| side.join(name));
    let mut names = [files(&folders[0])?, files(&folders[1])?].concat();
    names.retain(|name| {
        name.extension()
            .is_some_and(|it| it == "csv" || it == "json")
    });
    names.sort();
    names.dedup();
    if names.is_empty() {
        return Err(Trouble::new(format!("{name}: no result; allowed: some")));
    }
    let mut group = Group::new(name, "files", ignore);
    group.add_exits(&outputs);
    for name in names {
        let [base, new] = folders
            .each_ref()
            .map(|folder| fs::read(folder.join(&name)).ok());
        group.add(&name.to_string_lossy(), base.as_deref(), new.as_deref());
    }
    Ok(group.print())
}

/// Runs both at the same time. The base has to end with one of these exit codes.
fn run_both(
    sides: &[PathBuf; 2],
    arguments: &[&str],
    codes: &[i32],
) -> Result<[Output; 2], Trouble> {
    let mut commands = sides.each_ref().map(|side| {
        let mut command = Command::new(side.join("hil-sim"));
        command
            .args(arguments)
            .current_dir(side)
            .stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    });
    let [base, new] = &mut commands;
    let (running, new) = (base.spawn()?, new.spawn()?);
    let outputs = [running.wait_with_output()?, new.wait_with_output()?];
    if !codes
        .iter()
        .any(|code| outputs[0].status.code() == Some(*code))
    {
        good(&format!("{base:?}"), &outputs[0])?;
    }
    Ok(outputs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_words_are_named() {
        let wrong = |words: &[&str]| parse(words).expect_err("an error").text;
        let allowed = "allowed: BASE [NEW] [--ignore PART]...";
        assert_eq!(wrong(&[]), format!("builds: 0; {allowed}"));
        assert_eq!(wrong(&["--ignor"]), format!("option: '--ignor'; {allowed}"));
        assert_eq!(
            wrong(&["HEAD", "--ignore"]),
            format!("--ignore: none; {allowed}")
        );
        assert_eq!(
            wrong(&["no-such-thing"]),
            "BASE: 'no-such-thing'; allowed: the path of a hil-sim executable, or a git revision"
        );
    }
}
