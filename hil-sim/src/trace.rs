//! trace.csv: one row per cycle, SI units, 17 significant digits.

use std::io::{self, Write};

use controller_core::joint::DOF;

use crate::sample::Sample;
use cell::scenario::{Scenario, TaskSpec};

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
    pub fn push(&mut self, instant: &Sample<'_>) -> io::Result<()> {
        write!(self.out, "{:.16e}", instant.t_s)?;
        for vector in [
            &instant.state.q,
            &instant.state.dq,
            instant.torque,
            instant.tau_ext,
            instant.residual,
        ] {
            self.values(vector.as_slice())?;
        }
        for level in instant.levels {
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
