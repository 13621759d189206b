//! Two builds of `hil-sim` and every byte of their results: whether a change of the
//! code changed a number.

mod builds;
mod compare;
mod csv;
mod difference;
mod group;
mod states;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use crate::tools::{Outcome, Trouble, failed};
use builds::{Place, Source};
use group::Group;

const SCENARIOS: [&str; 4] = ["two-level", "case-1", "case-2", "hand"];
const PLANTS: [&str; 2] = ["ideal", "realistic"];

/// Exit codes of `hil-sim` with which its results are there: pass, fail, stopped.
const VERDICTS: [i32; 3] = [0, 1, 3];

/// What is asked for.
#[derive(Debug)]
pub struct Comparison {
    place: Place,
    base: Source,
    new: Source,
    /// Parts of names of CSV columns and JSON paths that may differ.
    ignore: Vec<String>,
}

impl Comparison {
    /// Reads the words behind the command; the error is for the user.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let mut names = Vec::new();
        let mut ignore = Vec::new();
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            match word {
                "--ignore" => match words.next() {
                    Some(part) if !part.is_empty() => ignore.push(part.to_string()),
                    _ => return Err("--ignore: none; allowed: part of a name".into()),
                },
                option if option.starts_with('-') => {
                    return Err(format!("option: '{option}'; allowed: --ignore"));
                }
                name => names.push(name),
            }
        }
        let (base, new) = match names[..] {
            [base] => (base, None),
            [base, new] => (base, Some(new)),
            _ => {
                let count = names.len();
                return Err(format!("builds: {count}; allowed: BASE, or BASE and NEW"));
            }
        };
        let place = Place::find().map_err(|error| error.to_string())?;
        Ok(Self {
            base: place.source("BASE", base)?,
            new: new.map_or(Ok(Source::WorkingTree), |new| place.source("NEW", new))?,
            place,
            ignore,
        })
    }

    /// Builds what has to be built, runs both and says what differs. The results stay
    /// where they are unless they are equal.
    pub fn run(&self) -> Outcome {
        println!("base: {}", self.base);
        println!("new: {}", self.new);
        // Of this process alone: another comparison may run at the same time.
        let work = self
            .place
            .folder
            .join(format!("out-{}", std::process::id()));
        if work.exists() {
            fs::remove_dir_all(&work)?;
        }
        let pair = self.pair(&work)?;
        let equal = self.compare(&pair, &work)?;
        if equal {
            fs::remove_dir_all(&work)?;
            println!("equal in every byte{}", self.but());
        } else {
            println!("not equal; the results are in {}", work.display());
        }
        Ok(equal)
    }

    /// Each side works on a copy of its program. The base's is made before the new one
    /// is built, because the build may write to the very file that is the base.
    fn pair(&self, work: &Path) -> Result<Pair, Trouble> {
        let side = |name: &'static str, source: &Source| -> Result<Side, Trouble> {
            let program = self.place.program(source)?;
            let side = Side {
                name,
                folder: work.join(name),
            };
            fs::create_dir_all(&side.folder)?;
            fs::copy(&program, side.program())
                .map_err(|error| Trouble::Content(format!("{}: {error}", program.display())))?;
            Ok(side)
        };
        let pair = Pair {
            base: side("base", &self.base)?,
            new: side("new", &self.new)?,
        };
        if fs::read(pair.base.program())? == fs::read(pair.new.program())? {
            println!("note: both programs are the same, byte by byte");
        }
        Ok(pair)
    }

    fn compare(&self, pair: &Pair, work: &Path) -> Outcome {
        let mut equal = true;
        let mut say = |group: Group| {
            for line in group.lines() {
                println!("{line}");
            }
            equal &= group.equal();
        };
        for scenario in SCENARIOS {
            for plant in PLANTS {
                let arguments = ["run", scenario, "--plant", plant];
                say(self.results(pair, &format!("{scenario}-{plant}"), &arguments)?);
            }
        }
        say(self.results(pair, "paper", &["paper"])?);
        say(self.explained(pair, &work.join("states"))?);
        Ok(equal)
    }

    /// What a command writes to its output folder, and its exit code.
    fn results(&self, pair: &Pair, name: &str, arguments: &[&str]) -> Result<Group<'_>, Trouble> {
        let mut all = arguments.to_vec();
        all.extend(["--out", name]);
        let outputs = pair.run(&all)?;
        if !(outputs[0].status.code()).is_some_and(|code| VERDICTS.contains(&code)) {
            return Err(failed(
                &format!("base: hil-sim {}", all.join(" ")),
                &outputs[0],
            ));
        }
        let mut group = Group::new(name, "files", &self.ignore);
        group.add("exit code", 0, compare::exits(&outputs));
        let folders = [&pair.base, &pair.new].map(|side| side.folder.join(name));
        compare::folders(&folders, &mut group)?;
        if group.count == 0 {
            let name = folders[0].display();
            return Err(Trouble::Content(format!(
                "{name}: no result; allowed: some"
            )));
        }
        Ok(group)
    }

    /// What `explain` says about random states.
    fn explained(&self, pair: &Pair, folder: &Path) -> Result<Group<'_>, Trouble> {
        fs::create_dir_all(folder)?;
        let mut group = Group::new("explain", "states", &self.ignore);
        for (index, state) in states::all().iter().enumerate() {
            let name = format!("{index:03}.json");
            fs::write(folder.join(&name), format!("{state:#}\n"))?;
            let outputs = pair.run(&["explain", &format!("../states/{name}")])?;
            let [base, new] = &outputs;
            if !base.status.success() {
                let what = format!(
                    "the generator of states is wrong, base must explain each: {}",
                    folder.join(&name).display()
                );
                return Err(failed(&what, base));
            }
            let mut found = compare::exits(&outputs);
            found.extend(compare::json_bytes(&base.stdout, &new.stdout));
            group.count += 1;
            group.add(&format!("states/{name}"), base.stdout.len(), found);
        }
        Ok(group)
    }

    fn but(&self) -> String {
        if self.ignore.is_empty() {
            String::new()
        } else {
            format!(" but for names with {}", self.ignore.join(" or "))
        }
    }
}

/// One of the programs, in a folder of its own.
struct Side {
    name: &'static str,
    folder: PathBuf,
}

impl Side {
    fn program(&self) -> PathBuf {
        self.folder.join("hil-sim")
    }

    fn start(&self, arguments: &[&str]) -> Result<Child, Trouble> {
        Command::new(self.program())
            .args(arguments)
            .current_dir(&self.folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| Trouble::Content(format!("{}: hil-sim: {error}", self.name)))
    }
}

struct Pair {
    base: Side,
    new: Side,
}

impl Pair {
    /// Runs both at the same time.
    fn run(&self, arguments: &[&str]) -> Result<[Output; 2], Trouble> {
        let (base, new) = (self.base.start(arguments)?, self.new.start(arguments)?);
        Ok([base.wait_with_output()?, new.wait_with_output()?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_words_are_named() {
        let wrong = |words: &[&str]| Comparison::parse(words).expect_err("an error");
        assert_eq!(wrong(&[]), "builds: 0; allowed: BASE, or BASE and NEW");
        assert_eq!(wrong(&["--ignor"]), "option: '--ignor'; allowed: --ignore");
        assert_eq!(
            wrong(&["HEAD", "--ignore"]),
            "--ignore: none; allowed: part of a name"
        );
        assert_eq!(
            wrong(&["no-such-thing"]),
            "BASE: 'no-such-thing'; allowed: the path of a hil-sim executable, or a git revision"
        );
    }
}
