//! Runs from files: sampled references, as docs/limits-study.md describes them.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use cell::invalid::Invalid;
use cell::names::Named;
use cell::ranges::{CYCLE_MS, LEVELS, Range};
use cell::reader;
use cell::scenario::{EquippedArm, Push};
use controller_core::joint::{DOF, JointVector, Vector3};
use controller_core::task::Tracked;
use controller_core::task::orientation::Quaternion;
use controller_core::{Axes, Target};
use flate2::read::GzDecoder;
use serde::Deserialize;

use super::case::{Case, CaseLevel, PLANT_SEED};
use super::set::Set;
use super::truth;
use crate::plant::PlantModel;

/// Most bytes of a file, of what is in it, and of a line.
const MOST_PACKED: u64 = 64 << 20;
const MOST_TEXT: u64 = 256 << 20;
const MOST_LINE: u64 = 64 << 10;

/// Most cycles of a run.
const MOST_CYCLES: usize = 100_000;

/// What a number in a row may be; the core has the last word.
const NUMBER: Range<f64> = Range::new(-1e6, 1e6);

/// Factor on K_q.
const FACTOR: Range<f64> = Range::above(0.0, 1e3);

/// How far a time may be from that of its cycle \[s\].
const TIME_SLACK_S: f64 = 1e-6;

/// The first line of a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    name: String,
    cycle_s: f64,
    start: [f64; DOF],
    levels: Vec<HeadLevel>,
    stiffness_factor: f64,
    posture: [f64; DOF],
    #[serde(default)]
    contacts: Vec<Push>,
    back_at_s: Option<f64>,
    /// What the run is called among its kind; not read.
    #[serde(rename = "kind")]
    _kind: Option<String>,
    /// Which level comes first; the list of levels says so.
    #[serde(rename = "first")]
    _first: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct HeadLevel {
    point: String,
    axes: String,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Position,
    Orientation,
}

impl Head {
    fn validate(&self, arm: &EquippedArm) -> Result<(), Invalid> {
        CYCLE_MS.check("cycle_s in ms", self.cycle_s * 1e3)?;
        FACTOR.check("stiffness_factor", self.stiffness_factor)?;
        for angle in self.start.iter().chain(&self.posture) {
            NUMBER.check("start", *angle)?;
        }
        if !LEVELS.contains(self.levels.len()) {
            let given = format!("{} levels", self.levels.len());
            return Err(Invalid::new("levels", given, LEVELS));
        }
        for (index, push) in self.contacts.iter().enumerate() {
            push.validate(arm)
                .map_err(|error| error.in_list("contacts", index))?;
        }
        Ok(())
    }
}

impl HeadLevel {
    fn level(&self, arm: &EquippedArm) -> Result<CaseLevel, Invalid> {
        let Some(axes) = Axes::from_name(&self.axes) else {
            let allowed = "letters of xyz in this order";
            return Err(Invalid::new("axes", &self.axes, allowed));
        };
        match self.kind {
            Kind::Position => CaseLevel::position(arm, &self.point, axes),
            Kind::Orientation if self.point == "flange" && axes == Axes::XYZ => {
                CaseLevel::orientation(arm)
            }
            Kind::Orientation => {
                let given = format!("orientation of {} about {}", self.point, self.axes);
                Err(Invalid::new(
                    "levels",
                    given,
                    "orientation of flange about xyz",
                ))
            }
        }
    }
}

/// The file of the run `number` (from 0) of a set in a folder.
#[must_use]
pub fn path(folder: &Path, set: Set, number: usize) -> PathBuf {
    folder.join(format!("{}-{number:03}.csv.gz", set.name()))
}

/// Number of runs of a set that a folder has files of, from the first on without a gap.
///
/// # Errors
/// No such folder, or no file of this set in it.
pub fn count(folder: &Path, set: Set) -> Result<usize, Invalid> {
    let count = (0..).take_while(|&number| path(folder, set, number).is_file());
    let count = count.count();
    if count == 0 {
        let allowed = format!("a folder with {}-000.csv.gz", set.name());
        return Err(Invalid::new("--from", folder.display(), allowed));
    }
    Ok(count)
}

/// Reads a run.
///
/// # Errors
/// Names file, line, value and what is allowed.
pub fn case(path: &Path, arm: &EquippedArm, set: Set, number: usize) -> Result<Case, Invalid> {
    let file = File::open(path).map_err(|error| {
        let allowed = format!("a readable file ({error})");
        Invalid::new("run", path.display(), allowed)
    })?;
    let text = GzDecoder::new(file.take(MOST_PACKED)).take(MOST_TEXT);
    let case = read(text, arm).map_err(|error| error.within(path.display()))?;
    Ok(Case {
        plant_seed: match set {
            Set::Random => number as u64,
            _ => PLANT_SEED,
        },
        ..case
    })
}

fn read(text: impl Read, arm: &EquippedArm) -> Result<Case, Invalid> {
    let mut lines = Lines {
        text: BufReader::new(text),
        number: 0,
        line: Vec::new(),
    };
    let Some(first) = lines.next()? else {
        return Err(Invalid::new("line 1", "nothing", "'# ' and JSON"));
    };
    let Some(json) = first.strip_prefix("# ") else {
        return Err(Invalid::new("line 1", first, "'# ' and JSON"));
    };
    let head: Head = reader::json(json, |head: &mut Head| head.validate(arm))?;
    let mut levels = Vec::new();
    for (index, level) in head.levels.iter().enumerate() {
        let place = |error: Invalid| error.in_list("levels", index).within("line 1");
        levels.push(level.level(arm).map_err(place)?);
    }
    let mut case = Case::at_rest(head.name.clone(), arm, head.start.into(), levels);
    case.cycle_s = head.cycle_s;
    case.posture = JointVector::from(head.posture);
    case.stiffness_factor = head.stiffness_factor;
    case.pushes = head.contacts;
    case.back_at_s = head.back_at_s;
    let model = PlantModel::new(&arm.parameters);
    let rest = |level: &CaseLevel| truth::rest(&model, &case.start, &level.task);
    let rests: Vec<_> = case.levels.iter().map(rest).collect();
    let mut cycles = 0;
    while let Some(row) = lines.next()? {
        let targets = row_targets(row, &case, &rests, cycles);
        let targets = targets.map_err(|error| error.within(format_args!("line {}", cycles + 2)))?;
        case.targets.extend(targets);
        cycles += 1;
        Range::new(1, MOST_CYCLES).check("rows", cycles)?;
    }
    Range::new(1, MOST_CYCLES).check("rows", cycles)?;
    Ok(case)
}

/// The targets of a row; on axes that a level does not control they are where it is at `rests`.
fn row_targets(
    row: &str,
    case: &Case,
    rests: &[Target<f64>],
    cycle: usize,
) -> Result<Vec<Target<f64>>, Invalid> {
    let turns = |level: &CaseLevel| matches!(level.task.tracked, Tracked::Orientation(_));
    let width = |level: &CaseLevel| if turns(level) { 10 } else { 9 };
    let wanted = 1 + case.levels.iter().map(width).sum::<usize>();
    let mut numbers = Vec::with_capacity(wanted);
    for (column, word) in row.split(',').enumerate() {
        let read: Option<f64> = word.trim().parse().ok();
        let number = read.filter(|number| NUMBER.contains(*number));
        numbers
            .push(number.ok_or_else(|| {
                Invalid::new(format_args!("column {}", column + 1), word, NUMBER)
            })?);
        if numbers.len() > wanted {
            break;
        }
    }
    if numbers.len() != wanted {
        let given = row.split(',').count();
        return Err(Invalid::new("columns", given, wanted));
    }
    let t_s = cycle as f64 * case.cycle_s;
    if (numbers[0] - t_s).abs() > TIME_SLACK_S {
        let allowed = format!("{t_s:.6}, the time of this cycle");
        return Err(Invalid::new("column 1", numbers[0], allowed));
    }
    let mut at = 1;
    let mut targets = Vec::with_capacity(case.levels.len());
    for (level, rest) in case.levels.iter().zip(rests) {
        let place = at;
        at += width(level);
        let vector = |from: usize| Vector3::from_column_slice(&numbers[from..from + 3]);
        targets.push(match rest {
            Target::Position { x, .. } => {
                let wanted = |from: usize, rest: &Vector3<f64>| {
                    let wanted = vector(from);
                    let controlled = |axis| level.task.axes.contains(axis);
                    Vector3::from_fn(|axis, _| match controlled(axis) {
                        true => wanted[axis],
                        false => rest[axis],
                    })
                };
                let still = Vector3::zeros();
                Target::Position {
                    x: wanted(place, x),
                    dx: wanted(place + 3, &still),
                    ddx: wanted(place + 6, &still),
                }
            }
            _ => Target::Orientation {
                q: Quaternion::from_column_slice(&numbers[place..place + 4]),
                w: vector(place + 4),
                dw: vector(place + 7),
            },
        });
    }
    Ok(targets)
}

/// Lines of a text that may be anything.
struct Lines<R> {
    text: BufReader<R>,
    number: usize,
    line: Vec<u8>,
}

impl<R: Read> Lines<R> {
    /// The next line without its end; none behind the last.
    fn next(&mut self) -> Result<Option<&str>, Invalid> {
        self.number += 1;
        self.line.clear();
        let place = format!("line {}", self.number);
        let mut text = self.text.by_ref().take(MOST_LINE);
        let read = text.read_until(b'\n', &mut self.line);
        read.map_err(|error| {
            let allowed = format!("gzip ({error})");
            Invalid::new(&place, "unreadable", allowed)
        })?;
        if self.line.len() as u64 == MOST_LINE {
            let allowed = format!("fewer than {MOST_LINE} bytes");
            return Err(Invalid::new(&place, "a longer one", allowed));
        }
        if self.line.is_empty() {
            return Ok(None);
        }
        let text = std::str::from_utf8(&self.line)
            .map_err(|_| Invalid::new(&place, "other bytes", "UTF-8"))?;
        Ok(Some(text.trim_end_matches(['\n', '\r'])))
    }
}
