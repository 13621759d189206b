//! `docs/commands.txt`: commands of the documents that are not run, files that others need, and
//! commands that run side by side.

/// The list.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct List {
    /// Commands that are not run, each with its reason.
    pub left_out: Vec<(String, Reason)>,
    /// Files that lie beside the commands of a document.
    pub files: Vec<Fixture>,
    /// Commands that run while the next one does.
    pub beside: Vec<String>,
}

/// Why a command is not run.
#[derive(Debug, PartialEq, Eq)]
pub enum Reason {
    /// This step of `.ci/run` runs it.
    Step(String),
    /// What a sentence says.
    Said(String),
}

/// A file that the commands of a document find.
#[derive(Debug, PartialEq, Eq)]
pub struct Fixture {
    /// The document.
    pub document: String,
    /// Name of the file.
    pub name: String,
    /// A file of the workspace; or a language: the first block of it in the document.
    pub source: String,
}

/// Reads the list.
///
/// # Errors
/// The first line that cannot be used, by number.
pub fn parse(text: &str) -> Result<List, String> {
    let mut list = List::default();
    let mut section = "";
    let mut command = None;
    for (line, number) in text.lines().zip(1..) {
        let indented = line.starts_with(' ');
        let content = line.trim();
        if content.is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(name) = line.strip_prefix('[') {
            section = name.trim_end_matches(']');
            continue;
        }
        match (section, indented) {
            ("not run", false) => {
                if let Some(command) = command.replace(content.to_string()) {
                    return Err(format!("{number}: '{command}' has no reason"));
                }
            }
            ("not run", true) => {
                let command = command
                    .take()
                    .ok_or_else(|| format!("{number}: a reason without a command"))?;
                let reason = match content.strip_prefix("step: ") {
                    Some(step) => Reason::Step(step.to_string()),
                    None => Reason::Said(content.to_string()),
                };
                list.left_out.push((command, reason));
            }
            ("files", false) => {
                let [document, name, source] = content.split(' ').collect::<Vec<_>>()[..] else {
                    return Err(format!(
                        "{number}: '{content}'; allowed: document, file, source"
                    ));
                };
                list.files.push(Fixture {
                    document: document.into(),
                    name: name.into(),
                    source: source.into(),
                });
            }
            ("side by side", false) => list.beside.push(content.to_string()),
            _ => {
                let allowed = "a line of [not run], [files] or [side by side]";
                return Err(format!("{number}: '{content}'; allowed: {allowed}"));
            }
        }
    }
    match command {
        Some(command) => Err(format!("the last line: '{command}' has no reason")),
        None => Ok(list),
    }
}

/// The lines of a step of `.ci/run`.
pub fn step<'a>(ci: &'a str, name: &str) -> Option<Vec<&'a str>> {
    let heading = format!("step \"{name}\"");
    let mut lines = ci.lines().skip_while(|line| line.trim() != heading);
    lines.next()?;
    let lines = lines.take_while(|line| !line.trim().starts_with("step \""));
    Some(lines.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read() {
        let text = "# remark\n[not run]\ncargo test\n    step: tests\nlong one\n    takes an hour\n\n\
                    [files]\nREADME.md a.toml toml\n[side by side]\nserve\n";
        let list = parse(text).expect("a list");
        assert_eq!(
            list.left_out,
            [
                ("cargo test".to_string(), Reason::Step("tests".into())),
                ("long one".to_string(), Reason::Said("takes an hour".into())),
            ]
        );
        assert_eq!(list.files[0].source, "toml");
        assert_eq!(list.beside, ["serve"]);
    }

    #[test]
    fn what_cannot_be_meant_is_refused_by_line() {
        for (text, error) in [
            (
                "run",
                "1: 'run'; allowed: a line of [not run], [files] or [side by side]",
            ),
            ("[not run]\na\nb\n", "3: 'a' has no reason"),
            ("[not run]\n  why\n", "2: a reason without a command"),
            ("[not run]\na\n", "the last line: 'a' has no reason"),
            (
                "[files]\na b\n",
                "2: 'a b'; allowed: document, file, source",
            ),
        ] {
            assert_eq!(parse(text), Err(error.to_string()));
        }
    }

    #[test]
    fn a_step_ends_where_the_next_begins() {
        let ci = "step \"a\"\none\n  step \"b\"\n  two\nstep \"c\"\n";
        assert_eq!(step(ci, "a"), Some(vec!["one"]));
        assert_eq!(step(ci, "b"), Some(vec!["  two"]));
        assert_eq!(step(ci, "c"), Some(vec![]));
        assert_eq!(step(ci, "d"), None);
    }
}
