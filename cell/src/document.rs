//! `docs/keys.md`: every key of scenario and arm files, from the declarations that read and check
//! them.

use std::fmt::{self, Write as _};

use crate::arm::file::{ArmSpec, Point};
use crate::arm::joint::{EndApproachSpec, FrictionSpec, JointSpec};
use crate::arm::joint_limits::JointLimitsSpec;
use crate::arm::pose::PoseSpec;
use crate::keys::{Absent, Key};
use crate::scenario::{
    EVENTS, EquippedArm, Hand, KINDS, LevelLimitsSpec, LevelSpec, Limit, Mount, NullSpaceSpec,
    ObserverSpec, OnLink, Push, Scenario, StaleSpec, TOOL_POINT, TaskSpec, ToolSpec,
};

/// A table of a file.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// The way to it, keys with points between them; empty of the file itself.
    pub path: &'static str,
    /// Whether there may be several.
    pub list: bool,
    /// Which of several shapes of the table this is, by the word behind its `kind`.
    pub kind: Option<&'static str>,
    /// What is said above its keys.
    pub about: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

impl Table {
    const fn of(path: &'static str, keys: &'static [Key]) -> Self {
        Self {
            path,
            list: false,
            kind: None,
            about: "",
            keys,
        }
    }

    const fn about(self, about: &'static str) -> Self {
        Self { about, ..self }
    }

    const fn list(self) -> Self {
        Self { list: true, ..self }
    }
}

/// The tables of a scenario file.
#[must_use]
pub fn of_scenarios() -> Vec<Table> {
    let kinds = KINDS.iter().map(|kind| Table {
        kind: Some(kind.word),
        about: match kind.tasks {
            [TaskSpec::Position] => "For positions.",
            [TaskSpec::Orientation] => "For orientations.",
            _ => "For both.",
        },
        ..Table::of("level.reference", kind.keys)
    });
    let above = [
        Table::of("", Scenario::KEYS),
        Table::of("mount", Mount::KEYS)
            .about("[How plates stand](files.md#mount-and-tool), with examples."),
        Table::of("tool", ToolSpec::KEYS),
        Table::of("joint_limits", JointLimitsSpec::KEYS),
        Table::of("level", LevelSpec::KEYS).list(),
        Table::of("level.point", OnLink::KEYS)
            .about("Also of contacts and hands: a point that has no name."),
        Table::of("level.stale", StaleSpec::KEYS),
        Table::of("level.limits", LevelLimitsSpec::KEYS),
    ];
    let below = [
        Table::of("null_space", NullSpaceSpec::KEYS),
        Table::of("observer", ObserverSpec::KEYS),
        Table::of("contact", Push::KEYS).list(),
        Table::of("hand", Hand::KEYS)
            .list()
            .about("Its force is told in [files.md](files.md#mount-and-tool)."),
        Table::of("limit", Limit::KEYS).list(),
    ];
    let events = EVENTS.map(|(word, keys)| Table {
        kind: Some(word),
        about: "[Tasks that change](changing-tasks.md), with an example.",
        ..Table::of("event", keys).list()
    });
    let all = above.into_iter().chain(kinds).chain(below);
    all.chain(events).collect()
}

/// The tables of an arm file.
#[must_use]
pub fn of_arms() -> Vec<Table> {
    vec![
        Table::of("", ArmSpec::KEYS),
        Table::of("base", PoseSpec::KEYS),
        Table::of("flange", PoseSpec::KEYS),
        Table::of("joint", JointSpec::KEYS).list(),
        Table::of("joint.friction", FrictionSpec::KEYS),
        Table::of("joint.end_approach", EndApproachSpec::KEYS)
            .about("A speed of at most -margin + sqrt(2 deceleration x way) towards an end."),
        Table::of("point", Point::KEYS).list(),
    ]
}

/// The whole document.
#[must_use]
pub fn text() -> String {
    let mut text = String::from(HEAD);
    // To memory: this cannot fail.
    let _ = write_tables(&mut text, "Scenario files", &of_scenarios())
        .and_then(|()| write_tables(&mut text, "Arm files", &of_arms()))
        .and_then(|()| write_arms(&mut text));
    text
}

const HEAD: &str = "\
# Keys of files

Every key of scenario and arm files. This text is made of the declarations that read and check the
files: `UPDATE_DOCS=1 cargo test -p cell --test keys` writes it, and the same test without
`UPDATE_DOCS` compares.

Files are TOML. A key that is not here is an error, and every error names file, line, key, value and
what is allowed. Where a key stands for several numbers, `7, each 0 to 1` are seven in a list.
Symbols: [notation.md](notation.md).
";

fn write_tables(text: &mut String, title: &str, tables: &[Table]) -> fmt::Result {
    writeln!(text, "\n## {title}")?;
    for table in tables {
        writeln!(text, "\n### {}\n", heading(table))?;
        if !table.about.is_empty() {
            writeln!(text, "{}\n", table.about)?;
        }
        if table.keys.is_empty() {
            writeln!(text, "No other key.")?;
            continue;
        }
        writeln!(text, "| key | unit | allowed | without it | meaning |")?;
        writeln!(text, "|---|---|---|---|---|")?;
        for key in table.keys {
            writeln!(text, "{}", row(key))?;
        }
    }
    Ok(())
}

fn heading(table: &Table) -> String {
    let Table { path, .. } = table;
    match (table.kind, table.list) {
        _ if path.is_empty() => "At the top".to_string(),
        (Some(kind), _) => format!("`[{path}]` with `kind = \"{kind}\"`"),
        (None, true) => format!("`[[{path}]]`"),
        (None, false) => format!("`[{path}]`"),
    }
}

fn row(key: &Key) -> String {
    let Key { name, unit, .. } = key;
    let (allowed, absent) = ((key.allowed)(), (key.absent)());
    let absent = match &absent {
        Absent::Value(toml) => format!("`{toml}`"),
        Absent::Said(words) => (*words).to_string(),
        Absent::Refused => "an error".to_string(),
    };
    let meaning = key.meaning.trim().trim_end_matches('.');
    format!("| `{name}` | {unit} | {allowed} | {absent} | {meaning} |")
}

fn write_arms(text: &mut String) -> fmt::Result {
    write!(
        text,
        "\n## Arms that have a name\n\n\
         What `robot` of a scenario may be beside an arm file, and the points that its levels,\n\
         contacts and hands may name, beside `{TOOL_POINT}`.\n\n\
         | `robot` | points | ranges of the joints, base to flange, deg |\n|---|---|---|\n"
    )?;
    for arm in arms::ALL {
        let points = arm.points.iter().map(|point| format!("`{}`", point.name));
        let points: Vec<_> = points.collect();
        let ranges = EquippedArm::of(arm).ranges_deg();
        let ranges = ranges.map(|range| range.to_string());
        writeln!(
            text,
            "| `{}` | {} | {} |",
            arm.name,
            points.join(", "),
            ranges.join("; ")
        )?;
    }
    Ok(())
}
