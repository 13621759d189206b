//! Counts lines of code: what a reader has to understand.
//!
//! Counted are src/**/*.rs and build.rs of every package, as rustfmt lays them out, without
//! blank lines, comments, `#[cfg(test)]` modules and files `tests.rs`; tests,
//! benches, examples and generated files are not. Documentation is counted apart, per public item.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use crate::tools::{Outcome, Trouble, root, run as output_of};

/// Counts of some files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Lines {
    code: usize,
    documentation: usize,
    public_items: usize,
}

/// Prints a row per package and a sum, of the working tree or of a revision.
pub fn run(revision: Option<&str>) -> Outcome {
    let mut packages = BTreeMap::<String, Lines>::new();
    for file in git(&listing(revision))?.lines() {
        let text = match (package_of(file), revision) {
            (None, _) => continue,
            (_, Some(revision)) => git(&["show", &format!("{revision}:{file}")])?,
            // Deleted, and not yet committed.
            _ if !root().join(file).exists() => continue,
            _ => fs::read_to_string(root().join(file))?,
        };
        let package = package_of(file).unwrap_or_default().to_string();
        packages.entry(package).or_default().add(count(&text));
    }
    let mut all = Lines::default();
    let [code, doc, public, per_item] = ["code", "doc", "public", "doc/item"];
    println!(
        "{:<28} {code:>7} {doc:>7} {public:>7} {per_item:>9}",
        "package"
    );
    for (name, lines) in packages {
        all.add(lines);
        print_row(&name, lines);
    }
    print_row("together", all);
    Ok(true)
}

fn print_row(name: &str, lines: Lines) {
    let Lines {
        code,
        documentation,
        public_items,
    } = lines;
    let per_item = documentation as f64 / public_items.max(1) as f64;
    println!("{name:<28} {code:>7} {documentation:>7} {public_items:>7} {per_item:>9.2}");
}

fn listing(revision: Option<&str>) -> Vec<&str> {
    match revision {
        Some(revision) => vec!["ls-tree", "-r", "--name-only", revision],
        None => vec!["ls-files", "--cached", "--others", "--exclude-standard"],
    }
}

/// The package of a counted file.
fn package_of(file: &str) -> Option<&str> {
    let package = match file.split_once("/src/") {
        Some((package, rest)) if rest.ends_with(".rs") => package,
        Some(_) => return None,
        None => file.strip_suffix("/build.rs")?,
    };
    let tests = ["/tests/", "/examples/"]
        .iter()
        .any(|it| package.contains(it));
    (!tests && !file.ends_with("/tests.rs")).then_some(package)
}

fn git(arguments: &[&str]) -> Result<String, Trouble> {
    output_of(Command::new("git").args(arguments).current_dir(root()))
}

impl Lines {
    fn add(&mut self, other: Self) {
        self.code += other.code;
        self.documentation += other.documentation;
        self.public_items += other.public_items;
    }
}

fn count(text: &str) -> Lines {
    let mut lines = Lines::default();
    let mut rest = text.lines().peekable();
    while let Some(line) = rest.next() {
        let bare = line.trim();
        if bare == "#[cfg(test)]" {
            let indent = line.len() - line.trim_start().len();
            // rustfmt closes a module at the indent where it opened it.
            let block = rest
                .peek()
                .is_some_and(|next| next.trim_end().ends_with('{'));
            if block {
                let close = format!("{}}}", " ".repeat(indent));
                while rest.next().is_some_and(|line| line != close) {}
            } else {
                rest.next();
            }
            continue;
        }
        if bare.starts_with("///") || bare.starts_with("//!") {
            lines.documentation += 1;
        } else if !bare.is_empty() && !bare.starts_with("//") {
            lines.code += 1;
            lines.public_items +=
                usize::from(bare.starts_with("pub ") && !bare.starts_with("pub use"));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_what_is_neither_blank_nor_comment_nor_test() {
        let text = "//! Doc.\n\nuse a;\n// why\n/// An item.\npub fn f() {\n    g();\n}\n\n\
                    #[cfg(test)]\nmod tests {\n    fn t() {\n    }\n}\npub const A: u8 = 1;\n\
                    #[cfg(test)]\nmod more;\nfn h() {}\n";
        let expected = Lines {
            code: 6,
            documentation: 2,
            public_items: 2,
        };
        assert_eq!(count(text), expected);
    }

    #[test]
    fn only_sources_of_packages_count() {
        assert_eq!(package_of("hil-sim/src/cli/run.rs"), Some("hil-sim"));
        assert_eq!(
            package_of("controller-core/build.rs"),
            Some("controller-core")
        );
        for other in [
            "tests/tests/a.rs",
            "xtask/src/rooms/tests.rs",
            "fri/examples/mutate/main.rs",
            "hil-sim/src/a.css",
        ] {
            assert_eq!(package_of(other), None, "{other}");
        }
    }
}
