//! Time of a control cycle on this machine: median and worst of batches, per case.
//! `cargo bench -p controller-core`. Times move with the machine; what is held to a
//! figure is the instruction count, `benches/instructions.sh`.

mod cases;

use std::hint::black_box;
use std::time::Instant;

use cases::{Case, Input, levels, states};
use controller_core::controller::ControllerState;
use controller_core::real::Real;
use controller_core::record::Recorder;

/// Cycles that are timed together, and how often.
const BATCH: usize = 1_000;
const BATCHES: usize = 200;

fn time<T: Real>(case: &Case<T>, inputs: &[Input]) {
    let inputs: Vec<_> = inputs.iter().map(|input| case.typed(input)).collect();
    let mut state = ControllerState::new();
    let mut recorder = Recorder::<T, 64>::new();
    let mut next = inputs.iter().cycle();
    let mut nanoseconds: Vec<f64> = (0..BATCHES)
        .map(|_| {
            let start = Instant::now();
            for (measurement, reference) in next.by_ref().take(BATCH) {
                let controller = black_box(&case.controller);
                let step = controller.step(&mut state, black_box(measurement), reference);
                recorder.push(measurement, &step);
                black_box(&step);
            }
            start.elapsed().as_secs_f64() * 1e9 / BATCH as f64
        })
        .collect();
    nanoseconds.sort_by(f64::total_cmp);
    println!(
        "{:14} median {:7.0} ns, slowest batch {:7.0} ns",
        case.name,
        nanoseconds[BATCHES / 2],
        nanoseconds[BATCHES - 1],
    );
    assert!(state.fault().is_none(), "a cycle ended in a fault");
}

fn main() {
    let inputs = states();
    time(&levels::<f64>(2), &inputs);
    time(&levels::<f64>(3), &inputs);
    time(&levels::<f32>(2), &inputs);
    time(&levels::<f32>(3), &inputs);
}
