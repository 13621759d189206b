//! What a channel is: columns with a name, a unit and a meaning.

use controller_core::joint::DOF;

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// SI units.
    Number(f64),
    /// A count, a sign, or a set as bits.
    Count(i64),
    /// One word.
    Word(String),
    /// Nothing is known.
    Empty,
}

/// Takes values as they come.
pub type Sink<'a> = &'a mut dyn FnMut(Value);

/// One or more columns of a record of samples `S`.
pub struct Channel<S> {
    /// Name of the columns: `{joint}` stands for 1 to 7, `{row}` for a task row, `{level}`
    /// for the number of a level and `{axis}` for its axes.
    pub columns: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Where it goes.
    pub place: Place,
    /// Its values, as many as columns.
    pub values: fn(&S, Sink<'_>),
}

/// Where a channel goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Into the file of the run.
    File,
    /// Into the series of the report.
    Series,
    /// Into both.
    Both,
}

impl Place {
    /// Whether it goes into the file.
    #[must_use]
    pub fn is_in_file(self) -> bool {
        self != Self::Series
    }

    /// Whether the report has it.
    #[must_use]
    pub fn is_in_series(self) -> bool {
        self != Self::File
    }
}

impl<S> Channel<S> {
    /// The names of its columns: of level `level`, counted from 1, with the axes `axes`,
    /// where it belongs to a level.
    #[must_use]
    pub fn names(&self, level: usize, axes: &[String]) -> Vec<String> {
        let name = self.columns.replace("{level}", &level.to_string());
        let each = |mark: &str, values: &[String]| {
            let names = values.iter().map(|value| name.replace(mark, value));
            names.collect::<Vec<_>>()
        };
        let numbers: Vec<_> = (1..=DOF).map(|number| number.to_string()).collect();
        match () {
            () if name.contains("{joint}") => each("{joint}", &numbers),
            () if name.contains("{row}") => each("{row}", &numbers),
            () if name.contains("{axis}") => each("{axis}", axes),
            () => vec![name],
        }
    }

    /// How many columns it has with `axes` axes.
    #[must_use]
    pub fn width(&self, axes: usize) -> usize {
        match self.columns {
            columns if columns.contains("{joint}") || columns.contains("{row}") => DOF,
            columns if columns.contains("{axis}") => axes,
            _ => 1,
        }
    }

    /// A row of the table that describes the file.
    #[must_use]
    pub fn described(&self) -> String {
        let first = self.columns.replace("{level}", "N").replace("{axis}", "A");
        let columns = if first.contains("{joint}") {
            let [from, to] = ["1", "7"].map(|number| first.replace("{joint}", number));
            format!("`{from}` .. `{to}`")
        } else {
            format!("`{first}`")
        };
        format!("| {columns} | {} | {} |", self.unit, self.meaning)
    }
}

/// Numbers to a sink.
pub(crate) fn numbers(values: &[f64], sink: Sink<'_>) {
    for &value in values {
        sink(Value::Number(value));
    }
}
