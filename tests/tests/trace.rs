//! docs/trace.md and docs/errata.md against the code and the tests, both ways:
//! what they name exists, and what a test says it covers they name.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

const EQUATIONS: u32 = 55; // of the paper
const ERRATA: u32 = 11; // entries of docs/errata.md
const CLAIMS: &str = "hil-sim/src/paper/claims.rs";
const STABILITY: &str = "hil-sim/src/paper/stability.rs"; // names of its claims

/// The two documents and every Rust file, by its path in the workspace.
struct Project {
    trace: String,
    errata: String,
    files: BTreeMap<String, String>,
}

/// One line of the table: | (N) | what it is | code | tests, claims or a reason |.
struct Row {
    equation: u32,
    code: Vec<String>,
    evidence: Vec<String>,
    reason: bool,
}

/// A test function and the equations `eq (N)` of its doc comment.
struct Test {
    place: String,
    equations: BTreeSet<u32>,
}

#[test]
fn every_equation_and_erratum_has_its_place_in_code_and_tests() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let read = |path: &str| fs::read_to_string(root.join(path)).expect(path);
    let mut files = BTreeMap::new();
    collect(&root, "", &mut files);
    let project = Project {
        trace: read("docs/trace.md"),
        errata: read("docs/errata.md"),
        files,
    };
    let problems = project.problems();
    assert!(problems.is_empty(), "\n{}\n", problems.join("\n"));
}

/// Rust files below `folder`, build products and hidden folders left out.
fn collect(root: &Path, folder: &str, files: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(root.join(folder)).expect(folder) {
        let entry = entry.expect(folder);
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = format!("{folder}{name}");
        if entry.file_type().expect(&path).is_dir() {
            if !name.starts_with("target") && !name.starts_with('.') {
                collect(root, &format!("{path}/"), files);
            }
        } else if name.ends_with(".rs") {
            files.insert(path.clone(), fs::read_to_string(entry.path()).expect(&path));
        }
    }
}

impl Project {
    /// One line per fault, naming equation or erratum, test and file.
    fn problems(&self) -> Vec<String> {
        let rows: Vec<Row> = self.trace.lines().filter_map(row).collect();
        let tests: Vec<Test> = self.files.iter().flat_map(|(p, t)| tests(p, t)).collect();
        let mut found = Vec::new();
        let mut need = |holds: bool, line: String| found.extend((!holds).then_some(line));
        let numbers: Vec<u32> = rows.iter().map(|row| row.equation).collect();
        for n in 1..=EQUATIONS {
            let count = numbers.iter().filter(|m| **m == n).count();
            need(count == 1, format!("trace.md ({n}): {count} rows, not 1"));
        }
        need(numbers.is_sorted(), "trace.md: not in order".into());
        for row in &rows {
            let n = row.equation;
            let at = format!("trace.md ({n}):");
            need(n <= EQUATIONS, format!("{at} not in the paper"));
            need(!row.code.is_empty(), format!("{at} no code"));
            for place in &row.code {
                need(self.defines(place), format!("{at} no code {place}"));
            }
            let shown = row.reason || !row.evidence.is_empty();
            need(shown, format!("{at} no test, claim or reason"));
            for place in &row.evidence {
                need(self.knows(place, &tests), format!("{at} no test {place}"));
                let mut named = tests.iter().filter(|test| test.place == *place);
                let says = named.all(|test| test.equations.contains(&n));
                need(says, format!("{at} {place} does not say eq ({n})"));
            }
        }
        for Test { place, equations } in &tests {
            for n in equations {
                let lists = |row: &Row| row.equation == *n && row.evidence.contains(place);
                let listed = rows.iter().any(lists);
                need(listed, format!("trace.md ({n}): {place} is not listed"));
            }
        }
        self.check_errata(&tests, need);
        found
    }

    /// Entries 1 to 11 in order, each shown by a test or a run that exists, and
    /// every test `erratum_N_..` named by entry N.
    fn check_errata(&self, tests: &[Test], mut need: impl FnMut(bool, String)) {
        let sections = self.errata.split("\n## ").skip(1);
        let number = |section: &str| section.split('.').next()?.parse::<u32>().ok();
        let numbers = sections.clone().map(|section| number(section).unwrap_or(0));
        need(numbers.eq(1..=ERRATA), "errata.md: not in order".into());
        for (n, section) in (1..).zip(sections) {
            let at = format!("errata.md {n}:");
            let mut shown = quoted(section);
            shown.retain(|name| is_evidence(name) || name.starts_with("hil-sim run "));
            need(!shown.is_empty(), format!("{at} no test or run"));
            for place in shown.iter().filter(|name| is_evidence(name)) {
                need(self.knows(place, tests), format!("{at} no test {place}"));
            }
            let own = |test: &&Test| test.place.contains(&format!("::erratum_{n}_"));
            for Test { place, .. } in tests.iter().filter(own) {
                need(shown.contains(place), format!("{at} {place} is not named"));
            }
        }
    }

    /// Whether `path.rs::a::b` is a file that defines a and b.
    fn defines(&self, place: &str) -> bool {
        let (path, items) = place.split_once("::").unwrap_or((place, ""));
        let text = self.files.get(path);
        text.is_some_and(|text| items.split("::").all(|item| defines(text, item)))
    }

    /// Whether there is such a test or claim.
    fn knows(&self, place: &str, tests: &[Test]) -> bool {
        match place.strip_prefix("claim:") {
            Some(id) => self.claims(id),
            None => tests.iter().any(|test| test.place == place),
        }
    }

    /// Whether a string of the claims, or for those on stability one of the names that
    /// they take over, is the identifier.
    fn claims(&self, id: &str) -> bool {
        let (file, id) = match id.strip_prefix("stability-") {
            Some(name) => (STABILITY, name),
            None => (CLAIMS, id),
        };
        let text = self.files.get(file).map_or("", String::as_str);
        text.split('"')
            .skip(1)
            .step_by(2)
            .any(|part| fits(part, id))
    }
}

/// Whether a string of the source, lower case, hyphens for blanks and anything for
/// `{..}`, is the identifier.
fn fits(source: &str, id: &str) -> bool {
    let source = source.to_lowercase().replace(' ', "-");
    let fixed: Vec<&str> = source.split(['{', '}']).step_by(2).collect();
    let mut parts = fixed.iter();
    let found = parts.try_fold(id, |rest, part| Some(rest.split_once(part)?.1));
    let formatted = id.starts_with(fixed[0]) && found.is_some() && fixed.concat().len() > 3;
    source == id || (fixed.len() > 1 && formatted)
}

/// Whether a line declares `name`: an item, or a variant or field at its start.
fn defines(text: &str, name: &str) -> bool {
    const ITEMS: [&str; 7] = ["fn", "struct", "enum", "const", "trait", "type", "mod"];
    text.lines().map(str::trim_start).any(|line| {
        let words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
        let mut pairs = words.clone().zip(words.skip(1));
        let item = pairs.any(|(kind, word)| ITEMS.contains(&kind) && word == name);
        let start = line.strip_prefix("pub ").unwrap_or(line);
        let rest = start.strip_prefix(name).unwrap_or("");
        let entry = [",", "(", " {", ":"].iter().any(|s| rest.starts_with(s));
        !line.starts_with("//") && (item || entry)
    })
}

fn row(line: &str) -> Option<Row> {
    let mut cells = line.strip_prefix("| (")?.split('|').map(str::trim);
    let equation = cells.next()?.strip_suffix(')')?.parse().ok()?;
    let (code, checked) = (cells.nth(1)?, cells.next()?);
    let mut evidence = quoted(checked);
    evidence.retain(|name| is_evidence(name));
    Some(Row {
        equation,
        code: quoted(code),
        evidence,
        reason: checked.starts_with("reason: "),
    })
}

/// What stands between backticks.
fn quoted(text: &str) -> Vec<String> {
    let parts = text.split('`').skip(1).step_by(2);
    parts.map(str::to_string).collect()
}

fn is_evidence(name: &str) -> bool {
    name.contains(".rs::") || name.starts_with("claim:")
}

/// The functions with `#[test]`.
fn tests(path: &str, text: &str) -> Vec<Test> {
    let (mut doc, mut is_test, mut tests) = (String::new(), false, Vec::new());
    for line in text.lines().map(str::trim_start) {
        if let Some(words) = line.strip_prefix("///") {
            doc += words.trim_end();
        } else if line.starts_with("#[") {
            is_test |= line == "#[test]";
        } else {
            if let (true, Some(rest)) = (is_test, line.strip_prefix("fn ")) {
                let name = rest.split('(').next().unwrap_or(rest);
                let doc = doc.to_lowercase();
                let numbers = doc.split("eq (").skip(1).filter_map(|s| s.split_once(')'));
                tests.push(Test {
                    place: format!("{path}::{name}"),
                    equations: numbers.filter_map(|(n, _)| n.parse().ok()).collect(),
                });
            }
            (doc, is_test) = (String::new(), false);
        }
    }
    tests
}

/// A project of two equations with a test and 53 with a reason.
fn sound() -> Project {
    let mut trace = String::from("| eq | what | code | checked by |\n|---|---|---|---|\n");
    for n in 1..=EQUATIONS {
        let evidence = match n {
            6 => "`t.rs::motion`, `claim:s-circle`",
            7 => "`t.rs::motion`, `claim:s-case-1-level2`",
            _ => "reason: a definition in the paper's argument",
        };
        trace += &format!("| ({n}) | text | `a.rs::Arm::mass` | {evidence} |\n");
    }
    let entry = |n| format!("\n## {n}. Title\n\n`t.rs::motion`, `run {n}`\n");
    let errata = (1..=ERRATA).map(entry).collect();
    let test = "/// Covers eq (6), eq\n/// (7).\n#[test]\nfn motion() {\n}\n";
    let claims = "s.add(\"s-circle\"); format!(\"s-{x}-level{n}\")";
    let arm = "pub struct Arm {\n    pub mass: f64,\n}\n";
    let files = [("a.rs", arm), ("t.rs", test), (CLAIMS, claims)];
    let files = files.map(|(path, text)| (path.into(), text.into()));
    Project {
        trace,
        errata,
        files: files.into(),
    }
}

/// In which document, what for what, and the line that the checker then prints.
const FAULTS: &str = "\
trace: | (9) => | 9 => trace.md (9): 0 rows, not 1
trace: | (9) => | (8) => trace.md (8): 2 rows, not 1
trace: | (55) => | (56) => trace.md (56): not in the paper
trace: | (1) => | (55) => trace.md: not in order
trace: `a.rs::Arm::mass` => => trace.md (1): no code
trace: Arm::mass => Arm::load => trace.md (1): no code a.rs::Arm::load
trace: a.rs::Arm => b.rs::Arm => trace.md (1): no code b.rs::Arm::mass
trace: reason: => => trace.md (1): no test, claim or reason
trace: t.rs::motion => t.rs::rest => trace.md (6): no test t.rs::rest
trace: t.rs::motion => t.rs::rest => trace.md (6): t.rs::motion is not listed
trace: claim:s-circle => claim:s-square => trace.md (6): no test claim:s-square
tests: (7) => (6) => trace.md (7): t.rs::motion does not say eq (7)
tests: #[test] => #[cfg(all())] => trace.md (6): no test t.rs::motion
tests: (6) => (6), eq (8) => trace.md (8): t.rs::motion is not listed
tests: motion => erratum_2_sign => errata.md 2: t.rs::erratum_2_sign is not named
errata: ## 2. => ## 1. => errata.md: not in order
errata: t.rs::motion => t.rs::rest => errata.md 1: no test t.rs::rest
errata: `t.rs::motion`, `run 3` => => errata.md 3: no test or run";

#[test]
fn a_sound_project_has_no_problems_and_each_fault_is_named() {
    assert_eq!(sound().problems(), [""; 0]);
    for fault in FAULTS.lines() {
        let (document, change) = fault.split_once(": ").expect(fault);
        let parts: Vec<&str> = change.split("=>").map(str::trim).collect();
        let mut project = sound();
        let text = match document {
            "trace" => &mut project.trace,
            "errata" => &mut project.errata,
            _ => project.files.get_mut("t.rs").expect("the tests"),
        };
        assert!(text.contains(parts[0]), "{fault}");
        *text = text.replacen(parts[0], parts[1], 1);
        let found = project.problems();
        assert!(
            found.iter().any(|line| line == parts[2]),
            "{fault}: {found:?}"
        );
    }
}
