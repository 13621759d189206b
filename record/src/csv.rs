//! Channels as text: one header row, one row per sample, numbers with 17 significant
//! digits.

use std::fmt::Write as _;
use std::io::{self, Write};

use crate::channel::{Channel, Value};

/// A row on its way.
#[derive(Debug, Default)]
pub struct Row {
    text: String,
}

impl Row {
    /// Adds the column names of the channels that go into a file.
    pub fn names<S>(&mut self, channels: &[Channel<S>], level: usize, axes: &[String]) {
        for channel in channels.iter().filter(|channel| channel.place.is_in_file()) {
            for name in channel.names(level, axes) {
                self.separate();
                self.text += &name;
            }
        }
    }

    /// Adds the values of a sample, of the same channels.
    pub fn values<S>(&mut self, channels: &[Channel<S>], sample: &S) {
        for channel in channels.iter().filter(|channel| channel.place.is_in_file()) {
            (channel.values)(sample, &mut |value| self.push(value));
        }
    }

    fn push(&mut self, value: Value) {
        self.separate();
        // Writing to a String does not fail.
        let _ = match value {
            Value::Number(number) => write!(self.text, "{number:.16e}"),
            Value::Count(count) => write!(self.text, "{count}"),
            Value::Word(word) => self.text.write_str(&word),
            Value::Empty => Ok(()),
        };
    }

    fn separate(&mut self) {
        // An empty value at the start of a row would be no column: no record begins so.
        if !self.text.is_empty() {
            self.text.push(',');
        }
    }

    /// Writes the row and begins another.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(&mut self, out: &mut impl Write) -> io::Result<()> {
        self.text.push('\n');
        let written = out.write_all(self.text.as_bytes());
        self.text.clear();
        written
    }
}
