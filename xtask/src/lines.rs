//! Counts lines of code: what a reader has to understand.
//!
//! Counted are src/**/*.rs and build.rs of every package, as rustfmt lays them out, without
//! blank lines, comments and `#[cfg(test)]` modules, also those in files of their own; tests,
//! benches, examples and generated files are not. Documentation is counted apart, per public item.

use std::path::Path;
use std::process::Command;

use crate::tools::{Outcome, Trouble, failed};

/// Counts of some files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Lines {
    code: usize,
    documentation: usize,
    public_items: usize,
}

/// Prints a row per package and a sum, of the working tree or of a revision.
pub fn run(revision: Option<&str>) -> Outcome {
    let mut files: Vec<(String, String)> = Vec::new();
    for file in git(&listing(revision))?.lines() {
        if package_of(file).is_none() {
            continue;
        }
        let text = match revision {
            Some(revision) => git(&["show", &format!("{revision}:{file}")])?,
            // Deleted, and not yet committed.
            None if !Path::new(file).exists() => continue,
            None => std::fs::read_to_string(file)?,
        };
        files.push((file.to_string(), text));
    }
    let tests: Vec<String> = files
        .iter()
        .flat_map(|(file, text)| test_modules(file, text))
        .collect();
    let mut packages: Vec<(String, Lines)> = Vec::new();
    for (file, text) in &files {
        let Some(package) = package_of(file).filter(|_| !is_test(file, &tests)) else {
            continue;
        };
        let lines = count(text);
        match packages.iter_mut().find(|(name, _)| *name == package) {
            Some((_, sum)) => sum.add(lines),
            None => packages.push((package.to_string(), lines)),
        }
    }
    let mut all = Lines::default();
    println!(
        "{:<28} {:>7} {:>7} {:>7} {:>9}",
        "package", "code", "doc", "public", "doc/item"
    );
    for (name, lines) in &packages {
        all.add(*lines);
        print_row(name, lines);
    }
    print_row("together", &all);
    Ok(true)
}

fn print_row(name: &str, lines: &Lines) {
    let per_item = lines.documentation as f64 / lines.public_items.max(1) as f64;
    let Lines {
        code,
        documentation,
        public_items,
    } = lines;
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
    let counted = !package.contains("/tests/") && !package.contains("/examples/");
    counted.then_some(package)
}

/// The modules in files of their own that a file has for its tests: their paths, without
/// what is behind the name.
fn test_modules(file: &str, text: &str) -> Vec<String> {
    let folder = ["/lib.rs", "/main.rs", "/mod.rs", ".rs"]
        .iter()
        .find_map(|end| file.strip_suffix(end))
        .unwrap_or(file);
    let lines = text.lines().map(str::trim);
    lines
        .clone()
        .zip(lines.skip(1))
        .filter(|(attribute, _)| *attribute == "#[cfg(test)]")
        .filter_map(|(_, module)| module.strip_suffix(';')?.split("mod ").nth(1))
        .map(|name| format!("{folder}/{name}"))
        .collect()
}

/// Whether a file is one of these modules or below it.
fn is_test(file: &str, tests: &[String]) -> bool {
    tests.iter().any(|module| {
        let rest = file.strip_prefix(module.as_str());
        rest.is_some_and(|rest| rest == ".rs" || rest.starts_with('/'))
    })
}

fn git(arguments: &[&str]) -> Result<String, Trouble> {
    let output = Command::new("git").args(arguments).output()?;
    if !output.status.success() {
        return Err(failed("git", &output));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
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
    fn modules_of_tests_do_not_count() {
        let text = "mod a;\n#[cfg(test)]\nmod tests;\nmod tree;\n";
        for (file, module) in [
            ("x/src/rooms.rs", "x/src/rooms/tests"),
            ("x/src/rooms/mod.rs", "x/src/rooms/tests"),
            ("x/src/lib.rs", "x/src/tests"),
        ] {
            let tests = test_modules(file, text);
            assert_eq!(tests, [module], "{file}");
            for end in [".rs", "/mod.rs", "/more.rs"] {
                assert!(is_test(&format!("{module}{end}"), &tests), "{file} {end}");
            }
            assert!(!is_test(&format!("{module}_of.rs"), &tests));
        }
        assert!(test_modules("x/src/a.rs", "#[cfg(test)]\nmod tests {\n").is_empty());
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
            "fri/examples/mutate/main.rs",
            "hil-sim/src/a.css",
        ] {
            assert_eq!(package_of(other), None, "{other}");
        }
    }
}
