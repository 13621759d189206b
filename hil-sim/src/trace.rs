//! trace.csv: one row per cycle.

use std::io::{self, Write};

use cell::scenario::{LevelSpec, Scenario, TaskSpec};
use record::csv::Row;
use record::run::{CHANNELS, LEVEL_CHANNELS, Sample};

/// Writes rows as they come.
pub struct Trace<W: Write> {
    out: W,
    row: Row,
}

impl<W: Write> Trace<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn new(mut out: W, scenario: &Scenario) -> io::Result<Self> {
        let mut row = Row::default();
        row.names(CHANNELS, 0, &[]);
        for (number, level) in (1..).zip(&scenario.levels) {
            row.names(LEVEL_CHANNELS, number, &axes(level));
        }
        row.finish(&mut out)?;
        Ok(Self { out, row })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn push(&mut self, sample: &Sample) -> io::Result<()> {
        self.row.values(CHANNELS, sample);
        for level in &sample.levels {
            self.row.values(LEVEL_CHANNELS, level);
        }
        self.row.finish(&mut self.out)
    }

    /// The writer, with everything in it.
    pub fn finish(self) -> W {
        self.out
    }
}

/// About how many bytes the trace of a whole run has.
#[must_use]
pub fn expected_bytes(scenario: &Scenario) -> f64 {
    /// Mean length of a number with its comma.
    const NUMBER: usize = 23;
    let mut header = Vec::new();
    // Writing to memory does not fail.
    let _ = Trace::new(&mut header, scenario);
    let columns = 1 + header.iter().filter(|&&byte| byte == b',').count();
    (columns * NUMBER) as f64 * scenario.cycles() as f64
}

/// Names of the coordinates of a level.
fn axes(level: &LevelSpec) -> Vec<String> {
    match level.task {
        TaskSpec::Position => level.axes.chars().map(String::from).collect(),
        TaskSpec::Orientation => ["qw", "qx", "qy", "qz"].map(String::from).to_vec(),
    }
}
