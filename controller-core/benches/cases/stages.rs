//! A cycle, its stages and a cycle of the resolver, each behind a call of its own: callgrind counts these
//! functions by name, and the timer cannot see through them.

use controller_core::cycle::record::Recorder;
use controller_core::cycle::stages::Run;
use controller_core::cycle::{Data, Input};
use controller_core::real::Real;
use controller_core::resolver::{Resolution, Resolver, ResolverState};
use controller_core::{Controller, Measurement, Reference, State, Step};

#[inline(never)]
pub fn step<T: Real>(
    controller: &Controller<T>,
    state: &mut State<T>,
    recorder: &mut Recorder<T, 64>,
    measurement: &Measurement<T>,
    reference: &Reference<T>,
) -> Step<T> {
    let step = controller.step(state, measurement, reference);
    recorder.push(measurement, &step);
    step
}

#[inline(never)]
pub fn stage<T: Real>(
    run: Run<T>,
    controller: &Controller<T>,
    input: &Input<'_, T>,
    data: &mut Data<T>,
) {
    run(controller, input, data);
}

#[inline(never)]
pub fn resolve<T: Real>(
    resolver: &Resolver<T>,
    state: &mut ResolverState<T>,
    measurement: &Measurement<T>,
    reference: &Reference<T>,
) -> Resolution<T> {
    resolver.step(state, measurement, reference)
}
