//! trace.csv: one row per cycle, SI units, 17 significant digits.

use std::io::{self, Write};

use controller_core::joint::{DOF, JointState, JointVector};

use crate::scenario::{Scenario, TaskSpec};

/// What a row shows.
pub struct Row<'a> {
    /// Time \[s\].
    pub t_s: f64,
    /// True joint state.
    pub state: &'a JointState<f64>,
    /// Applied torque \[Nm\].
    pub torque: &'a JointVector<f64>,
    /// True tau_ext of (6) \[Nm\].
    pub tau_ext: &'a JointVector<f64>,
    /// r \[Nm\].
    pub residual: &'a JointVector<f64>,
    /// Desired and true coordinates of each level's axes, and the error norm \[m\].
    pub levels: &'a [LevelRow],
}

/// A level's part of a row.
#[derive(Clone, Debug, Default)]
pub struct LevelRow {
    /// Desired coordinates of its axes \[m\], or the desired quaternion.
    pub desired: Vec<f64>,
    /// True coordinates of its axes \[m\], or the true quaternion.
    pub actual: Vec<f64>,
    /// Norm of their difference \[m\], or of the orientation error \[rad\].
    pub error: f64,
}

/// Writes rows as they come.
pub struct Trace<W: Write> {
    out: W,
}

impl<W: Write> Trace<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn new(mut out: W, scenario: &Scenario) -> io::Result<Self> {
        write!(out, "t")?;
        for name in ["q", "dq", "tau", "tau_ext", "r"] {
            for joint in 1..=DOF {
                write!(out, ",{name}{joint}")?;
            }
        }
        for (number, level) in (1..).zip(&scenario.levels) {
            let coordinates: Vec<_> = match level.task {
                TaskSpec::Position => level.axes.chars().map(String::from).collect(),
                TaskSpec::Orientation => ["qw", "qx", "qy", "qz"].map(String::from).to_vec(),
            };
            for coordinate in &coordinates {
                write!(out, ",x{number}_des_{coordinate}")?;
            }
            for coordinate in &coordinates {
                write!(out, ",x{number}_{coordinate}")?;
            }
            write!(out, ",e{number}")?;
        }
        writeln!(out)?;
        Ok(Self { out })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn push(&mut self, row: &Row<'_>) -> io::Result<()> {
        write!(self.out, "{:.16e}", row.t_s)?;
        for vector in [
            &row.state.q,
            &row.state.dq,
            row.torque,
            row.tau_ext,
            row.residual,
        ] {
            self.values(vector.as_slice())?;
        }
        for level in row.levels {
            self.values(&level.desired)?;
            self.values(&level.actual)?;
            self.values(&[level.error])?;
        }
        writeln!(self.out)
    }

    fn values(&mut self, values: &[f64]) -> io::Result<()> {
        values
            .iter()
            .try_for_each(|value| write!(self.out, ",{value:.16e}"))
    }

    /// The writer, with everything in it.
    pub fn finish(self) -> W {
        self.out
    }
}
