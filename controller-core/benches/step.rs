//! Time of a control cycle and of its stages on this machine, by criterion:
//! `cargo bench -p controller-core`. Times move with the machine; what is held to a
//! figure is the instruction count, `benches/instructions.sh`.

mod cases;

use std::hint::black_box;
use std::time::Duration;

use arms::LWR_IV;
use cases::stages::{resolve, stage, step};
use cases::{Case, levels, states};
use controller_core::cycle::record::Recorder;
use controller_core::cycle::{Data, Input};
use controller_core::real::Real;
use controller_core::resolver::ResolverState;
use controller_core::{Controller, State};
use criterion::Criterion;

/// Whole cycles, over the random states in turn: denormal numbers, which the others
/// contain, take a PC much longer.
fn cycle<T: Real>(criterion: &mut Criterion, case: &Case<T>) {
    let states = states(&LWR_IV);
    let random = states.iter().take(cases::RANDOM);
    let inputs: Vec<_> = random.map(|input| case.typed(input)).collect();
    let mut next = inputs.iter().cycle();
    let mut state = State::new();
    let mut recorder = Recorder::new();
    criterion.bench_function(&format!("{} step", case.name), |bencher| {
        bencher.iter(|| {
            let Some((measurement, reference)) = next.next() else {
                unreachable!("the states go round");
            };
            // References of random places are no motion: joining them is another path.
            state.follow_at_once();
            step(
                black_box(&case.controller),
                &mut state,
                &mut recorder,
                measurement,
                reference,
            )
        });
    });
    assert!(state.fault().is_none(), "a cycle ended in a fault");
}

/// The velocity-level resolver on its own.
fn resolver<T: Real>(criterion: &mut Criterion, case: &Case<T>) {
    let (measurement, reference) = case.typed(&states(&LWR_IV)[0]);
    let mut state = ResolverState::new(measurement.q);
    criterion.bench_function(&format!("{} resolver", case.name), |bencher| {
        bencher.iter(|| {
            resolve(
                black_box(&case.resolver),
                &mut state,
                &measurement,
                &reference,
            )
        });
    });
    assert!(state.fault().is_none(), "a cycle ended in a fault");
}

/// Every stage alone, in one state: its work does not depend on the data.
fn stages<T: Real>(criterion: &mut Criterion, case: &Case<T>) {
    let (measurement, reference) = case.typed(&states(&LWR_IV)[0]);
    let input = Input {
        measurement: &measurement,
        reference: &reference,
    };
    let mut data = Data::new();
    case.controller.evaluate(&input, &mut data);
    let mut group = criterion.benchmark_group(case.name.clone());
    for (name, run) in Controller::<T>::STAGES {
        group.bench_function(name.text(), |bencher| {
            bencher.iter(|| stage(run, black_box(&case.controller), &input, &mut data));
        });
    }
    group.finish();
}

fn main() {
    // Half a second and two for each of 32 figures: about a minute in all.
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    cycle(&mut criterion, &levels::<f64>(2));
    cycle(&mut criterion, &levels::<f64>(3));
    cycle(&mut criterion, &levels::<f32>(2));
    cycle(&mut criterion, &levels::<f32>(3));
    resolver(&mut criterion, &levels::<f64>(3));
    resolver(&mut criterion, &levels::<f32>(3));
    stages(&mut criterion, &levels::<f64>(3));
    stages(&mut criterion, &levels::<f32>(3));
    criterion.final_summary();
}
