//! The control cycle of one arm and one set of tasks as a straight line, in Rust or C.
//!
//! The readable text of `controller-core` is run once on a scalar that records what is done with it
//! ([`scalar`]). What is recorded is written down as one file that needs no controller: arm, levels
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
//! on data, all paths are run ([`explore`]).
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

pub mod error;
pub mod explore;
pub mod layout;
pub mod nominal;
mod rust;
pub mod scalar;
pub mod tape;
pub mod trace;
mod write;

use std::collections::HashSet;

use controller_core::arm::ArmParameters;
use controller_core::cycle::MakeController;
use controller_core::{Controller, ControllerConfig};

pub use crate::error::FreezeError;
use crate::layout::{Body, lay_out};
use crate::nominal::Nominal;
use crate::scalar::Recorded;
pub use crate::tape::Precision;
use crate::tape::Tape;
use crate::trace::{Field, Program, trace};

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

/// A controller that was recorded and laid out.
#[derive(Debug)]
pub struct Frozen {
    precision: Precision,
    about: [String; 3],
    tape: Tape,
    program: Program,
    bodies: Bodies,
    kept: HashSet<String>,
}

/// Functions as they are written.
#[derive(Debug)]
pub struct Bodies {
    /// What of an input is looked at, one after the other until there is a fault.
    pub admit: Vec<Body>,
    /// The cycle.
    pub cycle: Body,
    /// The cycle after a fault.
    pub brake: Body,
}

impl Bodies {
    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &Body> {
        self.admit.iter().chain([&self.cycle, &self.brake])
    }
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

/// Fields that callers change, whether a cycle reads them or not.
const KEPT: [&str; 12] = [
    "applied_torque",
    "observer_input",
    "torque",
    "acts",
    "at_once",
    "holding_torque",
    "is_still",
    "is_unseen",
    "blind_s",
    "q",
    "seen",
    "started",
];

/// Operations of the longest piece of a cycle.
const LONGEST: usize = 300;

impl Frozen {
    /// What is remembered must be written, and what is written must be computed, which reads what
    /// is remembered: until there is no more.
    fn new(precision: Precision, about: [String; 3], tape: Tape, program: Program) -> Self {
        let mut kept: HashSet<String> = KEPT.iter().map(|name| (*name).to_string()).collect();
        let bodies = loop {
            let wanted = |to: &str| match to.strip_prefix("s.") {
                Some(field) => kept.contains(field_of(field)),
                None => true,
            };
            let body =
                |function, longest| lay_out(&tape, &program.searches, function, longest, &wanted);
            let whole = |function| body(function, usize::MAX);
            let bodies = Bodies {
                admit: program.admit.iter().map(whole).collect(),
                cycle: body(&program.cycle, LONGEST),
                brake: whole(&program.brake),
            };
            let mut more = kept.clone();
            for body in bodies.all() {
                let read = body.read.iter().filter_map(|name| name.strip_prefix("s."));
                more.extend(read.map(|name| field_of(name).to_string()));
            }
            if more.len() == kept.len() {
                break bodies;
            }
            kept = more;
        };
        Self {
            precision,
            about,
            tape,
            program,
            bodies,
            kept,
        }
    }

    /// The file in Rust: `no_std`, it needs the scalar of `controller-core` and nothing else of it.
    #[must_use]
    pub fn rust(&self) -> String {
        rust::write(self)
    }

    /// Operations of the functions, those of seldom paths included.
    #[must_use]
    pub fn operations(&self) -> usize {
        self.bodies.all().map(|body| body.operations).sum()
    }

    /// Lines at the head of the file, but for the hash of what follows.
    fn header(&self) -> Vec<String> {
        let [arm, job, precision] = &self.about;
        let version = env!("CARGO_PKG_VERSION");
        vec![
            format!("The control cycle of {arm}: {job}, {precision}."),
            "Written by `cargo xtask freeze` from the text of the cycle; do not edit.".to_string(),
            format!(
                "controller-core {version}, text {:016x}; {} operations.",
                controller_core::SOURCE,
                self.operations()
            ),
        ]
    }

    /// Parameters that are read.
    fn parameters(&self) -> Vec<&Field> {
        let read: HashSet<&str> = self
            .bodies
            .all()
            .flat_map(|body| &body.read)
            .filter_map(|name| name.strip_prefix("p."))
            .map(field_of)
            .collect();
        let fields = self.program.parameters.iter();
        fields
            .filter(|field| read.contains(field.name.as_str()))
            .collect()
    }

    /// What is remembered.
    fn state(&self) -> Vec<&Field> {
        let fields = self.program.state.iter();
        fields
            .filter(|field| self.kept.contains(&field.name))
            .collect()
    }
}

/// The array of an entry.
fn field_of(name: &str) -> &str {
    name.split_once('[').map_or(name, |(array, _)| array)
}
