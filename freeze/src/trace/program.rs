//! What is recorded of a controller.

use crate::explore::{Paths, Value};
use crate::tape::NumberId;

/// A part of a function whose path depends on data, and how many numbers were recorded before
/// what it leaves was merged.
#[derive(Debug)]
pub struct Region {
    pub number: u32,
    pub paths: Paths,
    pub recorded: NumberId,
}

/// Statements in a straight line with regions between, and what is left at the end by its place.
#[derive(Debug, Default)]
pub struct Function {
    /// Stages by how many numbers were recorded at their end.
    pub stages: Vec<(NumberId, &'static str)>,
    pub regions: Vec<Region>,
    pub left: Vec<(String, Value)>,
}

/// Numbers with which the search for the nearest acceleration is called.
#[derive(Debug, PartialEq)]
pub struct Search {
    pub given: Vec<NumberId>,
}

/// An array, or a flag, of what is kept or given.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub name: String,
    /// Values at the start; none of a flag that is down then, one of a flag that is up.
    pub values: Vec<f64>,
    pub is_flag: bool,
}

/// Everything that was recorded of a controller.
#[derive(Debug)]
pub struct Program {
    pub parameters: Vec<Field>,
    pub state: Vec<Field>,
    /// Whether each level tracks an orientation, by slots.
    pub orientations: Vec<bool>,
    /// What of an input is looked at, one after the other until there is a fault.
    pub admit: Vec<Function>,
    pub cycle: Function,
    pub brake: Function,
    pub searches: Vec<Search>,
}
