//! Where what was recorded is computed: every number once, in the innermost block that all its
//! uses are in, and nothing that is not used.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use crate::explore::{Count, Paths, Value};
use crate::tape::{Condition, FlagId, NumberId, Operation, Tape};
use crate::trace::{Function, Search};

/// A statement.
#[derive(Debug)]
pub enum Statement {
    /// A number gets its value.
    Number(NumberId),
    /// Sine and cosine of several numbers, at once.
    SinesCosines(Vec<NumberId>),
    /// exp(-x) of several numbers, at once.
    Exponentials(Vec<NumberId>),
    /// A search runs.
    Search(u32),
    /// What a path leaves in a place of its region.
    Leave {
        region: u32,
        place: u32,
        value: Value,
    },
    /// One block or the other.
    If(FlagId, Vec<Statement>, Vec<Statement>),
}

/// A piece of a function, behind a call: in a long one most numbers would be put aside on a stack
/// that is too large for the reach of an instruction.
#[derive(Debug, Default)]
pub struct Piece {
    /// The stage that it is of.
    pub stage: &'static str,
    pub statements: Vec<Statement>,
    /// How many operations it has outside of regions.
    operations: usize,
}

/// A function as it is written.
#[derive(Debug, Default)]
pub struct Body {
    pub pieces: Vec<Piece>,
    /// Places of regions that are used, with what kind of value they hold.
    pub merged: BTreeMap<(u32, u32), Value>,
    /// What is left at the end, without what stays as it is.
    pub left: Vec<(String, Value)>,
    /// Names from outside that are read.
    pub read: HashSet<String>,
    /// How many operations there are.
    pub operations: usize,
}

/// What a value is read for.
fn of_flag(tape: &Tape, flag: FlagId, numbers: &mut Vec<NumberId>, flags: &mut Vec<FlagId>) {
    match tape.flags[flag as usize] {
        Condition::Below(a, b) | Condition::AtMost(a, b) | Condition::Equal(a, b) => {
            numbers.extend([a, b]);
        }
        Condition::Not(a) => of_flag(tape, a, numbers, flags),
        Condition::And(a, b) | Condition::Or(a, b) => {
            of_flag(tape, a, numbers, flags);
            of_flag(tape, b, numbers, flags);
        }
        Condition::Constant(_) => {}
        Condition::Input(_) | Condition::Merged { .. } | Condition::Found { .. } => {
            flags.push(flag);
        }
    }
}

/// Blocks as a tree: each knows its parent and its depth.
#[derive(Default)]
struct Blocks {
    parents: Vec<usize>,
    depths: Vec<usize>,
}

impl Blocks {
    fn add(&mut self, parent: usize) -> usize {
        self.parents.push(parent);
        let depth = self.depths.get(parent).map_or(0, |depth| depth + 1);
        self.depths.push(depth);
        self.parents.len() - 1
    }

    /// The innermost block that both are in.
    fn common(&self, mut a: usize, mut b: usize) -> usize {
        while a != b {
            if self.depths[a] >= self.depths[b] {
                a = self.parents[a];
            } else {
                b = self.parents[b];
            }
        }
        a
    }
}

const ROOT: usize = 0;

/// A region with the blocks of its paths.
enum Shape<'a> {
    End(usize, &'a crate::explore::Left),
    Split(FlagId, Box<Shape<'a>>, Box<Shape<'a>>, usize),
}

impl<'a> Shape<'a> {
    fn new(paths: &'a Paths, block: usize, blocks: &mut Blocks) -> Self {
        match paths {
            Paths::End(left) => Self::End(block, left),
            Paths::Split(flag, yes, no) => {
                let inner = [blocks.add(block), blocks.add(block)];
                Self::Split(
                    *flag,
                    Box::new(Self::new(yes, inner[0], blocks)),
                    Box::new(Self::new(no, inner[1], blocks)),
                    block,
                )
            }
        }
    }
}

struct Layout<'a> {
    tape: &'a Tape,
    searches: &'a [Search],
    blocks: Blocks,
    shapes: Vec<(u32, NumberId, Shape<'a>)>,
    stages: &'a [(NumberId, &'static str)],
    longest: usize,
    merged: BTreeMap<(u32, u32), Value>,
    /// Uses of numbers by blocks.
    uses: BTreeMap<NumberId, usize>,
    read: HashSet<String>,
}

/// The body of a function, in pieces of `longest` operations at most; of what is left only that
/// whose place is `wanted`.
pub fn lay_out(
    tape: &Tape,
    searches: &[Search],
    function: &Function,
    longest: usize,
    wanted: &dyn Fn(&str) -> bool,
) -> Body {
    let mut blocks = Blocks::default();
    blocks.add(ROOT);
    let shapes = function
        .regions
        .iter()
        .map(|region| {
            let shape = Shape::new(&region.paths, ROOT, &mut blocks);
            (region.number, region.recorded, shape)
        })
        .collect();
    let mut layout = Layout {
        tape,
        searches,
        blocks,
        shapes,
        stages: &function.stages,
        longest,
        merged: BTreeMap::new(),
        uses: BTreeMap::new(),
        read: HashSet::new(),
    };
    let left: Vec<(String, Value)> = function
        .left
        .iter()
        .filter(|(to, value)| wanted(to) && !layout.stays(to, *value))
        .cloned()
        .collect();
    for (_, value) in &left {
        layout.used(*value, ROOT);
    }
    layout.place();
    layout.write(left)
}

impl Layout<'_> {
    /// Whether a value is what its place had before.
    fn stays(&self, to: &str, value: Value) -> bool {
        let input = match value {
            Value::Number(number) => match self.tape.numbers[number as usize] {
                Operation::Input(name) => name,
                _ => return false,
            },
            Value::Flag(flag) => match self.tape.flags[flag as usize] {
                Condition::Input(name) => name,
                _ => return false,
            },
            Value::Count(_) => return false,
        };
        self.tape.names[input as usize] == to
    }

    fn used(&mut self, value: Value, block: usize) {
        match value {
            Value::Number(number) => self.number_used(number, block),
            Value::Flag(flag) => self.flag_used(flag, block),
            Value::Count(Count::Pivots(search)) => self.search_used(search, block),
            Value::Count(Count::Merged { region, place }) => {
                self.merge_used(region, place, value);
            }
            Value::Count(Count::Constant(_)) => {}
        }
    }

    fn number_used(&mut self, number: NumberId, block: usize) {
        if let Operation::Merged { region, place } = self.tape.numbers[number as usize] {
            self.merge_used(region, place, Value::Number(number));
        }
        let blocks = &self.blocks;
        self.uses
            .entry(number)
            .and_modify(|known| *known = blocks.common(*known, block))
            .or_insert(block);
    }

    fn flag_used(&mut self, flag: FlagId, block: usize) {
        let (mut numbers, mut flags) = (vec![], vec![]);
        of_flag(self.tape, flag, &mut numbers, &mut flags);
        for number in numbers {
            self.number_used(number, block);
        }
        for flag in flags {
            match self.tape.flags[flag as usize] {
                Condition::Merged { region, place } => {
                    self.merge_used(region, place, Value::Flag(flag));
                }
                Condition::Found { search, .. } => self.search_used(search, block),
                Condition::Input(name) => {
                    self.read.insert(self.tape.names[name as usize].clone());
                }
                _ => {}
            }
        }
    }

    fn search_used(&mut self, search: u32, block: usize) {
        for &given in &self.searches[search as usize].given.clone() {
            self.number_used(given, block);
        }
    }

    /// A place of a region is used: its paths leave something there, and it is decided which.
    fn merge_used(&mut self, region: u32, place: u32, value: Value) {
        if self.merged.insert((region, place), value).is_some() {
            return;
        }
        let index = self
            .shapes
            .iter()
            .position(|(number, ..)| *number == region)
            .expect("a region of this function");
        let mut used = vec![];
        collect(&self.shapes[index].2, value, place, &mut used);
        for (value, block) in used {
            self.used(value, block);
        }
    }

    /// From the last number to the first: where each is computed, whose operands are used there.
    fn place(&mut self) {
        let mut last = NumberId::MAX;
        while let Some((&number, &block)) = self.uses.range(..last).next_back() {
            last = number;
            match self.tape.numbers[number as usize] {
                Operation::Input(name) => {
                    self.read.insert(self.tape.names[name as usize].clone());
                }
                Operation::Found { search, .. } => self.search_used(search, block),
                operation => {
                    for operand in operation.operands() {
                        self.number_used(operand, block);
                    }
                }
            }
        }
    }

    fn is_computed(&self, number: NumberId) -> bool {
        !matches!(
            self.tape.numbers[number as usize],
            Operation::Constant(_) | Operation::Input(_) | Operation::Merged { .. }
        )
    }

    fn write(self, left: Vec<(String, Value)>) -> Body {
        let mut of_block: HashMap<usize, Vec<NumberId>> = HashMap::new();
        for (&number, &block) in &self.uses {
            if self.is_computed(number) {
                of_block.entry(block).or_default().push(number);
            }
        }
        let operations = of_block.values().map(Vec::len).sum();
        let mut pieces: Vec<Piece> = vec![];
        let root = of_block.remove(&ROOT).unwrap_or_default();
        let mut rest = root.as_slice();
        for (region, recorded, shape) in &self.shapes {
            if !self.merged.keys().any(|(known, _)| known == region) {
                continue;
            }
            let own = rest.partition_point(|number| number < recorded);
            self.pieces_of(&rest[..own], &mut pieces);
            rest = &rest[own..];
            let places: BTreeSet<u32> = self
                .merged
                .keys()
                .filter(|(known, _)| known == region)
                .map(|(_, place)| *place)
                .collect();
            let mut statements = vec![];
            self.paths(shape, *region, &places, &of_block, &mut statements);
            if let (usize::MAX, Some(piece)) = (self.longest, pieces.last_mut()) {
                piece.statements.extend(statements);
                continue;
            }
            // By itself: what is seldom done would take registers and room from the rest.
            pieces.push(Piece {
                stage: self.stage_of(recorded - 1),
                statements,
                operations: self.longest,
            });
        }
        self.pieces_of(rest, &mut pieces);
        Body {
            pieces,
            merged: self.merged,
            left,
            read: self.read,
            operations,
        }
    }

    fn stage_of(&self, number: NumberId) -> &'static str {
        let stage = self.stages.iter().find(|(end, _)| number < *end);
        stage.or(self.stages.last()).map_or("", |(_, name)| *name)
    }

    /// Numbers outside of regions, stage by stage; stages that are long in several pieces.
    fn pieces_of(&self, mut numbers: &[NumberId], pieces: &mut Vec<Piece>) {
        while let Some(&first) = numbers.first() {
            let stage = self.stage_of(first);
            let own = numbers.partition_point(|&number| self.stage_of(number) == stage);
            let (of_stage, rest) = numbers.split_at(own);
            let parts = of_stage.len().div_ceil(self.longest).max(1);
            for part in of_stage.chunks(of_stage.len().div_ceil(parts)) {
                let longest = self.longest;
                let fits = |piece: &Piece| {
                    longest == usize::MAX || part.len() <= longest.saturating_sub(piece.operations)
                };
                if !pieces.last().is_some_and(fits) {
                    pieces.push(Piece {
                        stage,
                        ..Piece::default()
                    });
                }
                if let Some(piece) = pieces.last_mut() {
                    self.straight(part, &mut piece.statements);
                    piece.operations = piece.operations.saturating_add(part.len());
                }
            }
            numbers = rest;
        }
    }

    /// Made from what comes from outside by one operation at most.
    fn is_simple(&self, number: NumberId) -> bool {
        let given = |number: &NumberId| {
            matches!(
                self.tape.numbers[*number as usize],
                Operation::Constant(_) | Operation::Input(_)
            )
        };
        given(&number)
            || self.tape.numbers[number as usize]
                .operands()
                .iter()
                .all(given)
    }

    /// Numbers in the order in which they were recorded; elementary functions of what comes from
    /// outside at once.
    fn straight(&self, numbers: &[NumberId], to: &mut Vec<Statement>) {
        let mut written: HashSet<NumberId> = HashSet::new();
        let mut searches = HashSet::new();
        let angle = |number: NumberId| match self.tape.numbers[number as usize] {
            Operation::Sine(of) | Operation::Cosine(of) => Some(of),
            _ => None,
        };
        let decay = |number: NumberId| match self.tape.numbers[number as usize] {
            Operation::ExpNegative(of) => Some(of),
            _ => None,
        };
        for &number in numbers {
            if written.contains(&number) {
                continue;
            }
            if let Operation::Found { search, .. } = self.tape.numbers[number as usize] {
                if searches.insert(search) {
                    to.push(Statement::Search(search));
                }
                continue;
            }
            if let Some(own) = angle(number) {
                let angles = self.at_once(own, &angle, numbers, &mut written, to);
                to.push(Statement::SinesCosines(angles));
                continue;
            }
            if let Some(own) = decay(number) {
                let given = self.at_once(own, &decay, numbers, &mut written, to);
                to.push(Statement::Exponentials(given));
                continue;
            }
            written.insert(number);
            to.push(Statement::Number(number));
        }
    }

    /// Of what an elementary function is to be taken together with `own`: of all numbers that it is
    /// taken of (`given`) and that are known before. They and the results count as written.
    fn at_once(
        &self,
        own: NumberId,
        given: &dyn Fn(NumberId) -> Option<NumberId>,
        numbers: &[NumberId],
        written: &mut HashSet<NumberId>,
        to: &mut Vec<Statement>,
    ) -> Vec<NumberId> {
        let mut all = vec![own];
        if self.is_simple(own) {
            for other in numbers.iter().filter_map(|&number| given(number)) {
                if self.is_simple(other) && !all.contains(&other) {
                    all.push(other);
                }
            }
        }
        for &of in &all {
            if numbers.binary_search(&of).is_ok() && written.insert(of) {
                to.push(Statement::Number(of));
            }
        }
        let results = numbers.iter().copied();
        written.extend(results.filter(|&number| given(number).is_some_and(|of| all.contains(&of))));
        all
    }

    fn paths(
        &self,
        shape: &Shape<'_>,
        region: u32,
        places: &BTreeSet<u32>,
        of_block: &HashMap<usize, Vec<NumberId>>,
        to: &mut Vec<Statement>,
    ) {
        match shape {
            Shape::End(block, left) => {
                if *block != ROOT {
                    self.straight(of_block.get(block).map_or(&[], Vec::as_slice), to);
                }
                for &place in places {
                    let value = left.at(self.merged[&(region, place)], place);
                    to.push(Statement::Leave {
                        region,
                        place,
                        value,
                    });
                }
            }
            Shape::Split(flag, yes, no, block) => {
                if *block != ROOT {
                    self.straight(of_block.get(block).map_or(&[], Vec::as_slice), to);
                }
                let (mut of_yes, mut of_no) = (vec![], vec![]);
                self.paths(yes, region, places, of_block, &mut of_yes);
                self.paths(no, region, places, of_block, &mut of_no);
                to.push(Statement::If(*flag, of_yes, of_no));
            }
        }
    }
}

fn collect(shape: &Shape<'_>, merged: Value, place: u32, used: &mut Vec<(Value, usize)>) {
    match shape {
        Shape::End(block, left) => used.push((left.at(merged, place), *block)),
        Shape::Split(flag, yes, no, block) => {
            used.push((Value::Flag(*flag), *block));
            collect(yes, merged, place, used);
            collect(no, merged, place, used);
        }
    }
}
