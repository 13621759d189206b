//! Strict-priority torque control with null-space compliance for 7-joint arms.
//!
//! Several points of the arm follow references in strict priority, what they
//! leave free is a spring and damper, and external torque is estimated from
//! momentum and compensated where tasks are tracked.
//!
//! **Goals**: exact, bounded, readable. One call of [`Controller::step`] is one control
//! cycle: a measurement and a reference in, a finite torque within limits and a status
//! out. It never fails, never panics, allocates nothing and iterates a number of times
//! that depends on the configuration only. A motion that cannot be meant cannot be
//! written down: it does not compile, is refused at construction, or is a fault.
//!
//! **Not a goal**: a framework, other joint counts, speed at the cost of a control
//! engineer being able to follow it.
//!
//! ```
//! use arms::{LWR_IV, LWR_IV_FLANGE};
//! use controller_core::{
//!     Axes, Controller, ControllerConfig, Measurement, NullSpace, Reference, State, Target,
//!     Task, TaskGains, TaskSet,
//! };
//!
//! # fn main() -> Result<(), controller_core::ConfigError> {
//! // Once: arm, tasks, gains. Everything is validated here.
//! let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
//! let controller = Controller::<f64>::new(&LWR_IV, &ControllerConfig {
//!     tasks: TaskSet::new(&[flange])?,
//!     null_space: NullSpace::diagonal(
//!         [20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2], // stiffness K_q, Nm/rad
//!         [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03],    // damping D, Nms/rad
//!     ),
//!     observer_gain: [50.0; 7], // K_I, 1/s
//!     cycle_s: 0.002,
//!     dead_cycles: 0,
//! })?;
//! let mut state = State::new();
//!
//! // Every cycle: what the robot reports, what it should do, the torque.
//! let q = [0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0];
//! let measurement = Measurement { q: q.into(), dq: [0.0; 7].into(), interval_s: 0.002 };
//! let reference = Reference::new([Target::position([-0.59, -0.02, 0.40])], q);
//! let step = controller.step(&mut state, &measurement, &reference);
//! assert!(step.status.is_clear());
//! # Ok(())
//! # }
//! ```
//!
//! # Map
//!
//! What a firmware engineer touches is here at the root; the mathematics is in modules,
//! bottom-up:
//!
//! - [`real`]: the scalar, `f32` or `f64`, with its own sine, cosine and
//!   exponential; [`joint`]: vectors, matrices and the joint state; [`linalg`]:
//!   Cholesky factor and triangular solves. [`ranges`]: what is allowed; [`gain`]: gain
//!   matrices; [`error`] and [`fault`]: what can be wrong, faults and limits by number.
//! - [`arm`]: tables and validated model, kinematics, dynamics: M, C, g of (6).
//! - [`task`]: what levels track, targets, the stacked rows, reference motions.
//! - [`law`]: all priorities from one factorisation, the torque demanded, the torque
//!   that may reach the motors.
//! - [`cycle`]: measurement, observer, the list of stages
//!   ([`Controller::STAGES`]), every result as [`cycle::Data`], the recorder of the last
//!   cycles, joint speeds for robots that report positions only.
//! - [`resolver`]: the same priorities on velocity level, for robots that take positions.
//!
//! Numbers in brackets are equations of Karami, Sadeghian, Keshmiri, Oriolo,
//! Mechatronics 55 (2018) 171-179. SI units, positions in the base-plate frame
//! with z up. Signs follow (6), M ddq + C dq + g = tau - tau_ext: the torque
//! tau_ext is what the arm exerts on its environment, and the residual r tends
//! to -tau_ext. docs/notation.md is the glossary, docs/hierarchy.md derives the
//! law, docs/architecture.md follows a cycle through these modules.
//!
//! Vectors and matrices are nalgebra's, under the names of [`joint`]; arrays turn into
//! them by `into()`. Whoever wants more of nalgebra takes it from here
//! ([`mod@nalgebra`]), so that the versions agree.

#![no_std]

pub mod arm;
pub mod cells;
pub mod cycle;
pub mod error;
pub mod fault;
pub mod gain;
pub mod joint;
pub mod law;
pub mod linalg;
pub mod ranges;
pub mod real;
pub mod resolver;
pub mod task;

pub use nalgebra;

/// Which text this crate was compiled from: files that were frozen from another one do not compile.
pub const SOURCE: u64 = {
    let (digits, mut source, mut i) = (env!("STRATUM_SOURCE").as_bytes(), 0, 0);
    while i < digits.len() {
        let digit = digits[i];
        let value = if digit <= b'9' {
            digit - b'0'
        } else {
            digit - b'a' + 10
        };
        source = source << 4 | value as u64;
        i += 1;
    }
    source
};

pub use arm::{Link, LinkFrame, LinkPoint};
pub use cycle::config::ControllerConfig;
pub use cycle::measurement::Measurement;
pub use cycle::{Change, ChangeError, Controller, MakeController, State, Step, Transition};
pub use error::ConfigError;
pub use fault::{Fault, Status};
pub use law::null_space::NullSpace;
pub use task::{Axes, Capacity, Order, Reference, Target, Task, TaskGains, TaskSet};

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
