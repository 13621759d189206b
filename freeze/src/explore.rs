//! Parts of a cycle whose path depends on data: every path is run, and what they leave is merged.
//!
//! A part is run again and again from the same start, each time with other decisions. A decision
//! that only changes flags which the part tells is no path of its own: the flag becomes what was
//! decided. Any other one splits the part in two.

use controller_core::cells::Cells;

use crate::scalar::Recorded;
use crate::tape::{Condition, Decision, FlagId, NumberId, Operation, with};

/// A small number that a part leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// The same on this path whatever the data.
    Constant(u8),
    /// The pivots of a search.
    Pivots(u32),
    /// What the paths of a region leave in one place.
    Merged { region: u32, place: u32 },
}

/// What is left in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    Number(NumberId),
    Flag(FlagId),
    Count(Count),
}

/// What is left at the end of a path, in the order of a visit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Left {
    pub numbers: Vec<NumberId>,
    pub flags: Vec<FlagId>,
    pub counts: Vec<Count>,
}

impl Left {
    /// What is left in a place of a region, of the kind of `merged`.
    pub fn at(&self, merged: Value, place: u32) -> Value {
        match merged {
            Value::Number(_) => Value::Number(self.numbers[place as usize]),
            Value::Flag(_) => Value::Flag(self.flags[(place - FLAG_PLACES) as usize]),
            Value::Count(_) => Value::Count(self.counts[(place - COUNT_PLACES) as usize]),
        }
    }
}

/// Places of numbers, flags and counts of a region are apart.
const FLAG_PLACES: u32 = 1_000;
const COUNT_PLACES: u32 = 2_000;

/// The paths of a part.
#[derive(Clone, Debug, PartialEq)]
pub enum Paths {
    End(Left),
    Split(FlagId, Box<Paths>, Box<Paths>),
}

impl Paths {
    /// What is left on every path.
    pub fn ends(&self) -> Vec<&Left> {
        match self {
            Self::End(left) => vec![left],
            Self::Split(_, yes, no) => [yes.ends(), no.ends()].concat(),
        }
    }

    /// What is left on the nominal one.
    fn nominal(&self) -> &Left {
        match self {
            Self::End(left) => left,
            Self::Split(flag, yes, no) => {
                let truth = with(|tape| tape.truths[*flag as usize]);
                if truth { yes } else { no }.nominal()
            }
        }
    }

    /// Split by a flag; paths that leave the same are one.
    fn split(flag: FlagId, yes: Self, no: Self) -> Self {
        if yes == no {
            return yes;
        }
        if let Self::Split(other, same, rest) = &no
            && **same == yes
        {
            let either = with(|tape| tape.or(flag, *other));
            return Self::split(either, yes, (**rest).clone());
        }
        if let Self::Split(other, rest, same) = &no
            && **same == yes
        {
            let either = with(|tape| {
                let other = tape.not(*other);
                tape.or(flag, other)
            });
            return Self::split(either, yes, (**rest).clone());
        }
        if let Self::Split(other, rest, same) = &yes
            && **same == no
        {
            let both = with(|tape| tape.and(flag, *other));
            return Self::split(both, (**rest).clone(), no);
        }
        if let Self::Split(other, same, rest) = &yes
            && **same == no
        {
            let both = with(|tape| {
                let other = tape.not(*other);
                tape.and(flag, other)
            });
            return Self::split(both, (**rest).clone(), no);
        }
        Self::Split(flag, Box::new(yes), Box::new(no))
    }
}

/// One run: the decisions it made and what it left, flags as they were on its path.
struct Run {
    made: Vec<Decision>,
    numbers: Vec<NumberId>,
    flags: Vec<bool>,
    counts: Vec<Count>,
}

/// What a run leaves.
#[derive(Default)]
pub struct Outcome {
    pub numbers: Vec<NumberId>,
    pub flags: Vec<bool>,
    pub counts: Vec<Count>,
}

impl Cells<Recorded> for Outcome {
    fn numbers(&mut self, _: &'static str, values: &mut [Recorded]) {
        self.numbers.extend(values.iter().map(|value| value.0));
    }
    fn flag(&mut self, _: &'static str, value: &mut bool) {
        self.flags.push(*value);
    }
    fn set(&mut self, _: &'static str, bits: &mut u8) {
        self.flags.extend((0..8).map(|bit| *bits >> bit & 1 != 0));
    }
    fn count(&mut self, _: &'static str, value: &mut u8) {
        self.counts.push(Count::Constant(*value));
    }
}

fn run(work: &mut dyn FnMut() -> Outcome, given: &[Decision]) -> Run {
    with(|tape| tape.begin_path(Some(given)));
    let Outcome {
        numbers,
        flags,
        counts,
    } = work();
    let made = with(|tape| tape.end_path());
    Run {
        made,
        numbers,
        flags,
        counts,
    }
}

/// All paths of a part.
pub fn explore(work: &mut dyn FnMut() -> Outcome) -> Paths {
    explore_from(work, &[])
}

fn explore_from(work: &mut dyn FnMut() -> Outcome, given: &[Decision]) -> Paths {
    let base = run(work, given);
    let free: Vec<Decision> = base
        .made
        .iter()
        .copied()
        .filter(|(flag, _)| !given.iter().any(|(known, _)| known == flag))
        .collect();
    let order = |run: &Run| run.made.iter().map(|(flag, _)| *flag).collect::<Vec<_>>();
    // Of each flag the decisions that change it.
    let mut changed_by: Vec<Vec<Decision>> = vec![vec![]; base.flags.len()];
    for &(flag, decided) in &free {
        let mut others = given.to_vec();
        others.push((flag, !decided));
        let other = run(work, &others);
        let same_path = order(&other) == order(&base)
            && other.numbers == base.numbers
            && other.counts == base.counts;
        if !same_path {
            return split_by(work, given, flag);
        }
        for (place, changes) in changed_by.iter_mut().enumerate() {
            if other.flags[place] != base.flags[place] {
                changes.push((flag, decided));
            }
        }
    }
    if !change_alone(work, given, &free, &base, &changed_by)
        && let Some((flag, _)) = changed_by.iter().flatten().next()
    {
        return split_by(work, given, *flag);
    }
    let flags = base.flags.iter().zip(&changed_by);
    Paths::End(Left {
        numbers: base.numbers,
        flags: flags
            .map(|(&usual, changes)| told(usual, changes))
            .collect(),
        counts: base.counts,
    })
}

fn split_by(work: &mut dyn FnMut() -> Outcome, given: &[Decision], flag: FlagId) -> Paths {
    let with_flag = |truth| [given, &[(flag, truth)]].concat();
    let yes = explore_from(work, &with_flag(true));
    let no = explore_from(work, &with_flag(false));
    Paths::split(flag, yes, no)
}

/// A flag that is as usual unless one of the decisions is otherwise.
fn told(usual: bool, changes: &[Decision]) -> FlagId {
    with(|tape| {
        let mut flag = tape.constant_flag(usual);
        for &(decision, decided) in changes {
            let as_decided = if decided {
                decision
            } else {
                tape.not(decision)
            };
            flag = if usual {
                tape.and(flag, as_decided)
            } else {
                let otherwise = tape.not(as_decided);
                tape.or(flag, otherwise)
            };
        }
        flag
    })
}

/// Whether decisions change flags each for itself, tried on many combinations.
fn change_alone(
    work: &mut dyn FnMut() -> Outcome,
    given: &[Decision],
    free: &[Decision],
    base: &Run,
    changed_by: &[Vec<Decision>],
) -> bool {
    if free.is_empty() {
        return true;
    }
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..12).all(|_| {
        let mut others = given.to_vec();
        let mut turned = vec![];
        for &(flag, decided) in free {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let turns = state & 1 == 1;
            others.push((flag, decided != turns));
            if turns {
                turned.push(flag);
            }
        }
        let other = run(work, &others);
        let as_told = changed_by.iter().enumerate().all(|(place, changes)| {
            let otherwise = changes.iter().any(|(flag, _)| turned.contains(flag));
            other.flags[place] == (base.flags[place] != otherwise)
        });
        other.numbers == base.numbers && as_told
    })
}

/// Numbers, flags and counts behind a part: where its paths differ, what they leave merged.
pub fn merged(region: u32, paths: &Paths) -> Left {
    let ends = paths.ends();
    let nominal = paths.nominal().clone();
    let mut left = nominal.clone();
    for (place, number) in left.numbers.iter_mut().enumerate() {
        if ends.iter().any(|end| end.numbers[place] != *number) {
            let place = place as u32;
            *number = with(|tape| {
                let value = tape.values[*number as usize];
                tape.number(Operation::Merged { region, place }, value)
            });
        }
    }
    for (place, flag) in left.flags.iter_mut().enumerate() {
        if ends.iter().any(|end| end.flags[place] != *flag) {
            let place = FLAG_PLACES + place as u32;
            *flag = with(|tape| {
                let truth = tape.truths[*flag as usize];
                tape.flag(Condition::Merged { region, place }, truth)
            });
        }
    }
    for (place, count) in left.counts.iter_mut().enumerate() {
        if ends.iter().any(|end| end.counts[place] != *count) {
            *count = Count::Merged {
                region,
                place: COUNT_PLACES + place as u32,
            };
        }
    }
    left
}
