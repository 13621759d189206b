//! Time of a control cycle and of its stages on this machine, by criterion:
//! `cargo bench -p controller-core`. Times move with the machine; what is held to a
//! figure is the instruction count, `benches/instructions.sh`.

mod cases;

use std::hint::black_box;
use std::time::Duration;

use cases::stages::{self as stage, STAGES, Stages};
use cases::{Case, levels, states};
use controller_core::controller::ControllerState;
use controller_core::observer::Observer;
use controller_core::real::Real;
use controller_core::record::Recorder;
use criterion::Criterion;

/// Whole cycles, over the random states in turn: denormal numbers, which the others
/// contain, take a PC much longer.
fn cycle<T: Real>(criterion: &mut Criterion, case: &Case<T>) {
    let states = states();
    let random = states.iter().filter(|input| input.kind == "random");
    let inputs: Vec<_> = random.map(|input| case.typed(input)).collect();
    let mut next = inputs.iter().cycle();
    let mut state = ControllerState::new();
    let mut recorder = Recorder::new();
    criterion.bench_function(&format!("{} step", case.name), |bencher| {
        bencher.iter(|| {
            let Some((measurement, reference)) = next.next() else {
                unreachable!("the states go round");
            };
            stage::step(
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

/// Every stage alone, in one state: its work does not depend on the data.
fn stages<T: Real>(criterion: &mut Criterion, case: &Case<T>) {
    let mut observer = Observer::new();
    let input = &states()[0];
    let at = Stages::run(case, &mut observer, input);
    let Case { model, config, .. } = case;
    let Stages {
        joints,
        reference,
        kinematics,
        dynamics,
        rows,
        hierarchy,
        motion,
        demand,
        torque,
        ..
    } = &at;
    let cycle = at.cycle();
    let mut group = criterion.benchmark_group(case.name.clone());
    let mut remaining = STAGES.iter();
    // In the order of STAGES, which gives the names.
    macro_rules! time {
        ($($function:ident($($argument:expr),*);)*) => {$(
            assert_eq!(remaining.next(), Some(&stringify!($function)));
            group.bench_function(stringify!($function), |bencher| {
                bencher.iter(|| stage::$function($(black_box($argument)),*));
            });
        )*};
    }
    time! {
        kinematics(model, joints);
        dynamics(model, kinematics, joints);
        cholesky_inside_dynamics(dynamics);
        observer_update(&mut observer, config, &dynamics.momentum);
        task_rows(config, reference, kinematics, joints);
        hierarchy(rows, dynamics);
        motion(dynamics, hierarchy, joints);
        command(config, (dynamics, rows, hierarchy, motion), joints, &reference.posture);
        demand(&cycle);
        limits(demand, model.torque_limit());
        observer_apply(&mut observer, dynamics, joints, torque);
    }
    assert_eq!(remaining.next(), None, "every stage is timed");
    group.finish();
}

fn main() {
    // Half a second and two for each of 26 figures: about a minute in all.
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    cycle(&mut criterion, &levels::<f64>(2));
    cycle(&mut criterion, &levels::<f64>(3));
    cycle(&mut criterion, &levels::<f32>(2));
    cycle(&mut criterion, &levels::<f32>(3));
    stages(&mut criterion, &levels::<f64>(3));
    stages(&mut criterion, &levels::<f32>(3));
    criterion.final_summary();
}
