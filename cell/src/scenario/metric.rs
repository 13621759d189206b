//! Figures that a limit can name, and their units.

use super::level::LevelSpec;
use super::task::TaskSpec;
use crate::invalid::Invalid;

/// A figure that an acceptance limit can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// rms error of a level over all cycles.
    Rms(usize),
    /// Largest error of a level.
    Max(usize),
    /// Largest plateau of a level over the contacts.
    Plateau(usize),
}

impl Metric {
    /// From a name such as `level1_rms_mm`, or `level2_max_mrad` for an
    /// orientation; levels count from 1.
    ///
    /// # Errors
    /// The names that exist for these levels.
    pub fn parse(name: &str, levels: &[LevelSpec]) -> Result<Self, Invalid> {
        let mut known = Vec::new();
        for (index, level) in levels.iter().enumerate() {
            let unit = Unit::of(level.task).suffix();
            for (figure, metric) in [
                ("rms", Self::Rms(index)),
                ("max", Self::Max(index)),
                ("plateau", Self::Plateau(index)),
            ] {
                let full = format!("level{}_{figure}_{unit}", index + 1);
                if full == name {
                    return Ok(metric);
                }
                known.push(full);
            }
        }
        let known: Vec<_> = known.iter().map(String::as_str).collect();
        Err(Invalid::name("metric", name, &known))
    }
}

/// Unit of a level's error, a thousandth of its SI unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Position.
    Millimetre,
    /// Orientation.
    Milliradian,
}

impl Unit {
    /// The unit of a task.
    #[must_use]
    pub fn of(task: TaskSpec) -> Self {
        match task {
            TaskSpec::Position => Self::Millimetre,
            TaskSpec::Orientation => Self::Milliradian,
        }
    }

    /// "mm" or "mrad".
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Milliradian => "mrad",
        }
    }
}
