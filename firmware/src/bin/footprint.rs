//! How much flash the core takes: constructor, cycle and record and nothing else, in
//! the precision that the features `footprint-f64` and `footprint-f32` choose, with the law
//! within limits or, by `footprint-exact`, the exact one. Built without a precision it is what
//! every image has; `cargo bench-m7` reports the difference.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(any(feature = "footprint-f64", feature = "footprint-f32"))]
mod core_of {
    use core::hint::black_box;

    use arms::LWR_IV;
    use controller_core::cycle::record::Recorder;
    use controller_core::joint::zeros;
    use controller_core::real::Real;
    use controller_core::{
        ConfigError, Controller, ControllerConfig, Measurement, NullSpace, Reference, State, Task,
        TaskSet,
    };

    /// Everything that a cycle needs, with nothing known to the compiler: whatever
    /// the configuration asks for has to be there.
    pub fn run<T: Real>(
        config: &ControllerConfig,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
    ) -> Result<(), ConfigError> {
        let make = if cfg!(feature = "footprint-exact") {
            Controller::exact
        } else {
            Controller::new
        };
        let controller = make(black_box(&LWR_IV), black_box(config))?;
        let mut state = State::new();
        let mut recorder = Recorder::<T, 4>::new();
        let step = controller.step(&mut state, black_box(measurement), black_box(reference));
        recorder.push(measurement, &step);
        state.set_applied_torque(black_box(&step.torque));
        state.resume_after_gap();
        state.reset();
        black_box((&state, &recorder));
        Ok(())
    }

    /// Bytes that no initialiser had to write: the caller's data are not the core's.
    pub fn all<T: Real>() -> Result<(), ConfigError> {
        const NO_TASKS: &[Task] = &[];
        let config = ControllerConfig {
            tasks: TaskSet::new(black_box(NO_TASKS))?,
            null_space: NullSpace::diagonal([0.0; 7], [0.0; 7]),
            observer_gain: [0.0; 7],
            cycle_s: 0.0,
            dead_cycles: 0,
        };
        let measurement = Measurement {
            q: zeros(),
            dq: zeros(),
            interval_s: T::ZERO,
        };
        run(
            black_box(&config),
            black_box(&measurement),
            black_box(&Reference::hold(0, zeros())),
        )
    }
}

fn everything() {
    #[cfg(feature = "footprint-f64")]
    let _ = core::hint::black_box(core_of::all::<f64>());
    #[cfg(feature = "footprint-f32")]
    let _ = core::hint::black_box(core_of::all::<f32>());
}

#[cfg(not(target_os = "none"))]
fn main() {
    everything();
    println!("a size is that of the image for the target");
}

#[cfg(target_os = "none")]
mod target {
    use cortex_m_rt::entry;

    #[entry]
    fn main() -> ! {
        super::everything();
        loop {
            cortex_m::asm::wfi();
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }
}
