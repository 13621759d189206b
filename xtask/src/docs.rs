//! Commands of the documents are run, and print what the documents show.

mod blocks;
mod list;
mod sandbox;

use std::collections::BTreeSet;
use std::fs;
use std::time::Instant;

use crate::tools::{Outcome, Trouble, root};
use blocks::{Block, Command, blocks, fences};
use list::{Fixture, List, Reason};
use sandbox::{Ran, Sandbox, Step};

/// Commands that are not run, from the workspace's root.
const LIST: &str = "docs/commands.txt";

/// Runs the commands of all documents, or of those that are named.
pub fn run(words: &[&str]) -> Outcome {
    let list = list::parse(&fs::read_to_string(root().join(LIST))?)
        .map_err(|line| Trouble::new(format!("{LIST}:{line}")))?;
    let all = documents()?;
    let chosen: Vec<&String> = match words {
        [] => all.iter().collect(),
        words => all
            .iter()
            .filter(|it| words.contains(&it.as_str()))
            .collect(),
    };
    if chosen.len() < words.len() {
        let (words, all) = (words.join(" "), all.join(", "));
        return Err(Trouble::usage(format!("docs: '{words}'; allowed: {all}")));
    }
    let ci = fs::read_to_string(root().join(".ci/run"))?;
    let mut wrong = unfounded(&list, &ci);
    wrong.extend(unused(&list, &all)?);
    let sandbox = Sandbox::new()?;
    for document in chosen {
        let start = Instant::now();
        let text = fs::read_to_string(root().join(document))?;
        for fixture in list.files.iter().filter(|it| it.document == *document) {
            place(&sandbox, fixture, &text)?;
        }
        let mut ran = 0;
        for block in blocks(&text) {
            let steps = steps(&block, &list);
            let done = sandbox.run(&steps)?;
            ran += done.len();
            let judged = judge(&block, &list, &done);
            wrong.extend(judged.map(|what| format!("{document}:{}: {what}", block.line)));
        }
        let seconds = start.elapsed().as_secs_f64();
        println!("{document}: {ran} commands run in {seconds:.1} s");
    }
    for line in &wrong {
        println!("{line}");
    }
    Ok(wrong.is_empty())
}

/// The documents, from the workspace's root.
fn documents() -> Result<Vec<String>, Trouble> {
    let mut all = vec!["README.md".to_string(), "CONTRIBUTING.md".to_string()];
    let mut others = Vec::new();
    for entry in fs::read_dir(root().join("docs"))? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") {
            others.push(format!("docs/{name}"));
        }
    }
    others.sort();
    all.extend(others);
    Ok(all)
}

/// Commands that are said to be run by a step of CI which does not.
fn unfounded(list: &List, ci: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    for (command, reason) in &list.left_out {
        if let Reason::Step(name) = reason {
            let lines = list::step(ci, name).unwrap_or_default();
            if !lines.iter().any(|line| line.contains(command)) {
                wrong.push(format!(
                    "{LIST}: no step '{name}' of .ci/run runs '{command}'"
                ));
            }
        }
    }
    wrong
}

/// Lines of the list that no document has a command or a file for.
fn unused(list: &List, documents: &[String]) -> Result<Vec<String>, Trouble> {
    let mut names = BTreeSet::new();
    for document in documents {
        let text = fs::read_to_string(root().join(document))?;
        let commands = blocks(&text).into_iter().flat_map(|block| block.commands);
        names.extend(commands.map(|command| command.name()));
    }
    let left_out = list.left_out.iter().map(|(command, _)| command);
    let unused = left_out
        .chain(&list.beside)
        .filter(|it| !names.contains(*it));
    let mut wrong: Vec<_> = unused
        .map(|command| format!("{LIST}: no document has '{command}'"))
        .collect();
    let files = list
        .files
        .iter()
        .filter(|it| !documents.contains(&it.document));
    wrong.extend(files.map(|it| format!("{LIST}: no document {}", it.document)));
    Ok(wrong)
}

/// Lays a file beside the commands of its document.
fn place(sandbox: &Sandbox, fixture: &Fixture, document: &str) -> Result<(), Trouble> {
    let fences = fences(document);
    let fence = fences.iter().find(|it| it.language == fixture.source);
    let text = match fence {
        Some(fence) => fence.lines.join("\n") + "\n",
        None => fs::read_to_string(root().join(&fixture.source))?,
    };
    fs::write(sandbox.workspace().join(&fixture.name), text)?;
    Ok(())
}

fn is_left_out(command: &Command, list: &List) -> bool {
    let name = command.name();
    list.left_out.iter().any(|(left_out, _)| *left_out == name)
}

fn steps<'a>(block: &'a Block, list: &List) -> Vec<Step<'a>> {
    let run = block.commands.iter().filter(|it| !is_left_out(it, list));
    let step = |command: &'a Command| Step {
        text: &command.text,
        beside: list.beside.contains(&command.name()),
    };
    run.map(step).collect()
}

/// What is wrong in a block whose commands did that.
fn judge<'a>(block: &'a Block, list: &List, done: &'a [Ran]) -> impl Iterator<Item = String> + 'a {
    let run = block.commands.iter().filter(|it| !is_left_out(it, list));
    let run: Vec<&Command> = run.collect();
    let asked = |number: usize| run.get(number + 1).is_some_and(|it| it.name() == "echo $?");
    let mut wrong = Vec::new();
    for (number, (command, ran)) in run.iter().zip(done).enumerate() {
        let name = command.name();
        if ran.code != command.exit_code() && !asked(number) {
            wrong.push(format!("'{name}': exit code {}\n{}", ran.code, ran.printed));
        } else if let Some(line) = lacking(&command.output, &ran.printed) {
            wrong.push(format!(
                "'{name}' does not print '{line}':\n{}",
                ran.printed
            ));
        }
    }
    let printed: String = done.iter().map(|ran| ran.printed.as_str()).collect();
    // Of commands that are not run nothing is known.
    let last = block
        .commands
        .last()
        .is_some_and(|it| !is_left_out(it, list));
    let shown = lacking(&block.output, &printed).filter(|_| last);
    wrong.extend(shown.map(|line| format!("the block does not print '{line}':\n{printed}")));
    wrong.into_iter()
}

/// The first line of `shown` that `printed` does not have behind those above; `...` stands for
/// any lines, at the end of a line for the rest of it.
fn lacking<'a>(shown: &'a [String], printed: &str) -> Option<&'a str> {
    fn words(line: &str) -> Vec<&str> {
        line.split_whitespace().collect()
    }
    let mut printed = printed.lines().map(words);
    let mut shown = shown.iter().map(String::as_str);
    shown.find(|line| match &words(line)[..] {
        [] | ["..."] => false,
        [begin @ .., "..."] => !printed.any(|line| line.starts_with(begin)),
        wanted => !printed.any(|line| line == wanted),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ran(printed: &str, code: i32) -> Ran {
        Ran {
            printed: printed.into(),
            code,
        }
    }

    fn judged(document: &str, list: &str, done: &[Ran]) -> Vec<String> {
        let list = list::parse(list).expect("a list");
        let [block] = &blocks(document)[..] else {
            panic!("a block");
        };
        assert_eq!(steps(block, &list).len(), done.len());
        judge(block, &list, done).collect()
    }

    #[test]
    fn exit_codes_and_shown_lines_count() {
        let document = "```console\n$ a\none   1\n...\nthree ...\n$ echo $?\n3\n$ b\n```\n";
        let fine = [
            ran("one 1\ntwo\nthree or four\n", 3),
            ran("3\n", 0),
            ran("", 0),
        ];
        assert!(judged(document, "", &fine).is_empty());
        for (printed, code, wrong) in [
            ("one 1\n", 0, "'a' does not print 'three ...'"),
            ("three\none 1\n", 0, "'a' does not print 'three ...'"),
            ("one 2\nthree\n", 0, "'a' does not print 'one   1'"),
        ] {
            let done = [ran(printed, code), ran("3\n", 0), ran("", 0)];
            let [line] = &judged(document, "", &done)[..] else {
                panic!("{printed}");
            };
            assert!(line.starts_with(wrong), "{line}");
        }
        let done = [ran("one 1\nthree\n", 0), ran("3\n", 0), ran("", 1)];
        assert_eq!(judged(document, "", &done), ["'b': exit code 1\n"]);
    }

    #[test]
    fn the_text_below_a_block_is_what_its_commands_print() {
        let document = "```sh\na   # first\nb\n```\n```text\nx\n```\n";
        let list = "[not run]\na\n    step: tests\n";
        assert!(judged(document, list, &[ran("x\n", 0)]).is_empty());
        assert_eq!(judged(document, list, &[ran("y\n", 0)]).len(), 1);
        let other = "[not run]\nb\n  why\n";
        assert!(judged(document, other, &[ran("y\n", 0)]).is_empty());
    }

    #[test]
    fn a_step_that_does_not_run_a_command_is_no_reason() {
        let list = list::parse("[not run]\ncargo a\n    step: one\n").expect("a list");
        assert!(unfounded(&list, "step \"one\"\ncargo a --quiet\n").is_empty());
        assert_eq!(
            unfounded(&list, "step \"one\"\nstep \"two\"\ncargo a\n").len(),
            1
        );
    }

    #[test]
    fn what_is_listed_has_to_occur() {
        let list = "[not run]\nno such command\n    step: one\n[files]\ndocs/none.md a b\n";
        let list = list::parse(list).expect("a list");
        let wrong = unused(&list, &["README.md".to_string()]).expect("the document");
        assert_eq!(wrong.len(), 2, "{wrong:?}");
    }
}
