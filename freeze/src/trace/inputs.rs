//! What comes from outside: the state, measurement and reference, gains and limits, each by a name.

use controller_core::cells::Cells;
use controller_core::joint::{JointVector, Vector3};
use controller_core::task::orientation::Quaternion;
use controller_core::{Measurement, Reference, Target};

use super::program::Field;
use crate::scalar::Recorded;
use crate::tape::{FlagId, NumberId, with};

/// Names of what cells visit, in order.
#[derive(Default)]
pub(super) struct Names {
    level: Option<usize>,
    pub(super) numbers: Vec<String>,
    pub(super) flags: Vec<String>,
    pub(super) values: Vec<f64>,
    pub(super) truths: Vec<bool>,
}

impl Names {
    fn name(&self, name: &str) -> String {
        match self.level {
            Some(place) => format!("{name}_{}", place + 1),
            None => name.to_string(),
        }
    }
}

impl Cells<f64> for Names {
    fn level(&mut self, place: Option<usize>) {
        self.level = place;
    }
    fn numbers(&mut self, name: &'static str, values: &mut [f64]) {
        let name = self.name(name);
        // Arrays of one name in one level follow each other.
        let taken = self
            .numbers
            .iter()
            .filter(|known| known.starts_with(&format!("{name}[")))
            .count();
        for (index, value) in values.iter().enumerate() {
            self.numbers.push(format!("{name}[{}]", taken + index));
            self.values.push(*value);
        }
    }
    fn flag(&mut self, name: &'static str, value: &mut bool) {
        self.flags.push(self.name(name));
        self.truths.push(*value);
    }
    fn set(&mut self, name: &'static str, bits: &mut u8) {
        for bit in 0..8 {
            self.flags.push(format!("{}_bit_{bit}", self.name(name)));
            self.truths.push(*bits >> bit & 1 != 0);
        }
    }
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

/// Puts numbers into cells, and flags as they are decided.
pub(super) struct Placed<'a> {
    pub(super) numbers: Option<std::slice::Iter<'a, NumberId>>,
    pub(super) flags: std::slice::Iter<'a, FlagId>,
    /// Whether flags are decided on a path, or put as they are nominally.
    pub(super) decides: bool,
}

impl Placed<'_> {
    fn next_flag(&mut self) -> bool {
        let flag = *self.flags.next().expect("as many flags as cells");
        with(|tape| {
            if self.decides {
                tape.decide(flag)
            } else {
                tape.truths[flag as usize]
            }
        })
    }
}

impl Cells<Recorded> for Placed<'_> {
    fn numbers(&mut self, _: &'static str, values: &mut [Recorded]) {
        if let Some(numbers) = &mut self.numbers {
            for value in values {
                *value = Recorded(*numbers.next().expect("as many numbers as cells"));
            }
        }
    }
    fn flag(&mut self, _: &'static str, value: &mut bool) {
        *value = self.next_flag();
    }
    fn set(&mut self, _: &'static str, bits: &mut u8) {
        *bits = (0..8).map(|bit| u8::from(self.next_flag()) << bit).sum();
    }
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

/// Gains, limits and the last link become inputs where they are not zero.
#[derive(Default)]
pub(super) struct Parameters {
    level: Option<usize>,
    pub(super) fields: Vec<Field>,
}

impl Cells<Recorded> for Parameters {
    fn level(&mut self, place: Option<usize>) {
        self.level = place;
    }
    fn numbers(&mut self, name: &'static str, values: &mut [Recorded]) {
        let name = match self.level {
            Some(place) => format!("{name}_{}", place + 1),
            None => name.to_string(),
        };
        let mut field = Field {
            name,
            values: vec![],
            is_flag: false,
        };
        // One gain of all joints stays one: they share what decays by it.
        if field.name == "observer_gain" && values.iter().all(|value| value.0 == values[0].0) {
            let number = with(|tape| tape.constant_of(values[0].0)).expect("a constant");
            let name = format!("p.{}[0]", field.name);
            let shared = with(|tape| tape.input(name, number));
            field.values.push(number);
            values.fill(Recorded(shared));
            self.fields.push(field);
            return;
        }
        for (index, value) in values.iter_mut().enumerate() {
            let number = with(|tape| tape.constant_of(value.0)).expect("a constant");
            field.values.push(number);
            if number != 0.0 {
                let name = format!("p.{}[{index}]", field.name);
                value.0 = with(|tape| tape.input(name, number));
            }
        }
        self.fields.push(field);
    }
    fn flag(&mut self, _: &'static str, _: &mut bool) {}
    fn set(&mut self, _: &'static str, _: &mut u8) {}
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

fn vector<const N: usize>(name: &str, values: [f64; N]) -> [Recorded; N] {
    std::array::from_fn(|i| Recorded(with(|tape| tape.input(format!("{name}[{i}]"), values[i]))))
}

pub(super) fn measurement(nominal: &Measurement<f64>) -> Measurement<Recorded> {
    Measurement {
        q: vector("m.q", nominal.q.into()).into(),
        dq: vector("m.dq", nominal.dq.into()).into(),
        interval_s: Recorded(with(|tape| {
            tape.input("m.interval_s".to_string(), nominal.interval_s)
        })),
    }
}

/// The reference as it comes from outside, and of each slot whether it holds.
pub(super) fn reference(nominal: &Reference<f64>) -> (Reference<Recorded>, Vec<FlagId>) {
    let mut holds = vec![];
    let targets: Vec<Target<Recorded>> = nominal
        .targets()
        .iter()
        .enumerate()
        .map(|(slot, target)| {
            let name = format!("r.target_{}", slot + 1);
            holds.push(with(|tape| tape.flag_input(format!("{name}.holds"), false)));
            let of = |part: &str, value: &Vector3<f64>| {
                Vector3::from(vector(&format!("{name}.{part}"), (*value).into()))
            };
            match target {
                Target::Orientation { q, w, dw } => Target::Orientation {
                    q: Quaternion::from(vector(&format!("{name}.q"), (*q).into())),
                    w: of("w", w),
                    dw: of("dw", dw),
                },
                Target::Position { x, dx, ddx } => Target::Position {
                    x: of("x", x),
                    dx: of("dx", dx),
                    ddx: of("ddx", ddx),
                },
                Target::Hold => Target::Hold,
            }
        })
        .collect();
    let posture = JointVector::from(vector("r.posture", nominal.posture.into()));
    let reference = Reference::from_targets(&targets, posture).expect("as many as levels");
    (reference, holds)
}

/// `reference` with those targets on hold that are decided to be.
pub(super) fn decided(
    reference: &Reference<Recorded>,
    holds: &[FlagId],
    slots: &[usize],
) -> Reference<Recorded> {
    let mut reference = reference.clone();
    for &slot in slots {
        if with(|tape| tape.decide(holds[slot])) {
            reference.targets_mut()[slot] = Target::Hold;
        }
    }
    reference
}

pub(super) fn add_value(fields: &mut Vec<Field>, name: &str, value: f64) {
    let (array, _) = name.split_once('[').expect("an entry of an array");
    match fields.iter_mut().find(|field| field.name == array) {
        Some(field) => field.values.push(value),
        None => fields.push(Field {
            name: array.to_string(),
            values: vec![value],
            is_flag: false,
        }),
    }
}
