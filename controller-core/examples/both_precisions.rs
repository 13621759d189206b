//! Instantiates the whole cycle in `f32` and `f64` for a bare-metal target, so
//! that a build of it proves that the core needs no operating system. On a host
//! it prints the torque of one cycle in both precisions.

#![cfg_attr(target_os = "none", no_std, no_main)]

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use controller_core::joint::JointVector;
use controller_core::real::Real;
use controller_core::{
    Axes, Controller, ControllerConfig, Measurement, NullSpace, Reference, State, Target, Task,
    TaskGains, TaskSet,
};

/// Flange held above a compliant null space: torque of the first cycle \[Nm\], or
/// nothing where the configuration is refused.
fn first_torque<T: Real>(q: [f64; 7]) -> Option<[f64; 7]> {
    let gains = TaskGains::uniform(400.0, 40.0);
    let config = ControllerConfig {
        tasks: TaskSet::new(&[Task::position(LWR_IV_FLANGE, Axes::XYZ, gains)]).ok()?,
        null_space: NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING),
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
    let controller = Controller::<T>::new(&LWR_IV, &config).ok()?;
    let q = JointVector::from(q.map(T::from_f64));
    let measurement = Measurement {
        q,
        dq: JointVector::from([T::ZERO; 7]),
        interval_s: T::from_f64(0.002),
    };
    let target = Target::position([-0.4, 0.1, 0.8].map(T::from_f64));
    let reference = Reference::new([target], q);
    let step = controller.step(&mut State::new(), &measurement, &reference);
    Some(step.torque.map(Real::to_f64).into())
}

/// Start posture of the two-level experiment \[rad\].
const START: [f64; 7] = [0.0, 0.611, 0.0, -1.396, 0.349, 1.047, 0.0];

#[cfg(not(target_os = "none"))]
fn main() {
    println!("f64 {:?}", first_torque::<f64>(START));
    println!("f32 {:?}", first_torque::<f32>(START));
}

#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
extern "C" fn _start() -> ! {
    core::hint::black_box(first_torque::<f64>(core::hint::black_box(START)));
    core::hint::black_box(first_torque::<f32>(core::hint::black_box(START)));
    loop {}
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
