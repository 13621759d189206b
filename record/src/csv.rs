//! Channels as text: one header row, one row per sample, numbers with 17 significant
//! digits.

use std::io::{self, Write};

use crate::channel::{Channel, Value};
use crate::decimal;

/// A row on its way.
#[derive(Debug, Default)]
pub struct Row {
    text: Vec<u8>,
}

impl Row {
    /// Adds the column names of the channels that go into a file.
    pub fn names<S>(&mut self, channels: &[Channel<S>], level: usize, axes: &[String]) {
        for channel in channels.iter().filter(|channel| channel.place.is_in_file()) {
            for name in channel.names(level, axes) {
                self.separate();
                self.text.extend_from_slice(name.as_bytes());
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
        match value {
            Value::Number(number) => decimal::push(&mut self.text, number),
            Value::Count(count @ 0..=9) => self.text.push(b'0' + count as u8),
            // Writing to memory does not fail.
            Value::Count(count) => drop(write!(self.text, "{count}")),
            Value::Word(word) => self.text.extend_from_slice(word.as_bytes()),
            Value::Empty => {}
        }
    }

    fn separate(&mut self) {
        // An empty value at the start of a row would be no column: no record begins so.
        if !self.text.is_empty() {
            self.text.push(b',');
        }
    }

    /// Writes the row and begins another.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(&mut self, out: &mut impl Write) -> io::Result<()> {
        self.text.push(b'\n');
        let written = out.write_all(&self.text);
        self.text.clear();
        written
    }
}
