//! The generic cycle run on the scalar that records: what may start it, the cycle itself, and the
//! cycle after a fault.

use std::collections::HashMap;

use controller_core::cells::Cells;
use controller_core::cycle::parts::{BrakePart, Group, InputPart, Part};
use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::fault::{Fault, IndexSet};
use controller_core::joint::{DOF, JointVector, Vector3};
use controller_core::task::orientation::Quaternion;
use controller_core::{Controller, Measurement, Reference, State, Target};

use crate::explore::{Count, Left, Outcome, Paths, explore, merged};
use crate::nominal::Nominal;
use crate::scalar::{Recorded, carried};
use crate::tape::{FlagId, NumberId, with};

/// A part of a function whose path depends on data, and how many numbers were recorded before
/// what it leaves was merged.
#[derive(Debug)]
pub struct Region {
    pub number: u32,
    pub paths: Paths,
    pub recorded: NumberId,
}

/// What a function leaves in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    Number(NumberId),
    Flag(FlagId),
    Count(Count),
}

/// Statements in a straight line with regions between, and what is left at the end by its place.
#[derive(Debug, Default)]
pub struct Function {
    /// Stages by how many numbers were recorded at their end.
    pub stages: Vec<(NumberId, &'static str)>,
    pub regions: Vec<Region>,
    pub left: Vec<(String, Value)>,
}

/// Numbers with which the search for the nearest acceleration is called.
#[derive(Debug, PartialEq)]
pub struct Search {
    pub given: Vec<NumberId>,
}

/// An array, or a flag, of what is kept or given.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub name: String,
    /// Values at the start; none of a flag that is down then, one of a flag that is up.
    pub values: Vec<f64>,
    pub is_flag: bool,
}

/// Everything that was recorded of a controller.
#[derive(Debug)]
pub struct Program {
    pub parameters: Vec<Field>,
    pub state: Vec<Field>,
    /// Whether each level tracks an orientation, by slots.
    pub orientations: Vec<bool>,
    /// What of an input is looked at, one after the other until there is a fault.
    pub admit: Vec<Function>,
    pub cycle: Function,
    pub brake: Function,
    pub searches: Vec<Search>,
}

/// Names of what cells visit, in order.
#[derive(Default)]
struct Names {
    level: Option<usize>,
    numbers: Vec<String>,
    flags: Vec<String>,
    values: Vec<f64>,
    truths: Vec<bool>,
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
    fn set(&mut self, name: &'static str, value: &mut IndexSet) {
        for bit in 0..8 {
            self.flags.push(format!("{}_bit_{bit}", self.name(name)));
            self.truths.push(value.contains(bit));
        }
    }
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

/// Puts numbers into cells, and flags as they are decided.
struct Placed<'a> {
    numbers: Option<std::slice::Iter<'a, NumberId>>,
    flags: std::slice::Iter<'a, FlagId>,
    /// Whether flags are decided on a path, or put as they are nominally.
    decides: bool,
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
    fn set(&mut self, _: &'static str, value: &mut IndexSet) {
        let bits = (0..8).map(|bit| u8::from(self.next_flag()) << bit);
        value.0 = bits.sum();
    }
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

/// A group, or what a state remembers of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Of(Group),
    Brake,
}

/// A controller, its generic twin in double precision, and where a recording stands.
struct Tracer<'a> {
    controller: &'a Controller<Recorded>,
    twin: &'a Controller<f64>,
    state: State<Recorded>,
    /// Flags of each group as they are now.
    flags: Vec<(Place, Vec<FlagId>)>,
    counts: HashMap<&'static str, Count>,
    function: Function,
    next_region: u32,
    searches: Vec<Search>,
}

fn visit_place<T: controller_core::real::Real>(
    controller: &Controller<T>,
    place: Place,
    state: &mut State<T>,
    cells: &mut impl Cells<T>,
) {
    match place {
        Place::Of(group) => controller.visit_group(group, state.data_mut(), cells),
        Place::Brake => state.visit_brake(cells),
    }
}

impl<'a> Tracer<'a> {
    fn places(&self) -> Vec<Place> {
        let levels = self.controller.levels_in_force();
        let mut places: Vec<Place> = (0..levels)
            .map(|place| Place::Of(Group::Target(place)))
            .collect();
        places.extend(
            [
                Group::Joints,
                Group::HoldingTorque,
                Group::Observer,
                Group::Posture,
                Group::PostureReference,
                Group::Joining,
                Group::Shortened,
                Group::Spectrum,
                Group::Deficient,
                Group::WayOut,
                Group::Wish,
                Group::Projection,
                Group::Demand,
                Group::Allocation,
            ]
            .map(Place::Of),
        );
        places.push(Place::Brake);
        places
    }

    /// Everything that is remembered comes from outside, with the values of a `nominal` state.
    /// Returns its fields with the values of a new one.
    fn take_state(&mut self, nominal: &mut State<f64>) -> Vec<Field> {
        let mut fields: Vec<Field> = vec![];
        let mut fresh = State::<f64>::new();
        for place in self.places() {
            let (mut names, mut at_first) = (Names::default(), Names::default());
            visit_place(self.twin, place, nominal, &mut names);
            visit_place(self.twin, place, &mut fresh, &mut at_first);
            let numbers: Vec<NumberId> = names
                .numbers
                .iter()
                .zip(&names.values)
                .map(|(name, &value)| with(|tape| tape.input(format!("s.{name}"), value)))
                .collect();
            let flags: Vec<FlagId> = names
                .flags
                .iter()
                .zip(&names.truths)
                .map(|(name, &truth)| with(|tape| tape.flag_input(format!("s.{name}"), truth)))
                .collect();
            for (name, value) in names.numbers.iter().zip(&at_first.values) {
                add_value(&mut fields, name, *value);
            }
            for (name, &truth) in names.flags.iter().zip(&at_first.truths) {
                fields.push(Field {
                    name: name.clone(),
                    values: vec![f64::from(u8::from(truth))],
                    is_flag: true,
                });
            }
            let mut placed = Placed {
                numbers: Some(numbers.iter()),
                flags: flags.iter(),
                decides: false,
            };
            visit_place(self.controller, place, &mut self.state, &mut placed);
            self.flags.push((place, flags));
        }
        fields
    }

    fn flags_of(&self, place: Place) -> &[FlagId] {
        self.flags
            .iter()
            .find(|(known, _)| *known == place)
            .map_or(&[], |(_, flags)| flags)
    }

    fn set_flags(&mut self, place: Place, flags: Vec<FlagId>) {
        if let Some((_, known)) = self.flags.iter_mut().find(|(known, _)| *known == place) {
            *known = flags;
        }
    }

    /// A part whose path depends on the flags of `reads` and on numbers, and which changes what
    /// belongs to `writes`, and numbers beside, but those on every path alike.
    fn region(
        &mut self,
        reads: &[Place],
        writes: &[Place],
        work: &mut dyn FnMut(&Self, &mut State<Recorded>, &mut Outcome),
    ) -> Left {
        let all: Vec<Place> = writes.iter().chain(reads).copied().collect();
        let mut last = None;
        let paths = explore(&mut || {
            let mut state = self.state.clone();
            for &place in &all {
                let mut placed = Placed {
                    numbers: None,
                    flags: self.flags_of(place).iter(),
                    decides: true,
                };
                visit_place(self.controller, place, &mut state, &mut placed);
            }
            let mut outcome = Outcome::default();
            let mut besides = Outcome::default();
            work(self, &mut state, &mut besides);
            for &place in writes {
                visit_place(self.controller, place, &mut state, &mut outcome);
            }
            outcome.numbers.extend(besides.numbers);
            outcome.flags.extend(besides.flags);
            outcome.counts.extend(besides.counts);
            last = Some(state);
            outcome
        });
        let number = self.next_region;
        self.next_region += 1;
        let recorded = with(|tape| tape.numbers.len() as NumberId);
        let left = merged(number, &paths);
        // What is not visited is the same on every path.
        self.state = last.expect("a run");
        let (mut numbers, mut flags) = (left.numbers.iter(), left.flags.iter());
        for &place in writes {
            let mut names = Names::default();
            visit_place(self.twin, place, &mut State::new(), &mut names);
            let own: Vec<FlagId> = flags.by_ref().take(names.flags.len()).copied().collect();
            let own_numbers: Vec<NumberId> = numbers
                .by_ref()
                .take(names.numbers.len())
                .copied()
                .collect();
            let mut placed = Placed {
                numbers: Some(own_numbers.iter()),
                flags: own.iter(),
                decides: false,
            };
            visit_place(self.controller, place, &mut self.state, &mut placed);
            self.set_flags(place, own);
        }
        if paths.ends().len() > 1 {
            self.function.regions.push(Region {
                number,
                paths,
                recorded,
            });
        }
        Left {
            numbers: numbers.copied().collect(),
            flags: flags.copied().collect(),
            counts: left.counts,
        }
    }

    /// A stage that has one path.
    fn straight(&mut self, stage: StageName, input: &Input<'_, Recorded>) {
        run_stage(self.controller, stage, input, self.state.data_mut());
        self.end_stage(stage.text());
    }

    /// What was recorded since the last stage ended belongs to this one.
    fn end_stage(&mut self, name: &'static str) {
        let recorded = with(|tape| tape.numbers.len() as NumberId);
        self.function.stages.push((recorded, name));
    }

    fn stage(
        &mut self,
        stage: StageName,
        input: &Input<'_, Recorded>,
        reads: &[Group],
        writes: &[Group],
    ) {
        let of = |groups: &[Group]| groups.iter().copied().map(Place::Of).collect::<Vec<_>>();
        self.region(&of(reads), &of(writes), &mut |tracer, state, _| {
            run_stage(tracer.controller, stage, input, state.data_mut());
        });
        self.end_stage(stage.text());
    }

    fn part(&mut self, part: Part, input: &Input<'_, Recorded>, reads: &[Group], writes: &[Group]) {
        let of = |groups: &[Group]| groups.iter().copied().map(Place::Of).collect::<Vec<_>>();
        self.region(&of(reads), &of(writes), &mut |tracer, state, _| {
            tracer.controller.run_part(part, input, state.data_mut());
        });
        self.end_stage(match part {
            Part::Target(_) | Part::Posture => StageName::Followed.text(),
            Part::WishKept | Part::Compliance | Part::Projected => StageName::Projection.text(),
            _ => StageName::Wish.text(),
        });
    }

    /// The state as it is left, by the names of its fields.
    fn leave_state(&mut self) {
        let mut left = vec![];
        for place in self.places() {
            let (mut names, mut outcome) = (Names::default(), Outcome::default());
            visit_place(self.twin, place, &mut State::new(), &mut names);
            visit_place(self.controller, place, &mut self.state, &mut outcome);
            for (name, &number) in names.numbers.iter().zip(&outcome.numbers) {
                left.push((format!("s.{name}"), Value::Number(number)));
            }
            for (name, &flag) in names.flags.iter().zip(self.flags_of(place)) {
                left.push((format!("s.{name}"), Value::Flag(flag)));
            }
        }
        self.function.left.extend(left);
    }

    /// A set of flags of a group by its name.
    fn set_of(&self, group: Group, name: &str) -> Vec<FlagId> {
        let mut names = Names::default();
        visit_place(self.twin, Place::Of(group), &mut State::new(), &mut names);
        let flags = self.flags_of(Place::Of(group));
        let is_own = |known: &str| known == name || known.starts_with(&format!("{name}_bit_"));
        names
            .flags
            .iter()
            .zip(flags)
            .filter(|(known, _)| is_own(known))
            .map(|(_, &flag)| flag)
            .collect()
    }

    fn leave_flags(&mut self, to: &str, flags: &[FlagId]) {
        for (bit, &flag) in flags.iter().enumerate() {
            let place = if flags.len() == 1 {
                to.to_string()
            } else {
                format!("{to}:{bit}")
            };
            self.function.left.push((place, Value::Flag(flag)));
        }
    }

    fn leave_vector(&mut self, to: &str, vector: &JointVector<Recorded>) {
        for i in 0..DOF {
            self.function
                .left
                .push((format!("{to}[{i}]"), Value::Number(vector[i].0)));
        }
    }

    fn leave_fault(&mut self, left: &Left) {
        let names = ["fault.kind", "fault.quantity", "fault.index"];
        for (name, &count) in names.iter().zip(&left.counts) {
            self.function
                .left
                .push(((*name).to_string(), Value::Count(count)));
        }
        for (name, &number) in ["fault.value", "fault.min", "fault.max"]
            .iter()
            .zip(&left.numbers)
        {
            self.function
                .left
                .push(((*name).to_string(), Value::Number(number)));
        }
    }

    fn take_function(&mut self) -> Function {
        std::mem::take(&mut self.function)
    }
}

fn add_value(fields: &mut Vec<Field>, name: &str, value: f64) {
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

fn run_stage(
    controller: &Controller<Recorded>,
    stage: StageName,
    input: &Input<'_, Recorded>,
    data: &mut Data<Recorded>,
) {
    let stages = Controller::<Recorded>::STAGES;
    let exact = Controller::<Recorded>::EXACT_STAGES;
    let all: &[_] = if controller.has_limits() {
        &stages
    } else {
        &exact
    };
    let (_, run) = all
        .iter()
        .find(|(name, _)| *name == stage)
        .expect("a stage of the law");
    run(controller, input, data);
}

/// What a fault leaves: its kind, quantity and place, its value and what is allowed.
fn tell_fault(fault: Option<Fault>, outcome: &mut Outcome) {
    let told = fault.map_or([0, 0, 0], |fault| {
        [fault.kind.number(), fault.quantity as u8, fault.index]
    });
    outcome.counts.extend(told.map(Count::Constant));
    let numbers = fault.map_or([0.0; 3], |fault| [fault.value, fault.min, fault.max]);
    outcome
        .numbers
        .extend(numbers.map(|number| carried(number).0));
}

/// Gains, limits and the last link become inputs where they are not zero.
struct Parameters {
    level: Option<usize>,
    fields: Vec<Field>,
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
    fn set(&mut self, _: &'static str, _: &mut IndexSet) {}
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

fn vector<const N: usize>(name: &str, values: [f64; N]) -> [Recorded; N] {
    std::array::from_fn(|i| Recorded(with(|tape| tape.input(format!("{name}[{i}]"), values[i]))))
}

fn measurement(nominal: &Measurement<f64>) -> Measurement<Recorded> {
    Measurement {
        q: vector("m.q", nominal.q.into()).into(),
        dq: vector("m.dq", nominal.dq.into()).into(),
        interval_s: Recorded(with(|tape| {
            tape.input("m.interval_s".to_string(), nominal.interval_s)
        })),
    }
}

/// The reference as it comes from outside, and of each slot whether it holds.
fn reference(nominal: &Reference<f64>) -> (Reference<Recorded>, Vec<FlagId>) {
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
fn decided(
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

/// Records a controller; `twin` is the same in double precision.
pub fn trace(
    controller: &mut Controller<Recorded>,
    twin: &Controller<f64>,
    nominal: &mut Nominal,
) -> Program {
    let mut parameters = Parameters {
        level: None,
        fields: vec![],
    };
    controller.visit(&mut parameters);
    let measurement = measurement(&nominal.measurement);
    let (reference, holds) = reference(&nominal.reference);
    let mut tracer = Tracer {
        controller,
        twin,
        state: State::new(),
        flags: vec![],
        counts: HashMap::new(),
        function: Function::default(),
        next_region: 0,
        searches: vec![],
    };
    let state = tracer.take_state(&mut nominal.state);
    let start = (tracer.state.clone(), tracer.flags.clone());
    let input = Input {
        measurement: &measurement,
        reference: &reference,
    };
    let slots: Vec<usize> = (0..controller.levels_in_force())
        .filter_map(|place| controller.slot_at(place))
        .collect();

    let mut parts = vec![(InputPart::Measurement, vec![])];
    let of_levels = slots.iter().enumerate();
    parts.extend(of_levels.map(|(place, &slot)| (InputPart::Target(place), vec![slot])));
    parts.push((InputPart::Posture, vec![]));
    let mut admit = vec![];
    for (part, slots) in parts {
        let left = tracer.region(&[], &[], &mut |tracer, _, outcome| {
            let reference = decided(&reference, &holds, &slots);
            let input = Input {
                measurement: &measurement,
                reference: &reference,
            };
            tell_fault(tracer.controller.admit_part(part, &input).err(), outcome);
        });
        tracer.leave_fault(&left);
        admit.push(tracer.take_function());
    }

    (tracer.state, tracer.flags) = start.clone();
    trace_cycle(&mut tracer, &input, &holds, &slots);
    let cycle = tracer.take_function();

    (tracer.state, tracer.flags) = start;
    trace_brake(&mut tracer, &input);
    let brake = tracer.take_function();
    Program {
        parameters: parameters.fields,
        state,
        orientations: (0..slots.len())
            .map(|place| controller.tracks_orientation(place))
            .collect(),
        admit,
        cycle,
        brake,
        searches: tracer.searches,
    }
}

fn trace_cycle(
    tracer: &mut Tracer<'_>,
    input: &Input<'_, Recorded>,
    holds: &[FlagId],
    slots: &[usize],
) {
    use Group::{
        Allocation, Deficient, HoldingTorque, Joining, Observer, Posture, PostureReference,
        Projection, Shortened, Spectrum, WayOut, Wish,
    };
    tracer.straight(StageName::JointState, input);
    tracer.straight(StageName::Kinematics, input);
    tracer.straight(StageName::Dynamics, input);
    tracer.stage(StageName::HoldingTorque, input, &[], &[HoldingTorque]);
    tracer.stage(StageName::Observer, input, &[], &[Observer]);
    let none = with(|tape| tape.constant_flag(false));
    tracer.set_flags(Place::Of(Joining), vec![none; 8]);
    for (place, &slot) in slots.iter().enumerate() {
        let target = Group::Target(place);
        tracer.region(
            &[Place::Of(Posture)],
            &[Place::Of(target), Place::Of(Joining)],
            &mut |tracer, state, _| {
                let reference = decided(input.reference, holds, &[slot]);
                let input = Input {
                    measurement: input.measurement,
                    reference: &reference,
                };
                let data = state.data_mut();
                tracer
                    .controller
                    .run_part(Part::Target(place), &input, data);
            },
        );
    }
    tracer.end_stage(StageName::Followed.text());
    tracer.part(Part::Posture, input, &[], &[Posture, Joining]);
    tracer.stage(StageName::TaskRows, input, &[], &[Shortened]);
    if tracer.controller.has_limits() {
        tracer.stage(StageName::Spectrum, input, &[], &[Spectrum]);
        tracer.straight(StageName::MotionSplit, input);
        tracer.stage(StageName::Posture, input, &[Posture], &[PostureReference]);
        tracer.part(Part::NullForce, input, &[], &[]);
        tracer.part(Part::WayOut, input, &[Spectrum], &[WayOut]);
        tracer.part(Part::NoWish, input, &[], &[Wish]);
        for place in 0..slots.len() {
            let reads = [Spectrum, Shortened];
            tracer.part(Part::LevelWish(place), input, &reads, &[Wish]);
        }
        tracer.part(Part::NullWish, input, &[Spectrum, WayOut], &[Wish]);
        tracer.straight(StageName::Bounds, input);
        trace_projection(tracer, input);
    } else {
        tracer.stage(StageName::Hierarchy, input, &[], &[Deficient]);
        tracer.straight(StageName::MotionSplit, input);
        tracer.stage(StageName::Posture, input, &[Posture], &[PostureReference]);
        tracer.straight(StageName::Control, input);
    }
    tracer.straight(StageName::TorqueDemand, input);
    tracer.stage(StageName::Allocation, input, &[], &[Allocation]);
    tracer.straight(StageName::ObserverInput, input);

    let fault = tracer.region(&[Place::Of(Allocation)], &[], &mut |_, state, outcome| {
        let data = state.data_mut();
        tell_fault(data.allocation.fault(&data.demand), outcome);
    });
    let data = tracer.state.data_mut().clone();
    tracer.leave_vector("step.torque", &data.allocation.torque);
    tracer.leave_vector("step.residual", data.residual());
    tracer.leave_vector("step.gravity", &data.dynamics.gravity);
    tracer.leave_vector("step.coriolis", &data.dynamics.coriolis);
    let mut told = vec![
        (Allocation, "saturated"),
        (Allocation, "rate_limited"),
        (Joining, "joining"),
    ];
    if tracer.controller.has_limits() {
        told.extend([
            (Spectrum, "degraded"),
            (Spectrum, "released"),
            (Wish, "shaped"),
            (Wish, "scaled"),
            (Projection, "at_least"),
            (Projection, "at_greatest"),
            (Projection, "unresolved"),
            (WayOut, "stuck"),
        ]);
        let pivots = tracer.counts["pivots"];
        let to = "step.pivots".to_string();
        tracer.function.left.push((to, Value::Count(pivots)));
    } else {
        told.push((Deficient, "rank"));
    }
    for (group, name) in told {
        let flags = tracer.set_of(group, name);
        tracer.leave_flags(&format!("step.{name}"), &flags);
    }
    tracer.leave_fault(&fault);
    let seen = with(|tape| tape.constant_flag(true));
    let mut brake = tracer.flags_of(Place::Brake).to_vec();
    if let Some(last) = brake.last_mut() {
        *last = seen;
    }
    tracer.set_flags(Place::Brake, brake);
    tracer.leave_state();
}

/// The wish within its bounds, or the acceleration that a search finds.
fn trace_projection(tracer: &mut Tracer<'_>, input: &Input<'_, Recorded>) {
    let searches = std::cell::RefCell::new(vec![]);
    let left = tracer.region(
        &[],
        &[Place::Of(Group::Projection)],
        &mut |tracer, state, outcome| {
            let (controller, data) = (tracer.controller, state.data_mut());
            if controller.keeps_wish(data) {
                controller.run_part(Part::WishKept, input, data);
                outcome.counts.push(Count::Constant(0));
                return;
            }
            controller.run_part(Part::Compliance, input, data);
            let mut given: Vec<NumberId> = vec![];
            for vector in [
                &data.wish.acceleration,
                &data.bounds.least,
                &data.bounds.greatest,
            ] {
                given.extend(vector.iter().map(|number| number.0));
            }
            for i in 0..DOF {
                given.extend(data.compliance_row(i).iter().map(|number| number.0));
            }
            let mut searches = searches.borrow_mut();
            let search = Search { given };
            let number = searches
                .iter()
                .position(|known| *known == search)
                .unwrap_or_else(|| {
                    searches.push(search);
                    searches.len() - 1
                }) as u32;
            let mut found = Found { search: number };
            controller.visit_group(Group::Projection, data, &mut found);
            controller.run_part(Part::Projected, input, data);
            outcome.counts.push(Count::Pivots(number));
        },
    );
    tracer.end_stage(StageName::Projection.text());
    tracer.searches = searches.into_inner();
    let pivots = *left.counts.last().expect("of the search");
    tracer.counts.insert("pivots", pivots);
}

/// What a search answers, put in its place.
struct Found {
    search: u32,
}

impl Cells<Recorded> for Found {
    fn numbers(&mut self, name: &'static str, values: &mut [Recorded]) {
        if name == "nearest" {
            for (place, value) in (0..).zip(values) {
                let search = self.search;
                let found = crate::tape::Operation::Found { search, place };
                *value = Recorded(with(|tape| tape.number(found, 0.0)));
            }
        }
    }
    fn flag(&mut self, name: &'static str, value: &mut bool) {
        if name == "unresolved" {
            *value = self.decided(16);
        }
    }
    fn set(&mut self, name: &'static str, value: &mut IndexSet) {
        let first = match name {
            "at_least" => 0,
            "at_greatest" => 8,
            _ => return,
        };
        value.0 = (0..7)
            .map(|bit| u8::from(self.decided(first + bit)) << bit)
            .sum();
    }
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

impl Found {
    fn decided(&self, place: u32) -> bool {
        let search = self.search;
        with(|tape| {
            let flag = tape.flag(crate::tape::Condition::Found { search, place }, false);
            tape.decide(flag)
        })
    }
}

fn trace_brake(tracer: &mut Tracer<'_>, input: &Input<'_, Recorded>) {
    let brake = Place::Brake;
    let of = |groups: &[Group]| groups.iter().copied().map(Place::Of).collect::<Vec<_>>();
    let parts: [(BrakePart, &[Group]); 3] = [
        (BrakePart::Look, &[]),
        (
            BrakePart::Demand,
            &[Group::Joints, Group::HoldingTorque, Group::Demand],
        ),
        (BrakePart::Allowed, &[Group::Allocation]),
    ];
    for (part, groups) in parts {
        let mut writes = of(groups);
        writes.push(brake);
        let left = tracer.region(&[], &writes, &mut |tracer, state, outcome| {
            tracer.controller.run_brake_part(part, state, input);
            if part == BrakePart::Demand {
                let gravity = state.data().dynamics.gravity;
                outcome
                    .numbers
                    .extend(gravity.iter().map(|number| number.0));
            }
        });
        for (i, &number) in left.numbers.iter().enumerate() {
            let to = format!("gravity[{i}]");
            tracer.function.left.push((to, Value::Number(number)));
        }
    }
    let torque = tracer.state.data().allocation.torque;
    tracer.leave_vector("step.torque", &torque);
    let sees = tracer.flags_of(brake)[2];
    tracer.leave_flags("sees", &[sees]);
    for name in ["saturated", "rate_limited"] {
        let flags = tracer.set_of(Group::Allocation, name);
        tracer.leave_flags(&format!("step.{name}"), &flags);
    }
    for (name, place) in [("is_still", 0), ("is_unseen", 1)] {
        let flag = tracer.flags_of(brake)[place];
        tracer.leave_flags(&format!("step.{name}"), &[flag]);
    }
    tracer.leave_state();
}
