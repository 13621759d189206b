//! Runs parts of a cycle and keeps what they leave.

use std::collections::HashMap;

use controller_core::cells::Cells;
use controller_core::cycle::parts::{Group, Part};
use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::fault::Fault;
use controller_core::joint::{DOF, JointVector};
use controller_core::{Controller, State};

use super::inputs::{Names, Placed, add_value};
use super::program::{Field, Function, Region, Search};
use crate::explore::{Count, Left, Outcome, Value, explore, merged};
use crate::scalar::{Recorded, carried};
use crate::tape::{FlagId, NumberId, with};

/// A group, or what a state remembers of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    Of(Group),
    Brake,
}

/// A controller, its generic twin in double precision, and where a recording stands.
pub(super) struct Tracer<'a> {
    pub controller: &'a Controller<Recorded>,
    twin: &'a Controller<f64>,
    pub state: State<Recorded>,
    /// Flags of each group as they are now.
    pub flags: Vec<(Place, Vec<FlagId>)>,
    pub counts: HashMap<&'static str, Count>,
    pub function: Function,
    next_region: u32,
    pub searches: Vec<Search>,
}

pub(super) fn visit_place<T: controller_core::real::Real>(
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
    pub fn new(controller: &'a Controller<Recorded>, twin: &'a Controller<f64>) -> Self {
        Self {
            controller,
            twin,
            state: State::new(),
            flags: vec![],
            counts: HashMap::new(),
            function: Function::default(),
            next_region: 0,
            searches: vec![],
        }
    }

    pub fn places(&self) -> Vec<Place> {
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
    pub fn take_state(&mut self, nominal: &mut State<f64>) -> Vec<Field> {
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

    pub fn flags_of(&self, place: Place) -> &[FlagId] {
        self.flags
            .iter()
            .find(|(known, _)| *known == place)
            .map_or(&[], |(_, flags)| flags)
    }

    pub fn set_flags(&mut self, place: Place, flags: Vec<FlagId>) {
        if let Some((_, known)) = self.flags.iter_mut().find(|(known, _)| *known == place) {
            *known = flags;
        }
    }

    /// A part whose path depends on the flags of `reads` and on numbers, and which changes what
    /// belongs to `writes`, and numbers beside, but those on every path alike.
    pub fn region(
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
    pub fn straight(&mut self, stage: StageName, input: &Input<'_, Recorded>) {
        run_stage(self.controller, stage, input, self.state.data_mut());
        self.end_stage(stage.text());
    }

    /// What was recorded since the last stage ended belongs to this one.
    pub fn end_stage(&mut self, name: &'static str) {
        let recorded = with(|tape| tape.numbers.len() as NumberId);
        self.function.stages.push((recorded, name));
    }

    pub fn stage(
        &mut self,
        stage: StageName,
        input: &Input<'_, Recorded>,
        reads: &[Group],
        writes: &[Group],
    ) {
        self.region(
            &places_of(reads),
            &places_of(writes),
            &mut |tracer, state, _| {
                run_stage(tracer.controller, stage, input, state.data_mut());
            },
        );
        self.end_stage(stage.text());
    }

    pub fn part(
        &mut self,
        part: Part,
        input: &Input<'_, Recorded>,
        reads: &[Group],
        writes: &[Group],
    ) {
        self.region(
            &places_of(reads),
            &places_of(writes),
            &mut |tracer, state, _| {
                tracer.controller.run_part(part, input, state.data_mut());
            },
        );
        self.end_stage(match part {
            Part::Target(_) | Part::Posture => StageName::Followed.text(),
            Part::WishKept | Part::Compliance | Part::Projected => StageName::Projection.text(),
            _ => StageName::Wish.text(),
        });
    }

    /// The state as it is left, by the names of its fields.
    pub fn leave_state(&mut self) {
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
    pub fn set_of(&self, group: Group, name: &str) -> Vec<FlagId> {
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

    pub fn leave_flags(&mut self, to: &str, flags: &[FlagId]) {
        for (bit, &flag) in flags.iter().enumerate() {
            let place = if flags.len() == 1 {
                to.to_string()
            } else {
                format!("{to}:{bit}")
            };
            self.function.left.push((place, Value::Flag(flag)));
        }
    }

    pub fn leave_vector(&mut self, to: &str, vector: &JointVector<Recorded>) {
        for i in 0..DOF {
            self.function
                .left
                .push((format!("{to}[{i}]"), Value::Number(vector[i].0)));
        }
    }

    pub fn leave_fault(&mut self, left: &Left) {
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

    pub fn take_function(&mut self) -> Function {
        std::mem::take(&mut self.function)
    }
}

/// Groups as places.
pub(super) fn places_of(groups: &[Group]) -> Vec<Place> {
    groups.iter().copied().map(Place::Of).collect()
}

pub(super) fn run_stage(
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
pub(super) fn tell_fault(fault: Option<Fault>, outcome: &mut Outcome) {
    let told = fault.map_or([0, 0, 0], |fault| {
        [fault.kind.number(), fault.quantity as u8, fault.index]
    });
    outcome.counts.extend(told.map(Count::Constant));
    let numbers = fault.map_or([0.0; 3], |fault| [fault.value, fault.min, fault.max]);
    outcome
        .numbers
        .extend(numbers.map(|number| carried(number).0));
}
