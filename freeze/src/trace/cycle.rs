//! The cycle, and the cycle after a fault, part by part.

use controller_core::cells::Cells;
use controller_core::cycle::Input;
use controller_core::cycle::parts::{BrakePart, Group, Part};
use controller_core::cycle::stages::StageName;
use controller_core::joint::DOF;

use super::inputs::decided;
use super::program::Search;
use super::tracer::{Place, Tracer, places_of, tell_fault};
use crate::explore::{Count, Value};
use crate::scalar::Recorded;
use crate::tape::{Condition, FlagId, NumberId, Operation, with};

/// What a cycle is from the measurement to what is remembered.
pub(super) fn trace_cycle(
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
                let found = Operation::Found { search, place };
                *value = Recorded(with(|tape| tape.number(found, 0.0)));
            }
        }
    }
    fn flag(&mut self, name: &'static str, value: &mut bool) {
        if name == "unresolved" {
            *value = self.decided(16);
        }
    }
    fn set(&mut self, name: &'static str, bits: &mut u8) {
        let first = match name {
            "at_least" => 0,
            "at_greatest" => 8,
            _ => return,
        };
        *bits = (0..7)
            .map(|bit| u8::from(self.decided(first + bit)) << bit)
            .sum();
    }
    fn count(&mut self, _: &'static str, _: &mut u8) {}
}

impl Found {
    fn decided(&self, place: u32) -> bool {
        let search = self.search;
        with(|tape| {
            let flag = tape.flag(Condition::Found { search, place }, false);
            tape.decide(flag)
        })
    }
}

/// What braking and holding an arm is.
pub(super) fn trace_brake(tracer: &mut Tracer<'_>, input: &Input<'_, Recorded>) {
    let brake = Place::Brake;
    let parts: [(BrakePart, &[Group]); 3] = [
        (BrakePart::Look, &[]),
        (
            BrakePart::Demand,
            &[Group::Joints, Group::HoldingTorque, Group::Demand],
        ),
        (BrakePart::Allowed, &[Group::Allocation]),
    ];
    for (part, groups) in parts {
        let mut writes = places_of(groups);
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
