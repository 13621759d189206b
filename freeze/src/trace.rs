//! The generic cycle run on the scalar that records: what may start it, the cycle itself, and the
//! cycle after a fault.

mod cycle;
mod inputs;
mod program;
mod tracer;

use controller_core::Controller;
use controller_core::cycle::Input;
use controller_core::cycle::parts::InputPart;

use self::cycle::{trace_brake, trace_cycle};
use self::inputs::{Parameters, decided, measurement, reference};
pub use self::program::{Field, Function, Program, Search};
use self::tracer::{Tracer, tell_fault};
use crate::nominal::Nominal;
use crate::scalar::Recorded;

/// Records a controller; `twin` is the same in double precision.
pub fn trace(
    controller: &mut Controller<Recorded>,
    twin: &Controller<f64>,
    nominal: &mut Nominal,
) -> Program {
    let mut parameters = Parameters::default();
    controller.visit(&mut parameters);
    let measurement = measurement(&nominal.measurement);
    let (reference, holds) = reference(&nominal.reference);
    let mut tracer = Tracer::new(controller, twin);
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
