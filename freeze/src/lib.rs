//! The control cycle of one arm and one set of tasks as a straight line, in Rust or C.
//!
//! The readable text of `controller-core` is run once on a scalar that records what is done with it
//! (`scalar`). What is recorded is written down as one file that needs no controller: arm, levels
//! and law are fixed, gains, limits, references and the body of the last link stay inputs.
//!
//! ```text
//! Controller<Recorded> --trace--> Program --layout--> Body --write--> text
//!                        explore   numbers and flags,   who computes    rust, c
//!                                  every one once       what where
//! ```
//!
//! The order of operations is that of the text, so the bits are the same, up to the sign of a zero:
//! sums with an exact zero and products with an exact zero or one are left out. Where a path depends
//! on data, all paths are run (`explore`).
//!
//! A build script writes the file of its job anew for every build:
//!
//! ```no_run
//! # fn config() -> controller_core::ControllerConfig { unimplemented!() }
//! # let arm: &controller_core::arm::ArmParameters = unimplemented!();
//! use freeze::{Precision, Request, freeze};
//!
//! let frozen = freeze(&Request {
//!     arm,
//!     config: &config(),
//!     limits: true,
//!     precision: Precision::F64,
//!     job: "flange:xyz",
//! })
//! .expect("a controller that can be frozen");
//! let folder = std::env::var("OUT_DIR").expect("a build script");
//! std::fs::write(format!("{folder}/cycle.rs"), frozen.rust()).expect("a file");
//! ```

mod error;
mod explore;
mod frozen;
mod layout;
mod nominal;
mod rust;
mod scalar;
mod tape;
mod trace;
mod write;

use controller_core::arm::ArmParameters;
use controller_core::cycle::MakeController;
use controller_core::{Controller, ControllerConfig};

pub use crate::error::FreezeError;
pub use crate::frozen::Frozen;
use crate::nominal::Nominal;
use crate::scalar::Recorded;
pub use crate::tape::Precision;
use crate::trace::trace;

/// What is to be frozen.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The arm.
    pub arm: &'a ArmParameters,
    /// Levels, and gains to start with.
    pub config: &'a ControllerConfig,
    /// The law within limits, else the exact one.
    pub limits: bool,
    /// Of all numbers.
    pub precision: Precision,
    /// What it is for, in a word or two: it stands at the head of the file.
    pub job: &'a str,
}

/// Records a controller and lays it out.
///
/// # Errors
/// What about the configuration cannot be, or not be frozen.
pub fn freeze(request: &Request<'_>) -> Result<Frozen, FreezeError> {
    let Request { arm, config, .. } = *request;
    error::check(config)?;
    let make: [MakeController<f64>; 2] = [Controller::exact, Controller::new];
    let twin = make[usize::from(request.limits)](arm, config)?;
    let mut nominal = Nominal::find(&twin)?;
    tape::begin(request.precision);
    let make: [MakeController<Recorded>; 2] = [Controller::exact, Controller::new];
    let mut controller = make[usize::from(request.limits)](arm, config)?;
    let program = trace(&mut controller, &twin, &mut nominal);
    let law = if request.limits {
        "the law within limits"
    } else {
        "the exact law"
    };
    let about = [
        format!("{} with {law}", arm.name),
        request.job.to_string(),
        match request.precision {
            Precision::F32 => "single precision".to_string(),
            Precision::F64 => "double precision".to_string(),
        },
    ];
    Ok(Frozen::new(request.precision, about, tape::take(), program))
}
