//! Differences between two CSV files, by line and column.

use super::difference::{Difference, short};

/// A column of both files.
struct Column<'a> {
    name: &'a str,
    /// Where it is in the base and in the new file.
    at: [usize; 2],
    /// Where it differs first, and both values.
    first: Option<(usize, &'a str, &'a str)>,
    /// How many lines differ.
    lines: usize,
}

/// What differs. Columns belong together by their name, so that one more can be excused.
pub fn differences(base: &str, new: &str) -> Vec<Difference> {
    let lines = [base, new].map(|text| text.split('\n').collect::<Vec<_>>());
    let headers = [&lines[0], &lines[1]].map(|lines| lines[0].split(',').collect::<Vec<_>>());
    let (mut columns, mut found) = columns(&headers);
    for (number, (base, new)) in (1..).zip(lines[0].iter().zip(&lines[1])).skip(1) {
        if base == new && headers[0] == headers[1] {
            continue;
        }
        let cells = [base, new].map(|line| line.split(',').collect::<Vec<_>>());
        let counts = [0, 1].map(|side| cells[side].len());
        if counts == [1, 1] && base == new {
            // The end of both files.
            continue;
        }
        if counts != [headers[0].len(), headers[1].len()] {
            let text = format!("line {number}: base {} cells, new {}", counts[0], counts[1]);
            found.push(Difference::nameless(text));
            break;
        }
        for column in &mut columns {
            let (base, new) = (cells[0][column.at[0]], cells[1][column.at[1]]);
            if base != new {
                column.first.get_or_insert((number, base, new));
                column.lines += 1;
            }
        }
    }
    if lines[0].len() != lines[1].len() {
        let (base, new) = (lines[0].len(), lines[1].len());
        found.push(Difference::nameless(format!(
            "base {base} lines, new {new}"
        )));
    }
    found.extend(columns.iter().filter_map(Column::difference));
    found
}

impl Column<'_> {
    fn difference(&self) -> Option<Difference> {
        let (line, base, new) = self.first?;
        let (name, lines) = (self.name, self.lines);
        let (base, new) = (short(base), short(new));
        Some(Difference {
            name: name.into(),
            text: format!(
                "line {line}, column {name}: base {base}, new {new}; lines that differ: {lines}"
            ),
        })
    }
}

/// The columns of both, and what is wrong with the others.
fn columns<'a>(headers: &[Vec<&'a str>; 2]) -> (Vec<Column<'a>>, Vec<Difference>) {
    let [base, new] = headers;
    let mut columns: Vec<Column<'a>> = Vec::new();
    let mut found = Vec::new();
    let alone = |name: &str, side: &str| Difference {
        name: name.into(),
        text: format!("column {name}: only in {side}"),
    };
    for (i, name) in base.iter().enumerate() {
        let same = (new.get(i) == Some(name)).then_some(i);
        match same.or_else(|| new.iter().position(|other| other == name)) {
            Some(j) => columns.push(Column {
                name,
                at: [i, j],
                first: None,
                lines: 0,
            }),
            None => found.push(alone(name, "base")),
        }
    }
    let more = new.iter().filter(|name| !base.contains(name));
    found.extend(more.map(|name| alone(name, "new")));
    if !columns.is_sorted_by_key(|column| column.at[1]) {
        found.push(Difference::nameless(
            "the columns are in another order".into(),
        ));
    }
    (columns, found)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CSV: &str = "t,q1,dq1\n0.0e0,1.5e0,2.0e0\n1.0e0,1.5e0,2.0e0\n2.0e0,1.5e0,2.0e0\n";

    fn texts(new: &str) -> Vec<String> {
        let found = differences(CSV, new);
        found.into_iter().map(|one| one.text).collect()
    }

    #[test]
    fn a_cell_is_found_by_line_and_column() {
        assert!(texts(CSV).is_empty());
        let new = CSV.replace("1.0e0,1.5e0", "1.0e0,1.6e0");
        assert_eq!(
            texts(&new),
            ["line 3, column q1: base 1.5e0, new 1.6e0; lines that differ: 1"]
        );
        assert_eq!(
            texts(&CSV.replace("2.0e0\n", "-2.0e0\n")),
            ["line 2, column dq1: base 2.0e0, new -2.0e0; lines that differ: 3"]
        );
    }

    #[test]
    fn a_column_more_is_found_and_the_others_are_compared() {
        let more = CSV.replace("t,q1", "t,s,q1").replace("e0,1.5", "e0,7,1.5");
        assert_eq!(texts(&more), ["column s: only in new"]);
        let changed = more.replace("1.0e0,7,1.5e0", "1.0e0,7,1.6e0");
        assert_eq!(
            texts(&changed),
            [
                "column s: only in new",
                "line 3, column q1: base 1.5e0, new 1.6e0; lines that differ: 1"
            ]
        );
        assert_eq!(
            texts(&CSV.replace("q1,dq1", "dq1,q1"))[0],
            "the columns are in another order"
        );
    }

    #[test]
    fn lines_and_cells_are_counted() {
        let shorter = CSV.trim_end();
        assert_eq!(texts(shorter), ["base 5 lines, new 4"]);
        let wider = CSV.replace("2.0e0,1.5e0,2.0e0", "2.0e0,1.5e0,2.0e0,3.0e0");
        assert_eq!(texts(&wider), ["line 4: base 3 cells, new 4"]);
        let ends = CSV.replace('\n', "\r\n");
        assert!(!texts(&ends).is_empty());
    }
}
