//! Commands in the fenced blocks of a document, and what it shows of their output.

/// A fenced text.
#[derive(Debug, PartialEq, Eq)]
pub struct Fence<'a> {
    /// Its line, counted from 1.
    pub line: usize,
    /// What stands behind the fence.
    pub language: &'a str,
    /// What is between the fences.
    pub lines: Vec<&'a str>,
}

/// A block of commands.
#[derive(Debug, PartialEq, Eq)]
pub struct Block {
    /// Line of its fence, counted from 1.
    pub line: usize,
    /// Its commands, in their order.
    pub commands: Vec<Command>,
    /// What a block of `text` below, in the same section, shows as the output of all of them.
    pub output: Vec<String>,
}

/// A command, as a shell takes it.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Command {
    /// Its lines: also those that it goes on in, and its here-document.
    pub text: String,
    /// What a block of `console` shows below it.
    pub output: Vec<String>,
}

impl Command {
    /// Its first line, joined with those that it goes on in, without a comment.
    pub fn name(&self) -> String {
        let (name, _) = self.first_line();
        name
    }

    /// The exit code that its comment names; 0 without one.
    pub fn exit_code(&self) -> i32 {
        let (_, comment) = self.first_line();
        let named = comment.rsplit_once("exit code ");
        named.and_then(|(_, code)| code.parse().ok()).unwrap_or(0)
    }

    /// What a shell takes of it, and the comment behind.
    fn first_line(&self) -> (String, String) {
        let joined = self.text.replace("\\\n", " ");
        let first = joined.lines().next().unwrap_or_default();
        let (code, comment) = first.split_once(" # ").unwrap_or((first, ""));
        let words: Vec<_> = code.split_whitespace().collect();
        (words.join(" "), comment.to_string())
    }
}

/// The fenced texts of a document.
pub fn fences(document: &str) -> Vec<Fence<'_>> {
    let mut fences = Vec::new();
    let mut lines = document.lines().zip(1..);
    while let Some((opening, line)) = lines.next() {
        if let Some(language) = opening.strip_prefix("```") {
            let inside = lines.by_ref().map(|(text, _)| text);
            let lines = inside.take_while(|text| !text.starts_with("```")).collect();
            fences.push(Fence {
                line,
                language,
                lines,
            });
        }
    }
    fences
}

/// The blocks of commands of a document.
pub fn blocks(document: &str) -> Vec<Block> {
    let fences = fences(document);
    let lines: Vec<&str> = document.lines().collect();
    // Between the closing fence of one and the opening fence of the next.
    let same_section = |above: &Fence<'_>, below: &Fence<'_>| {
        let between = &lines[above.line + above.lines.len()..below.line - 1];
        !between.iter().any(|line| line.starts_with('#'))
    };
    let mut blocks = Vec::new();
    for (number, fence) in fences.iter().enumerate() {
        let commands = match fence.language {
            "sh" => commands(&fence.lines, ""),
            "console" => commands(&fence.lines, "$ "),
            _ => continue,
        };
        let below = fences.get(number + 1);
        let shown = below.filter(|it| {
            fence.language == "sh" && it.language == "text" && same_section(fence, it)
        });
        blocks.push(Block {
            line: fence.line,
            commands,
            output: shown.map_or(Vec::new(), |it| owned(&it.lines)),
        });
    }
    blocks
}

fn owned(lines: &[&str]) -> Vec<String> {
    lines.iter().copied().map(String::from).collect()
}

/// Commands whose first line begins with `prompt`; what is no part of one is output.
fn commands(lines: &[&str], prompt: &str) -> Vec<Command> {
    let mut commands: Vec<Command> = Vec::new();
    let mut lines = lines.iter();
    while let Some(line) = lines.next() {
        let Some(first) = line.strip_prefix(prompt) else {
            if let Some(command) = commands.last_mut() {
                command.output.push((*line).to_string());
            }
            continue;
        };
        if first.trim().is_empty() || first.starts_with('#') {
            continue;
        }
        let mut text = first.to_string();
        while text.ends_with('\\') {
            text.push('\n');
            text.push_str(lines.next().copied().unwrap_or_default());
        }
        if let Some(end) = here_document(&text) {
            for line in lines.by_ref() {
                text.push('\n');
                text.push_str(line);
                if *line == end {
                    break;
                }
            }
        }
        commands.push(Command {
            text,
            ..Command::default()
        });
    }
    commands
}

/// The line that ends a command's here-document.
fn here_document(text: &str) -> Option<String> {
    let (_, word) = text.split_once("<<")?;
    let word = word.split_whitespace().next()?;
    Some(word.trim_matches(['\'', '"']).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(text: &str, output: &[&str]) -> Command {
        Command {
            text: text.into(),
            output: owned(output),
        }
    }

    #[test]
    fn a_block_of_sh_has_commands_and_its_output_below() {
        let document = "a\n```sh\n# remark\nrun  a   # what\n\nrun b \\\n  c\n```\nthis:\n```text\nx\n```\n```sh\nlast\n```\n";
        let [first, last] = &blocks(document)[..] else {
            panic!("two blocks");
        };
        assert_eq!((first.line, last.line), (2, 13));
        assert_eq!(
            first.commands,
            [
                command("run  a   # what", &[]),
                command("run b \\\n  c", &[])
            ]
        );
        let names = first.commands.iter().map(Command::name);
        assert_eq!(names.collect::<Vec<_>>(), ["run a", "run b c"]);
        let codes = ["a", "a # b", "a # b; exit code 3"];
        let codes = codes.map(|text| command(text, &[]).exit_code());
        assert_eq!(codes, [0, 0, 3]);
        assert_eq!(
            (&first.output[..], last.output.len()),
            (&["x".to_string()][..], 0)
        );
    }

    #[test]
    fn what_another_section_shows_is_no_output() {
        for (between, output) in [("", 1), ("so:\n", 1), ("## Next\n", 0)] {
            let document = format!("```sh\nrun\n```\n{between}```text\nx\n```\n");
            assert_eq!(blocks(&document)[0].output.len(), output, "{between}");
        }
    }

    #[test]
    fn a_block_of_console_has_output_below_each_command() {
        let document = "```console\n$ cat > f <<'END'\n$ no command\nEND\n$ run f\none\ntwo\n$ echo $?\n1\n```\n";
        let [block] = &blocks(document)[..] else {
            panic!("a block");
        };
        assert_eq!(
            block.commands,
            [
                command("cat > f <<'END'\n$ no command\nEND", &[]),
                command("run f", &["one", "two"]),
                command("echo $?", &["1"]),
            ]
        );
        assert_eq!(block.commands[0].name(), "cat > f <<'END'");
    }
}
