//! Proof that constructor and cycle cannot panic: on the target the panic handler
//! calls a function that does not exist, so that this image links only if no panic
//! is reachable from one to seven task rows in either precision. There is no
//! allocator either. On the host it runs what it links.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;

use controller_core::config::ControllerConfig;
use controller_core::controller::{Controller, ControllerState};
use controller_core::joint::Vector3;
use controller_core::measurement::{Measurement, Reference};
use controller_core::model::{ArmModel, LWR_IV};
use controller_core::record::Recorder;
use controller_core::task::{Axes, TaskReference};
use firmware::job::{self, JobKind};
use firmware::log::Number;

/// Whether levels on flange, elbow and wrist make a controller with `ROWS` rows whose
/// cycle is clean, everything unknown to the compiler but the number of rows.
fn exercise<T: Number, const ROWS: usize>() -> bool {
    let Ok(model) = ArmModel::<T>::new(black_box(&LWR_IV)) else {
        return false;
    };
    let mut config: ControllerConfig<T> = job::config(JobKind::TwoLevel);
    let mut flange = config.tasks.first().copied();
    config.tasks.clear();
    for level in 0..ROWS.div_ceil(3) {
        let Some(task) = flange.as_mut() else {
            return false;
        };
        // Three rows on the flange, three on the elbow, the rest on the wrist.
        task.point.link = 7 - 2 * (2 * level % 3);
        let rows = ROWS - 3 * level;
        task.axes = Axes {
            xyz: [true, rows > 1, rows > 2],
        };
        if config.tasks.push(*task).is_err() {
            return false;
        }
    }
    let Ok(controller) = Controller::new(&model, black_box(&config)) else {
        return false;
    };
    let q = JobKind::TwoLevel.start_deg().map(f64::to_radians);
    let measurement = black_box(Measurement {
        q: q.map(T::from_f64).into(),
        dq: [T::HALF; 7].into(),
        interval_s: T::from_f64(job::CYCLE_S),
    });
    let mut reference = Reference::new();
    reference.posture = measurement.q;
    let target = TaskReference::rest(Vector3::from([T::HALF; 3]));
    for _ in controller.tasks() {
        if reference.tasks.push(target).is_err() {
            return false;
        }
    }
    let reference = black_box(reference);
    let mut state = ControllerState::new();
    let mut recorder = Recorder::<T, 4>::new();
    let step = controller.step(&mut state, &measurement, &reference);
    recorder.push(&measurement, &step);
    state.applied(black_box(&step.torque));
    state.skip();
    state.reset();
    black_box(&recorder);
    step.status.fault.is_none() && controller.tasks().len() == ROWS.div_ceil(3)
}

/// Both precisions, every number of rows.
#[cfg_attr(target_os = "none", unsafe(no_mangle))]
#[allow(unsafe_code)] // the name of the entry
extern "C" fn exercise_all() -> bool {
    #[cfg(feature = "provoke-panic")]
    assert!(black_box([0.0; 7])[0] < 1.0, "wanted");
    fn precision<T: Number>() -> bool {
        exercise::<T, 1>()
            & exercise::<T, 2>()
            & exercise::<T, 3>()
            & exercise::<T, 4>()
            & exercise::<T, 5>()
            & exercise::<T, 6>()
            & exercise::<T, 7>()
    }
    precision::<f64>() & precision::<f32>()
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    if exercise_all() {
        println!("1 to 7 rows, f64 and f32: built and run");
        0.into()
    } else {
        eprintln!("a controller was refused or its cycle was not clean");
        1.into()
    }
}

#[cfg(target_os = "none")]
#[panic_handler]
#[allow(unsafe_code)]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_reachable() -> !;
    }
    // SAFETY: never linked.
    unsafe { a_panic_is_reachable() }
}
