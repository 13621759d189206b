//! Instructions, stack and sizes of a cycle on the Cortex-M7, printed as lines of
//! words for `cargo bench-m7`. The host prints the lines `inputs`, which must be the
//! same on the target: torques agree to the last bit on adverse inputs too.

#![cfg_attr(target_os = "none", no_std, no_main)]

use controller_core::{ConfigError, Controller, Measurement, Reference, Step};
use firmware::comparison;
use firmware::scenario::{self, FixedScenario};
use firmware::stages::{Clock, Rig, Survey};
use firmware::workload;
use frozen::FrozenCycle;

#[cfg(not(target_os = "none"))]
use std::println as say;

#[cfg(target_os = "none")]
use cortex_m_semihosting::hprintln as say;

/// Constructor and cycle with names of their own: where the stack is looked at.
macro_rules! measured {
    ($float:ident, $build:ident, $cycle:ident) => {
        #[inline(never)]
        fn $build(scenario: FixedScenario) -> Result<Controller<$float>, ConfigError> {
            scenario::controller(scenario)
        }

        #[inline(never)]
        fn $cycle(
            rig: &mut Rig<$float>,
            measurement: &Measurement<$float>,
            reference: &Reference<$float>,
        ) -> Step<$float> {
            rig.cycle(measurement, reference)
        }
    };
}

measured!(f64, build_f64, cycle_f64);
measured!(f32, build_f32, cycle_f32);

/// A frozen cycle behind a call.
macro_rules! frozen_cycle {
    ($name:ident, $cycle:ident) => {
        #[inline(never)]
        fn $name(
            cycle: &mut frozen::$cycle,
            input: &<frozen::$cycle as FrozenCycle>::Input,
        ) -> <frozen::$cycle as FrozenCycle>::Output {
            cycle.run(input)
        }
    };
}

frozen_cycle!(frozen_two_level_f64, TwoLevelF64);
frozen_cycle!(frozen_two_level_f32, TwoLevelF32);
frozen_cycle!(frozen_case_1_f64, Case1F64);
frozen_cycle!(frozen_case_1_f32, Case1F32);

/// All frozen cycles beside the generic ones. Whether all results are equal.
fn compare_frozen(clock: &impl Clock) -> bool {
    use FixedScenario::{Case1, TwoLevel};
    compare(clock, TwoLevel, "f64", build_f64, frozen_two_level_f64)
        & compare(clock, TwoLevel, "f32", build_f32, frozen_two_level_f32)
        & compare(clock, Case1, "f64", build_f64, frozen_case_1_f64)
        & compare(clock, Case1, "f32", build_f32, frozen_case_1_f32)
}

fn compare<F: FrozenCycle>(
    clock: &impl Clock,
    scenario: FixedScenario,
    precision: &str,
    build: fn(FixedScenario) -> Result<Controller<F::Number>, ConfigError>,
    run: fn(&mut F, &F::Input) -> F::Output,
) -> bool {
    let Ok(controller) = build(scenario) else {
        return false;
    };
    let mut cycle = F::NEW;
    let found = comparison::compare(&controller, &mut cycle, clock, run);
    say!(
        "frozen {} {} idle {} {} longest {} differing {} faults {}",
        scenario.name(),
        precision,
        found.idle.min,
        found.idle.max,
        found.all.max,
        found.differing,
        found.faults
    );
    found.differing == 0
}

fn print_inputs(name: &str, precision: &str, survey: &Survey) {
    say!(
        "inputs {} {} {} faults {} saturated {} released {} checksum {:016x}",
        name,
        precision,
        workload::COUNT,
        survey.faults,
        survey.saturated,
        survey.released,
        survey.checksum
    );
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    use firmware::stages::survey;

    /// The host counts nothing.
    struct Still;

    impl Clock for Still {
        fn ticks(&self) -> u32 {
            0
        }
        fn instructions(&self, ticks: u32) -> u32 {
            ticks
        }
    }

    for scenario in FixedScenario::ALL {
        if let Ok(mut rig) = build_f64(scenario).map(Rig::new) {
            print_inputs(scenario.name(), "f64", &survey(&mut rig, &Still, cycle_f64));
        }
        if let Ok(mut rig) = build_f32(scenario).map(Rig::new) {
            print_inputs(scenario.name(), "f32", &survey(&mut rig, &Still, cycle_f32));
        }
    }
    u8::from(!compare_frozen(&Still)).into()
}

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;
    use core::mem::size_of;

    use controller_core::State;
    use controller_core::arm::ArmModel;
    use controller_core::cycle::record::CycleRecord;
    use cortex_m_rt::entry;
    use firmware::log::Number;
    use firmware::mps2::{self, Counter, high_water, instructions};
    use firmware::stages::{Extremes, overhead, survey};
    use firmware::workload::Kind;

    use super::*;

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        mps2::panicked(info)
    }

    struct Board(Counter);

    impl Clock for Board {
        #[inline(always)]
        fn ticks(&self) -> u32 {
            self.0.ticks()
        }
        fn instructions(&self, ticks: u32) -> u32 {
            instructions(ticks)
        }
    }

    #[entry]
    fn main() -> ! {
        let board = Board(Counter::start());
        say!("calibration {}", overhead(&board));
        let mut complete = true;
        for scenario in FixedScenario::ALL {
            complete &= measure(scenario, &board, build_f64, cycle_f64);
            complete &= measure(scenario, &board, build_f32, cycle_f32);
        }
        complete &= compare_frozen(&board);
        sizes::<f64>();
        sizes::<f32>();
        mps2::exit(complete)
    }

    /// A full cycle behind a call.
    type CycleOf<T> = fn(&mut Rig<T>, &Measurement<T>, &Reference<T>) -> Step<T>;

    fn measure<T: Number>(
        scenario: FixedScenario,
        board: &Board,
        build: fn(FixedScenario) -> Result<Controller<T>, ConfigError>,
        cycle: CycleOf<T>,
    ) -> bool {
        let name = scenario.name();
        let init = high_water(|| {
            let _ = black_box(build(black_box(scenario)));
        });
        let Ok(mut rig) = build(scenario).map(Rig::new) else {
            return false;
        };
        let found = survey(&mut rig, board, cycle);
        print_inputs(name, T::NAME, &found);
        let print = |stage: &str, cost: &Extremes| {
            let worst = Kind::of(cost.at).0.name();
            let (min, max) = (cost.min, cost.max);
            say!(
                "cost {} {} {} {} {} {}",
                name,
                T::NAME,
                min,
                max,
                worst,
                stage
            );
        };
        print("cycle", &found.cycle);
        for (way, paths) in found.paths.iter().enumerate() {
            for (pivots, path) in paths.iter().enumerate().filter(|(_, path)| path.inputs > 0) {
                let (inputs, min, max) = (path.inputs, path.min, path.max);
                say!(
                    "path {} {} {} {} {} {} {}",
                    name,
                    T::NAME,
                    way,
                    pivots,
                    inputs,
                    min,
                    max
                );
            }
        }
        for ((stage, _), cost) in Controller::<T>::STAGES.iter().zip(&found.stages) {
            print(stage.text(), cost);
        }
        let (measurement, _) = workload::input(&rig.controller, found.cycle.at);
        let (q, dq) = (measurement.q, measurement.dq);
        say!(
            "worst {} {} {} q {:?} dq {:?}",
            name,
            T::NAME,
            found.cycle.at,
            q.data.0,
            dq.data.0
        );

        let mut step = 0;
        for index in 0..workload::COUNT {
            // Every adverse input, every tenth of the others.
            if Kind::of(index).0 == Kind::Random && index % 10 != 0 {
                continue;
            }
            let (measurement, reference) = workload::input(&rig.controller, index);
            step = step.max(high_water(|| {
                black_box(cycle(
                    &mut rig,
                    black_box(&measurement),
                    black_box(&reference),
                ));
            }));
        }
        say!("stack {} {} init {} cycle {}", name, T::NAME, init, step);
        found.faults == 0
    }

    fn sizes<T: Number>() {
        say!(
            "size {} model {} controller {} state {} step {} record {}",
            T::NAME,
            size_of::<ArmModel<T>>(),
            size_of::<Controller<T>>(),
            size_of::<State<T>>(),
            size_of::<Step<T>>(),
            size_of::<CycleRecord<T>>()
        );
    }
}
