//! What was recorded: numbers and flags as they follow from each other, every one once.
//!
//! A number is an operation on earlier numbers, a flag a comparison of numbers or a combination of
//! flags. Both carry the value that they have at a nominal input, which says which way is the usual
//! one where a path depends on data.

use std::cell::RefCell;
use std::collections::HashMap;

use controller_core::real::Real;

/// Floating-point numbers of a frozen cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Single.
    F32,
    /// Double.
    F64,
}

impl Precision {
    /// Of a number that an operation of this precision gives exactly or rounded once: a sum, a
    /// product, a quotient and a root of numbers of single precision are rounded twice without harm.
    fn rounded(self, value: f64) -> f64 {
        match self {
            Self::F32 => f64::from(value as f32),
            Self::F64 => value,
        }
    }
}

/// A recorded number.
pub type NumberId = u32;

/// A recorded flag.
pub type FlagId = u32;

/// What a number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// By its bits in double precision.
    Constant(u64),
    /// From outside, by the number of its name.
    Input(u32),
    Add(NumberId, NumberId),
    Subtract(NumberId, NumberId),
    Multiply(NumberId, NumberId),
    Divide(NumberId, NumberId),
    Negate(NumberId),
    SquareRoot(NumberId),
    Sine(NumberId),
    Cosine(NumberId),
    ExpNegative(NumberId),
    Magnitude(NumberId),
    /// The magnitude of the first with the sign of the second.
    WithSign(NumberId, NumberId),
    Most(NumberId, NumberId),
    Least(NumberId, NumberId),
    /// The third where the first is below the second, else the fourth.
    Choose([NumberId; 4]),
    /// What the paths of a region leave in one place.
    Merged {
        region: u32,
        place: u32,
    },
    /// An answer of a search.
    Found {
        search: u32,
        place: u32,
    },
}

impl Operation {
    /// The numbers that it is made from.
    pub fn operands(self) -> Vec<NumberId> {
        match self {
            Self::Constant(_) | Self::Input(_) | Self::Merged { .. } | Self::Found { .. } => vec![],
            Self::Negate(a)
            | Self::SquareRoot(a)
            | Self::Sine(a)
            | Self::Cosine(a)
            | Self::ExpNegative(a)
            | Self::Magnitude(a) => vec![a],
            Self::Add(a, b)
            | Self::Subtract(a, b)
            | Self::Multiply(a, b)
            | Self::Divide(a, b)
            | Self::WithSign(a, b)
            | Self::Most(a, b)
            | Self::Least(a, b) => vec![a, b],
            Self::Choose(of) => of.to_vec(),
        }
    }
}

/// What a flag is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Condition {
    Constant(bool),
    /// From outside, by the number of its name.
    Input(u32),
    Below(NumberId, NumberId),
    AtMost(NumberId, NumberId),
    Equal(NumberId, NumberId),
    Not(FlagId),
    And(FlagId, FlagId),
    Or(FlagId, FlagId),
    /// What the paths of a region leave in one place.
    Merged {
        region: u32,
        place: u32,
    },
    /// An answer of a search: bit `place` of its flags.
    Found {
        search: u32,
        place: u32,
    },
}

/// A decision that a path made.
pub type Decision = (FlagId, bool);

/// Everything recorded so far.
#[derive(Debug)]
pub struct Tape {
    pub precision: Precision,
    pub numbers: Vec<Operation>,
    /// At the nominal input.
    pub values: Vec<f64>,
    known_numbers: HashMap<Operation, NumberId>,
    pub flags: Vec<Condition>,
    pub truths: Vec<bool>,
    known_flags: HashMap<Condition, FlagId>,
    /// Names of what comes from outside.
    pub names: Vec<String>,
    /// What is decided on the present path; none where no path may depend on data.
    path: Option<Path>,
}

/// A path through a region.
#[derive(Debug, Default)]
struct Path {
    given: HashMap<FlagId, bool>,
    made: Vec<Decision>,
    seen: HashMap<FlagId, bool>,
}

impl Tape {
    fn new(precision: Precision) -> Self {
        let mut tape = Self {
            precision,
            numbers: vec![],
            values: vec![],
            known_numbers: HashMap::new(),
            flags: vec![],
            truths: vec![],
            known_flags: HashMap::new(),
            names: vec![],
            path: None,
        };
        let pivot_share = match precision {
            Precision::F32 => f64::from(f32::PIVOT_SHARE),
            Precision::F64 => f64::PIVOT_SHARE,
        };
        for value in [0.0, 1.0, 0.5, f64::INFINITY, pivot_share] {
            tape.constant(value);
        }
        tape
    }

    pub fn constant(&mut self, value: f64) -> NumberId {
        let value = self.precision.rounded(value);
        // The sign of a zero is lost on purpose: its terms are folded away.
        let value = if value == 0.0 { 0.0 } else { value };
        self.number(Operation::Constant(value.to_bits()), value)
    }

    /// The value of a constant.
    pub fn constant_of(&self, number: NumberId) -> Option<f64> {
        match self.numbers[number as usize] {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    pub fn number(&mut self, operation: Operation, value: f64) -> NumberId {
        if let Some(&known) = self.known_numbers.get(&operation) {
            return known;
        }
        let id = self.numbers.len() as NumberId;
        self.numbers.push(operation);
        self.values.push(value);
        self.known_numbers.insert(operation, id);
        id
    }

    /// A number that was recorded already.
    pub fn known(&self, operation: Operation) -> Option<NumberId> {
        self.known_numbers.get(&operation).copied()
    }

    pub fn flag(&mut self, condition: Condition, truth: bool) -> FlagId {
        if let Some(&known) = self.known_flags.get(&condition) {
            return known;
        }
        let id = self.flags.len() as FlagId;
        self.flags.push(condition);
        self.truths.push(truth);
        self.known_flags.insert(condition, id);
        id
    }

    pub fn input(&mut self, name: String, value: f64) -> NumberId {
        let value = self.precision.rounded(value);
        let place = self.names.len() as u32;
        self.names.push(name);
        self.number(Operation::Input(place), value)
    }

    pub fn flag_input(&mut self, name: String, truth: bool) -> FlagId {
        let place = self.names.len() as u32;
        self.names.push(name);
        self.flag(Condition::Input(place), truth)
    }

    pub fn constant_flag(&mut self, truth: bool) -> FlagId {
        self.flag(Condition::Constant(truth), truth)
    }

    pub fn not(&mut self, flag: FlagId) -> FlagId {
        let truth = !self.truths[flag as usize];
        match self.flags[flag as usize] {
            Condition::Constant(_) => self.constant_flag(truth),
            Condition::Not(inner) => inner,
            _ => self.flag(Condition::Not(flag), truth),
        }
    }

    pub fn and(&mut self, a: FlagId, b: FlagId) -> FlagId {
        match (self.flags[a as usize], self.flags[b as usize]) {
            (Condition::Constant(true), _) => b,
            (_, Condition::Constant(true)) => a,
            (Condition::Constant(false), _) => a,
            (_, Condition::Constant(false)) => b,
            _ if a == b => a,
            _ => {
                let truth = self.truths[a as usize] && self.truths[b as usize];
                self.flag(Condition::And(a, b), truth)
            }
        }
    }

    pub fn or(&mut self, a: FlagId, b: FlagId) -> FlagId {
        match (self.flags[a as usize], self.flags[b as usize]) {
            (Condition::Constant(false), _) => b,
            (_, Condition::Constant(false)) => a,
            (Condition::Constant(true), _) => a,
            (_, Condition::Constant(true)) => b,
            _ if a == b => a,
            _ => {
                let truth = self.truths[a as usize] || self.truths[b as usize];
                self.flag(Condition::Or(a, b), truth)
            }
        }
    }

    /// The result of a comparison, folded where both numbers are constants.
    pub fn compare(&mut self, condition: Condition) -> FlagId {
        let (a, b, compare): (_, _, fn(f64, f64) -> bool) = match condition {
            Condition::Below(a, b) => (a, b, |a, b| a < b),
            Condition::AtMost(a, b) => (a, b, |a, b| a <= b),
            Condition::Equal(a, b) => (a, b, |a, b| a == b),
            _ => unreachable!("no comparison"),
        };
        if let (Some(a), Some(b)) = (self.constant_of(a), self.constant_of(b)) {
            return self.constant_flag(compare(a, b));
        }
        let truth = compare(self.values[a as usize], self.values[b as usize]);
        if matches!(condition, Condition::Equal(..)) && self.is_fixed(a) && self.is_fixed(b) {
            // Whoever goes by equal gains takes different ones for different.
            let both_given = self.constant_of(a).is_none() && self.constant_of(b).is_none();
            return self.constant_flag(if both_given { a == b } else { truth });
        }
        self.flag(condition, truth)
    }

    /// Whether a number does not change from cycle to cycle.
    fn is_fixed(&self, number: NumberId) -> bool {
        match self.numbers[number as usize] {
            Operation::Constant(_) => true,
            Operation::Input(name) => self.names[name as usize].starts_with("p."),
            _ => false,
        }
    }

    fn negated(&self, number: NumberId) -> Option<NumberId> {
        match self.numbers[number as usize] {
            Operation::Negate(inner) => Some(inner),
            _ => None,
        }
    }

    /// A number by its operation, folded: exact zeros and ones go, signs move outwards, and what
    /// was recorded before is taken again. Bits stay the same up to the sign of a zero.
    pub fn record(&mut self, operation: Operation) -> NumberId {
        let value = self.evaluate(operation);
        let constants = operation.operands();
        if constants
            .iter()
            .all(|&number| self.constant_of(number).is_some())
        {
            return self.constant(value);
        }
        match operation {
            Operation::Add(a, b) => self.add(a, b, value),
            Operation::Subtract(a, b) => self.subtract(a, b, value),
            Operation::Multiply(a, b) => self.multiply(a, b, value),
            Operation::Divide(a, b) => self.divide(a, b, value),
            Operation::Negate(a) => match self.numbers[a as usize] {
                Operation::Negate(inner) => inner,
                Operation::Subtract(x, y) => self.record(Operation::Subtract(y, x)),
                _ => self.number(operation, value),
            },
            Operation::Magnitude(a) => match self.numbers[a as usize] {
                Operation::Negate(inner) => self.record(Operation::Magnitude(inner)),
                Operation::Magnitude(_) => a,
                _ => self.number(operation, value),
            },
            Operation::WithSign(a, sign) => match self.numbers[a as usize] {
                Operation::Magnitude(inner) => self.record(Operation::WithSign(inner, sign)),
                _ => self.number(operation, value),
            },
            Operation::Choose([a, b, below, otherwise]) => {
                let flag = self.compare(Condition::Below(a, b));
                match self.flags[flag as usize] {
                    Condition::Constant(true) => below,
                    Condition::Constant(false) => otherwise,
                    _ if below == otherwise => below,
                    _ => self.number(operation, value),
                }
            }
            _ => self.number(operation, value),
        }
    }

    fn add(&mut self, a: NumberId, b: NumberId, value: f64) -> NumberId {
        if self.constant_of(a) == Some(0.0) {
            return b;
        }
        if self.constant_of(b) == Some(0.0) {
            return a;
        }
        match (self.negated(a), self.negated(b)) {
            (_, Some(b)) => self.record(Operation::Subtract(a, b)),
            (Some(a), None) => self.record(Operation::Subtract(b, a)),
            _ => self.number(Operation::Add(a.min(b), a.max(b)), value),
        }
    }

    fn subtract(&mut self, a: NumberId, b: NumberId, value: f64) -> NumberId {
        if self.constant_of(b) == Some(0.0) {
            return a;
        }
        if self.constant_of(a) == Some(0.0) {
            return self.record(Operation::Negate(b));
        }
        if let Some(b) = self.negated(b) {
            return self.record(Operation::Add(a, b));
        }
        if let Some(a) = self.negated(a) {
            let sum = self.record(Operation::Add(a, b));
            return self.record(Operation::Negate(sum));
        }
        self.number(Operation::Subtract(a, b), value)
    }

    fn multiply(&mut self, a: NumberId, b: NumberId, value: f64) -> NumberId {
        for (one, other) in [(a, b), (b, a)] {
            match self.constant_of(one) {
                Some(0.0) => return self.constant(0.0),
                Some(1.0) => return other,
                Some(-1.0) => return self.record(Operation::Negate(other)),
                _ => {}
            }
        }
        let (inner_a, inner_b) = (self.negated(a), self.negated(b));
        if inner_a.is_some() || inner_b.is_some() {
            let product = self.record(Operation::Multiply(
                inner_a.unwrap_or(a),
                inner_b.unwrap_or(b),
            ));
            return if inner_a.is_some() == inner_b.is_some() {
                product
            } else {
                self.record(Operation::Negate(product))
            };
        }
        self.number(Operation::Multiply(a.min(b), a.max(b)), value)
    }

    fn divide(&mut self, a: NumberId, b: NumberId, value: f64) -> NumberId {
        match (self.constant_of(a), self.constant_of(b)) {
            (_, Some(1.0)) => return a,
            (Some(0.0), _) => return self.constant(0.0),
            _ => {}
        }
        if let Some(inner) = self.negated(a) {
            let quotient = self.record(Operation::Divide(inner, b));
            return self.record(Operation::Negate(quotient));
        }
        self.number(Operation::Divide(a, b), value)
    }

    fn evaluate(&self, operation: Operation) -> f64 {
        let of = |number: NumberId| self.values[number as usize];
        let by = |f64_: fn(f64) -> f64, f32_: fn(f32) -> f32, x: f64| match self.precision {
            Precision::F64 => f64_(x),
            Precision::F32 => f64::from(f32_(x as f32)),
        };
        let value = match operation {
            Operation::Constant(bits) => f64::from_bits(bits),
            Operation::Input(_) | Operation::Merged { .. } | Operation::Found { .. } => 0.0,
            Operation::Add(a, b) => of(a) + of(b),
            Operation::Subtract(a, b) => of(a) - of(b),
            Operation::Multiply(a, b) => of(a) * of(b),
            Operation::Divide(a, b) => of(a) / of(b),
            Operation::Negate(a) => -of(a),
            Operation::SquareRoot(a) => by(Real::square_root, Real::square_root, of(a)),
            Operation::Sine(a) => by(|x| x.sine_cosine().0, |x| x.sine_cosine().0, of(a)),
            Operation::Cosine(a) => by(|x| x.sine_cosine().1, |x| x.sine_cosine().1, of(a)),
            Operation::ExpNegative(a) => by(Real::exp_negative, Real::exp_negative, of(a)),
            Operation::Magnitude(a) => of(a).abs(),
            Operation::WithSign(a, sign) => of(a).copysign(of(sign)),
            Operation::Most(a, b) => Real::most(of(a), of(b)),
            Operation::Least(a, b) => Real::least(of(a), of(b)),
            Operation::Choose([a, b, below, otherwise]) => {
                of(if of(a) < of(b) { below } else { otherwise })
            }
        };
        self.precision.rounded(value)
    }

    /// Begins a path on which these decisions are given, or ends it: then none may be made.
    pub fn begin_path(&mut self, given: Option<&[Decision]>) {
        self.path = given.map(|given| Path {
            given: given.iter().copied().collect(),
            ..Path::default()
        });
    }

    /// The decisions of the path, in order.
    pub fn end_path(&mut self) -> Vec<Decision> {
        self.path.take().map_or(vec![], |path| path.made)
    }

    /// Which way the present path goes.
    pub fn decide(&mut self, flag: FlagId) -> bool {
        if let Condition::Constant(truth) = self.flags[flag as usize] {
            return truth;
        }
        if let Condition::Not(inner) = self.flags[flag as usize] {
            return !self.decide(inner);
        }
        let truth = self.truths[flag as usize];
        let Some(path) = &mut self.path else {
            panic!(
                "a path depends on data where none may: {:?}",
                self.flags[flag as usize]
            );
        };
        if let Some(&decided) = path.seen.get(&flag) {
            return decided;
        }
        let decided = path.given.get(&flag).copied().unwrap_or(truth);
        path.seen.insert(flag, decided);
        path.made.push((flag, decided));
        decided
    }
}

thread_local! {
    static TAPE: RefCell<Tape> = RefCell::new(Tape::new(Precision::F64));
}

/// Works on the tape of this thread.
pub fn with<R>(work: impl FnOnce(&mut Tape) -> R) -> R {
    TAPE.with(|tape| work(&mut tape.borrow_mut()))
}

/// Begins anew.
pub fn begin(precision: Precision) {
    with(|tape| *tape = Tape::new(precision));
}

/// Ends the recording.
pub fn take() -> Tape {
    with(|tape| {
        let empty = Tape::new(tape.precision);
        std::mem::replace(tape, empty)
    })
}
