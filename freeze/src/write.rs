//! A laid out function as text, in the language that is asked for.

use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt::Write as _;

use crate::explore::{Count, Value};
use crate::layout::{Body, Statement};
use crate::tape::{Condition, FlagId, NumberId, Operation, Tape};
use crate::trace::Search;

/// What differs between languages.
pub trait Language {
    /// A constant of the precision of the file.
    fn constant(&self, value: f64) -> String;
    /// What comes from outside or is left, by its place: `s.torque[3]`.
    fn place(&self, path: &str) -> String;
    /// Numbers of a block before they get their values, where the language wants that.
    fn declared(&self, names: &[String]) -> Vec<String>;
    /// A number of a block gets its value.
    fn number(&self, name: &str, value: &str) -> String;
    /// A new value of its own.
    fn kept(&self, name: &str, value: &str, kind: Kind) -> String;
    /// A function of the scalar.
    fn function(&self, name: Function, given: &[String]) -> String;
    /// One number or the other.
    fn choice(&self, condition: &str, yes: &str, no: &str) -> String;
    /// A value to be left by every path of a region.
    fn merged(&self, name: &str, value: Value) -> String;
    /// Head of an if, of its other side, and its end.
    fn branch(&self, condition: &str) -> String;
    /// A whole constant, true or false.
    fn truth(&self, truth: bool) -> &'static str;
    /// Sines and cosines of several angles; names of both are arrays.
    fn sines_cosines(&self, sines: &str, cosines: &str, angles: &[String]) -> Vec<String>;
    /// exp(-x) of several numbers, an array of that name.
    fn exponentials(&self, name: &str, given: &[String]) -> Vec<String>;
    /// A search, with an answer of that name.
    fn search(&self, name: &str, given: &[String]) -> Vec<String>;
    /// A bit of what a search told.
    fn found_bit(&self, name: &str, bit: u32) -> String;
    /// A flag as bit of a set.
    fn as_bit(&self, flag: &str, bit: u32) -> String;
}

/// What a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Number,
    Flag,
    Set,
}

/// A function of the scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    SquareRoot,
    Magnitude,
    WithSign,
    Most,
    Least,
}

/// A piece of a function as lines.
#[derive(Debug)]
pub struct Written {
    /// The stage that it is of.
    pub stage: &'static str,
    pub lines: Vec<String>,
}

/// A function as lines, and how much room it takes for what goes from piece to piece: numbers,
/// flags, counts.
#[derive(Debug)]
pub struct WrittenBody {
    pub pieces: Vec<Written>,
    pub room: [usize; 3],
}

/// What goes from one piece to others: a number, or a place of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Carried {
    Number(NumberId),
    Merged(u32, u32),
}

/// The statements of a function, and its numbers by their names.
struct Writer<'a, L: Language> {
    tape: &'a Tape,
    searches: &'a [Search],
    body: &'a Body,
    language: &'a L,
    /// Of the piece.
    names: HashMap<NumberId, String>,
    merged: HashSet<(u32, u32)>,
    piece: usize,
    /// Where what is carried comes from, and the last piece that it goes to.
    from: HashMap<Carried, usize>,
    carried: RefCell<BTreeMap<Carried, usize>>,
    slots: HashMap<Carried, String>,
    next: usize,
    lines: Vec<String>,
    /// Numbers of the block.
    declared: Vec<String>,
    indent: usize,
}

/// The statements of a body as lines, what is left included.
pub fn lines<L: Language>(
    tape: &Tape,
    searches: &[Search],
    body: &Body,
    language: &L,
) -> WrittenBody {
    let mut writer = Writer {
        tape,
        searches,
        body,
        language,
        names: HashMap::new(),
        merged: HashSet::new(),
        piece: 0,
        from: HashMap::new(),
        carried: RefCell::new(BTreeMap::new()),
        slots: HashMap::new(),
        next: 0,
        lines: vec![],
        declared: vec![],
        indent: 1,
    };
    // Once to see what is carried, once more to write it where it goes.
    let _ = writer.pieces();
    let room = writer.set_slots();
    let pieces = writer.pieces();
    WrittenBody { pieces, room }
}

fn merged_name(region: u32, place: u32) -> String {
    format!("g{region}_{place}")
}

/// The regions that statements leave something in.
fn regions_of(statements: &[Statement], regions: &mut HashSet<u32>) {
    for statement in statements {
        match statement {
            Statement::Leave { region, .. } => {
                regions.insert(*region);
            }
            Statement::If(_, yes, no) => {
                regions_of(yes, regions);
                regions_of(no, regions);
            }
            _ => {}
        }
    }
}

impl<L: Language> Writer<'_, L> {
    fn pieces(&mut self) -> Vec<Written> {
        self.next = 0;
        let mut written = vec![];
        let count = self.body.pieces.len().max(1);
        for piece in 0..count {
            self.piece = piece;
            self.names.clear();
            self.merged.clear();
            if let Some(own) = self.body.pieces.get(piece) {
                let mut regions = HashSet::new();
                regions_of(&own.statements, &mut regions);
                for (&(region, place), &value) in &self.body.merged {
                    if regions.contains(&region) {
                        self.merged.insert((region, place));
                        let carried = Carried::Merged(region, place);
                        self.from.insert(carried, piece);
                        if !self.slots.contains_key(&carried) {
                            let name = merged_name(region, place);
                            self.line(&self.language.merged(&name, value));
                        }
                    }
                }
                self.block(&own.statements);
            }
            if piece + 1 == count {
                self.leave(&self.body.left);
            }
            written.push(Written {
                stage: self.body.pieces.get(piece).map_or("", |piece| piece.stage),
                lines: std::mem::take(&mut self.lines),
            });
        }
        written
    }

    /// Gives everything that is carried a place, which others get behind its last use. How many
    /// places there are.
    fn set_slots(&mut self) -> [usize; 3] {
        let carried = std::mem::take(&mut *self.carried.borrow_mut());
        let mut by_start: Vec<(usize, Carried, usize)> = carried
            .into_iter()
            .map(|(carried, last)| (self.from[&carried], carried, last))
            .collect();
        by_start.sort_unstable();
        let mut ends: [Vec<usize>; 3] = Default::default();
        for (start, carried, last) in by_start {
            let kind = match carried {
                Carried::Number(_) => 0,
                Carried::Merged(region, place) => match self.body.merged[&(region, place)] {
                    Value::Number(_) => 0,
                    Value::Flag(_) => 1,
                    Value::Count(_) => 2,
                },
            };
            // A place is free for what starts behind its last use.
            let free = ends[kind].iter().position(|&end| end < start);
            let slot = free.unwrap_or_else(|| {
                ends[kind].push(0);
                ends[kind].len() - 1
            });
            ends[kind][slot] = last;
            let array = ["w.numbers", "w.flags", "w.counts"][kind];
            let slot = self.language.place(&format!("{array}[{slot}]"));
            self.slots.insert(carried, slot);
        }
        ends.map(|ends| ends.len())
    }

    /// The name of what another piece has made.
    fn carry(&self, carried: Carried) -> String {
        assert!(
            self.from.contains_key(&carried),
            "{carried:?} is used before it is known"
        );
        let mut all = self.carried.borrow_mut();
        let last = all.entry(carried).or_insert(self.piece);
        *last = self.piece.max(*last);
        self.slots.get(&carried).cloned().unwrap_or_default()
    }

    fn merged_place(&self, region: u32, place: u32) -> String {
        let carried = Carried::Merged(region, place);
        if !self.merged.contains(&(region, place)) {
            return self.carry(carried);
        }
        let slot = self.slots.get(&carried).cloned();
        slot.unwrap_or_else(|| merged_name(region, place))
    }

    /// A number of this piece has a name.
    fn known(&mut self, number: NumberId, name: &str) {
        self.names.insert(number, name.to_string());
        let carried = Carried::Number(number);
        // Within a region a number goes nowhere else.
        self.from.insert(carried, self.piece);
    }

    /// Puts a number where other pieces find it.
    fn put(&mut self, number: NumberId) {
        if let Some(slot) = self.slots.get(&Carried::Number(number)) {
            let text = format!("{slot} = {};", self.names[&number]);
            self.line(&text);
        }
    }

    fn line(&mut self, text: &str) {
        self.lines
            .push(format!("{}{text}", "    ".repeat(self.indent)));
    }

    fn name(&mut self, number: NumberId) -> String {
        self.next += 1;
        let name = format!("v{}", self.next);
        self.known(number, &name);
        name
    }

    fn number(&self, number: NumberId) -> String {
        match self.tape.numbers[number as usize] {
            Operation::Constant(bits) => self.language.constant(f64::from_bits(bits)),
            Operation::Input(name) => self.language.place(&self.tape.names[name as usize]),
            Operation::Merged { region, place } => self.merged_place(region, place),
            Operation::Found { search, place } => format!("found{search}.acceleration[{place}]"),
            _ => match self.names.get(&number) {
                Some(name) => name.clone(),
                None => self.carry(Carried::Number(number)),
            },
        }
    }

    fn flag(&self, flag: FlagId) -> String {
        let compared = |a, sign: &str, b| format!("{} {sign} {}", self.number(a), self.number(b));
        match self.tape.flags[flag as usize] {
            Condition::Constant(truth) => self.language.truth(truth).to_string(),
            Condition::Input(name) => self.language.place(&self.tape.names[name as usize]),
            Condition::Below(a, b) => compared(a, "<", b),
            Condition::AtMost(a, b) => compared(a, "<=", b),
            Condition::Equal(a, b) => compared(a, "==", b),
            Condition::Not(inner) => match self.tape.flags[inner as usize] {
                Condition::Equal(a, b) => compared(a, "!=", b),
                _ => format!("!({})", self.flag(inner)),
            },
            Condition::And(a, b) => format!("({}) && ({})", self.flag(a), self.flag(b)),
            Condition::Or(a, b) => format!("({}) || ({})", self.flag(a), self.flag(b)),
            Condition::Merged { region, place } => self.merged_place(region, place),
            Condition::Found { search, place } => {
                self.language.found_bit(&format!("found{search}"), place)
            }
        }
    }

    fn value(&self, value: Value) -> String {
        match value {
            Value::Number(number) => self.number(number),
            Value::Flag(flag) => self.flag(flag),
            Value::Count(Count::Constant(count)) => count.to_string(),
            Value::Count(Count::Pivots(search)) => format!("found{search}.pivots"),
            Value::Count(Count::Merged { region, place }) => self.merged_place(region, place),
        }
    }

    fn operation(&self, number: NumberId) -> String {
        let of = |number| self.number(number);
        let function = |function, given: &[NumberId]| {
            let given: Vec<String> = given.iter().map(|&number| of(number)).collect();
            self.language.function(function, &given)
        };
        match self.tape.numbers[number as usize] {
            Operation::Add(a, b) => format!("{} + {}", of(a), of(b)),
            Operation::Subtract(a, b) => format!("{} - {}", of(a), of(b)),
            Operation::Multiply(a, b) => format!("{} * {}", of(a), of(b)),
            Operation::Divide(a, b) => format!("{} / {}", of(a), of(b)),
            Operation::Negate(a) => format!("-{}", of(a)),
            Operation::SquareRoot(a) => function(Function::SquareRoot, &[a]),
            Operation::Magnitude(a) => function(Function::Magnitude, &[a]),
            Operation::WithSign(a, b) => function(Function::WithSign, &[a, b]),
            Operation::Most(a, b) => function(Function::Most, &[a, b]),
            Operation::Least(a, b) => function(Function::Least, &[a, b]),
            Operation::Choose([a, b, yes, no]) => {
                let condition = format!("{} < {}", of(a), of(b));
                self.language.choice(&condition, &of(yes), &of(no))
            }
            operation => unreachable!("{operation:?} is no statement of its own"),
        }
    }

    fn block(&mut self, statements: &[Statement]) {
        let (start, outer) = (self.lines.len(), std::mem::take(&mut self.declared));
        self.statements(statements);
        let own = std::mem::replace(&mut self.declared, outer);
        let indent = "    ".repeat(self.indent);
        let declared = self.language.declared(&own).into_iter();
        let declared = declared.map(|line| format!("{indent}{line}"));
        self.lines.splice(start..start, declared);
    }

    fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Number(number) => {
                    let value = self.operation(*number);
                    let name = self.name(*number);
                    self.declared.push(name.clone());
                    let text = self.language.number(&name, &value);
                    self.line(&text);
                    self.put(*number);
                }
                Statement::SinesCosines(angles) => {
                    self.next += 1;
                    let (sines, cosines) = (
                        format!("sines{}", self.next),
                        format!("cosines{}", self.next),
                    );
                    let given: Vec<String> =
                        angles.iter().map(|&angle| self.number(angle)).collect();
                    for text in self.language.sines_cosines(&sines, &cosines, &given) {
                        self.line(&text);
                    }
                    self.name_entries(angles, Operation::Sine, &sines);
                    self.name_entries(angles, Operation::Cosine, &cosines);
                }
                Statement::Exponentials(of) => {
                    self.next += 1;
                    let name = format!("decays{}", self.next);
                    let given: Vec<String> = of.iter().map(|&of| self.number(of)).collect();
                    for text in self.language.exponentials(&name, &given) {
                        self.line(&text);
                    }
                    self.name_entries(of, Operation::ExpNegative, &name);
                }
                Statement::Search(search) => {
                    let given: Vec<String> = self.searches[*search as usize]
                        .given
                        .iter()
                        .map(|&number| self.number(number))
                        .collect();
                    for text in self.language.search(&format!("found{search}"), &given) {
                        self.line(&text);
                    }
                }
                Statement::Leave {
                    region,
                    place,
                    value,
                } => {
                    let to = self.merged_place(*region, *place);
                    let text = format!("{to} = {};", self.value(*value));
                    self.line(&text);
                }
                Statement::If(flag, yes, no) => {
                    let condition = self.flag(*flag);
                    let head = self.language.branch(&condition);
                    self.line(&head);
                    self.indent += 1;
                    self.block(yes);
                    self.indent -= 1;
                    self.line("} else {");
                    self.indent += 1;
                    self.block(no);
                    self.indent -= 1;
                    self.line("}");
                }
            }
        }
    }

    fn name_entries(
        &mut self,
        of: &[NumberId],
        operation: impl Fn(NumberId) -> Operation,
        array: &str,
    ) {
        for (index, &of) in of.iter().enumerate() {
            if let Some(number) = self.tape.known(operation(of)) {
                self.known(number, &format!("{array}[{index}]"));
                self.put(number);
            }
        }
    }

    /// What is left: places with a colon are bits of a set, written at once. What depends on places
    /// that are written here is read before.
    fn leave(&mut self, left: &[(String, Value)]) {
        let mut sets: Vec<(String, String)> = vec![];
        let mut whole: Vec<(String, String)> = vec![];
        for (to, value) in left {
            let text = self.value(*value);
            if let Some((set, bit)) = to.split_once(':') {
                if matches!(value, Value::Flag(flag)
                    if self.tape.flags[*flag as usize] == Condition::Constant(false))
                {
                    continue;
                }
                let bit = self.language.as_bit(&text, bit.parse().expect("a bit"));
                match sets.iter_mut().find(|(known, _)| known == set) {
                    Some((_, bits)) => {
                        let _ = write!(bits, " | {bit}");
                    }
                    None => sets.push((set.to_string(), bit)),
                }
                continue;
            }
            let is_computed = matches!(value, Value::Number(number)
                if self.names.contains_key(number) || self.tape.constant_of(*number).is_some());
            let text = match value {
                _ if is_computed => text,
                Value::Number(_) => self.kept(&text, Kind::Number),
                Value::Flag(_) => self.kept(&text, Kind::Flag),
                Value::Count(_) => text,
            };
            whole.push((to.clone(), text));
        }
        for (set, bits) in sets {
            let text = self.kept(&bits, Kind::Set);
            whole.push((set, text));
        }
        for (to, text) in whole {
            let to = self.language.place(&to);
            self.line(&format!("{to} = {text};"));
        }
    }

    /// A value under a name of its own.
    fn kept(&mut self, value: &str, kind: Kind) -> String {
        self.next += 1;
        let name = format!("k{}", self.next);
        let text = self.language.kept(&name, value, kind);
        self.line(&text);
        name
    }
}
