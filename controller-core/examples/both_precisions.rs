//! Instantiates the whole cycle in `f32` and `f64` for a bare-metal target, so
//! that a build of it proves that the core needs no operating system. On a host
//! it prints the torque of one cycle in both precisions.

#![cfg_attr(target_os = "none", no_std, no_main)]

use controller_core::config::ControllerConfig;
use controller_core::controller::{Controller, ControllerState};
use controller_core::joint::{JointVector, Vector3, diagonal};
use controller_core::kinematics::LinkPoint;
use controller_core::law::{NullDamping, NullSpace, Posture};
use controller_core::measurement::{Measurement, Reference};
use controller_core::model::{ArmModel, LWR_IV};
use controller_core::real::Real;
use controller_core::task::{Axes, Task, TaskReference};

/// Flange held above a compliant null space: torque of the first cycle \[Nm\], or
/// nothing where the configuration is refused.
fn first_torque<T: Real>(q: [f64; 7]) -> Option<[f64; 7]> {
    let model = ArmModel::<T>::new(&LWR_IV).ok()?;
    let flange = LinkPoint {
        link: 7,
        offset: Vector3::from([0.0, 0.0, 0.078].map(T::from_f64)),
    };
    let config = ControllerConfig {
        tasks: core::iter::once(Task::uniform(flange, Axes::XYZ, 400.0, 40.0)).collect(),
        null_space: NullSpace {
            stiffness: diagonal([20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2]),
            damping: NullDamping::Joint(diagonal([4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03])),
            posture: Posture::Constant,
        },
        observer_gain: JointVector::from([T::from_f64(50.0); 7]),
        cycle_s: T::from_f64(0.002),
        dead_cycles: 0,
    };
    let controller = Controller::new(&model, &config).ok()?;
    let q = JointVector::from(q.map(T::from_f64));
    let measurement = Measurement {
        q,
        dq: JointVector::from([T::ZERO; 7]),
        interval_s: T::from_f64(0.002),
    };
    let mut reference = Reference {
        posture: q,
        ..Reference::new()
    };
    let target = Vector3::from([-0.4, 0.1, 0.8].map(T::from_f64));
    reference.tasks.push(TaskReference::rest(target)).ok()?;
    let step = controller.step(&mut ControllerState::new(), &measurement, &reference);
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
