//! How often what was answered.

use std::fmt;

/// A column: its head, and the rows in which it must have a count: in the others it must not.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Column {
    head: String,
    possible: Vec<bool>,
}

/// Counts by row and column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    corner: &'static str,
    rows: &'static [&'static str],
    columns: Vec<Column>,
    /// Column by column.
    counts: Vec<u64>,
}

impl Table {
    /// No column, and what stands above the names of the rows.
    #[must_use]
    pub fn new(corner: &'static str, rows: &'static [&'static str]) -> Self {
        Self {
            corner,
            rows,
            columns: Vec::new(),
            counts: Vec::new(),
        }
    }

    /// With one more column, in which everything can be but these rows.
    #[must_use]
    pub fn with(mut self, head: impl Into<String>, impossible: &[usize]) -> Self {
        let possible = |row: usize| !impossible.contains(&row);
        self.columns.push(Column {
            head: head.into(),
            possible: (0..self.rows.len()).map(possible).collect(),
        });
        self.counts.resize(self.rows.len() * self.columns.len(), 0);
        self
    }

    /// Counts one.
    ///
    /// # Panics
    /// There is no such row or column.
    pub fn count(&mut self, row: usize, column: usize) {
        assert!(row < self.rows.len(), "row {row} of {:?}", self.rows);
        self.counts[column * self.rows.len() + row] += 1;
    }

    /// Adds the counts of the same table of another lane.
    pub(crate) fn add(&mut self, other: &Self) {
        for (count, more) in self.counts.iter_mut().zip(&other.counts) {
            *count += more;
        }
    }

    /// What occurred though it cannot be, or did not though it can.
    fn missing(&self) -> Option<String> {
        let columns = self.columns.iter().zip(self.counts.chunks(self.rows.len()));
        for (column, counts) in columns {
            for ((row, &possible), &count) in self.rows.iter().zip(&column.possible).zip(counts) {
                if (count > 0) != possible {
                    let head = &column.head;
                    return Some(format!("{}, {head}, {row}: {count} times", self.corner));
                }
            }
        }
        None
    }
}

/// The first answer of all tables that occurred though it cannot be, or did not though it can.
#[must_use]
pub fn missing(tables: &[Table]) -> Option<String> {
    tables.iter().find_map(Table::missing)
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:24}", self.corner)?;
        for column in &self.columns {
            write!(f, "{:>14}", column.head)?;
        }
        for (at, row) in self.rows.iter().enumerate() {
            write!(f, "\n{row:24}")?;
            let counts = self.counts.chunks(self.rows.len());
            for (column, counts) in self.columns.iter().zip(counts) {
                match column.possible[at] || counts[at] > 0 {
                    true => write!(f, "{:>14}", counts[at])?,
                    false => write!(f, "{:>14}", "-")?,
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_and_what_cannot_be_is_named() {
        let mut table = Table::new("read as", &["accepted", "code"])
            .with("state", &[])
            .with("command", &[1]);
        assert_eq!(
            missing(std::slice::from_ref(&table)).as_deref(),
            Some("read as, state, accepted: 0 times")
        );
        for (row, column) in [(0, 0), (1, 0), (0, 1)] {
            table.count(row, column);
        }
        assert_eq!(missing(std::slice::from_ref(&table)), None);
        let mut sum = table.clone();
        sum.add(&table);
        let shown = "read as                          state       command
accepted                             2             2
code                                 2             -";
        assert_eq!(sum.to_string(), shown);
        table.count(1, 1);
        assert_eq!(
            missing(&[sum, table]).as_deref(),
            Some("read as, command, code: 1 times")
        );
    }
}
