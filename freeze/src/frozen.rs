//! A controller that was recorded and laid out, ready to be written.

use std::collections::HashSet;

use crate::layout::{Body, lay_out};
use crate::tape::{Precision, Tape};
use crate::trace::{Field, Program};

/// A controller that was recorded and laid out.
#[derive(Debug)]
pub struct Frozen {
    pub(crate) precision: Precision,
    about: [String; 3],
    pub(crate) tape: Tape,
    pub(crate) program: Program,
    pub(crate) bodies: Bodies,
    kept: HashSet<String>,
}

/// Functions as they are written.
#[derive(Debug)]
pub(crate) struct Bodies {
    /// What of an input is looked at, one after the other until there is a fault.
    pub admit: Vec<Body>,
    pub cycle: Body,
    /// The cycle after a fault.
    pub brake: Body,
}

impl Bodies {
    /// All of them.
    fn all(&self) -> impl Iterator<Item = &Body> {
        self.admit.iter().chain([&self.cycle, &self.brake])
    }
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
    pub(crate) fn new(
        precision: Precision,
        about: [String; 3],
        tape: Tape,
        program: Program,
    ) -> Self {
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

    /// Operations of the functions, those of seldom paths included.
    #[must_use]
    pub fn operations(&self) -> usize {
        self.bodies.all().map(|body| body.operations).sum()
    }

    /// Lines at the head of the file, but for the hash of what follows.
    pub(crate) fn header(&self) -> Vec<String> {
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
    pub(crate) fn parameters(&self) -> Vec<&Field> {
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
    pub(crate) fn state(&self) -> Vec<&Field> {
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
