//! What came out of a group of files, in a few lines.

use super::difference::Difference;

/// Lines for the differences of a group, about.
const LINES: usize = 10;

/// Files that are counted together.
pub struct Group<'a> {
    name: String,
    /// What is counted.
    unit: &'static str,
    ignore: &'a [String],
    /// How many were compared.
    pub count: usize,
    bytes: usize,
    /// With differences that nothing excuses, and those.
    differ: Vec<(String, Vec<Difference>)>,
    /// How many differ only where they may.
    excused: usize,
}

impl<'a> Group<'a> {
    /// An empty one.
    pub fn new(name: &str, unit: &'static str, ignore: &'a [String]) -> Self {
        Self {
            name: name.into(),
            unit,
            ignore,
            count: 0,
            bytes: 0,
            differ: Vec::new(),
            excused: 0,
        }
    }

    /// Takes the differences of a file of so many bytes.
    pub fn add(&mut self, file: &str, bytes: usize, found: Vec<Difference>) {
        self.bytes += bytes;
        let some = !found.is_empty();
        let left: Vec<Difference> = found
            .into_iter()
            .filter(|difference| !difference.excused(self.ignore))
            .collect();
        if !left.is_empty() {
            self.differ.push((file.into(), left));
        } else if some {
            self.excused += 1;
        }
    }

    /// Whether nothing differs but what may.
    pub fn equal(&self) -> bool {
        self.differ.is_empty()
    }

    /// The counts, then the first differences of as many files as fit; several of each
    /// where few files differ.
    pub fn lines(&self) -> Vec<String> {
        let (count, bytes, differ) = (self.count, self.bytes, self.differ.len());
        let mut head = format!(
            "{}: {count} {}, {bytes} bytes, {differ} differ",
            self.name, self.unit
        );
        if !self.ignore.is_empty() {
            head += &format!(", {} excused", self.excused);
        }
        let mut lines = vec![head];
        let share = (LINES / differ.max(1)).max(1);
        for (file, found) in self.differ.iter().take(LINES) {
            let shown = found.iter().take(share);
            lines.extend(shown.map(|difference| format!("  {file}: {}", difference.text)));
            if let (Some(last), Some(more @ 1..)) =
                (lines.last_mut(), found.len().checked_sub(share))
            {
                *last += &format!("; and {more} more");
            }
        }
        if let Some(more @ 1..) = differ.checked_sub(LINES) {
            lines.push(format!("  and {more} more {}", self.unit));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(names: &[&str]) -> Vec<Difference> {
        names
            .iter()
            .map(|name| Difference::at(name, "0", "1"))
            .collect()
    }

    #[test]
    fn differences_that_may_be_are_counted_apart() {
        let ignore = ["link".to_string()];
        let mut group = Group::new("paper", "files", &ignore);
        group.count = 2;
        group.add("a.json", 5, found(&["link.lost"]));
        assert!(group.equal());
        assert_eq!(
            group.lines(),
            ["paper: 2 files, 5 bytes, 0 differ, 1 excused"]
        );
        group.add("b.json", 6, found(&["link.lost", "seed"]));
        assert!(!group.equal());
        assert_eq!(
            group.lines(),
            [
                "paper: 2 files, 11 bytes, 1 differ, 1 excused",
                "  b.json: seed: base 0, new 1"
            ]
        );
    }

    #[test]
    fn a_file_has_all_lines_and_many_have_one_each() {
        let names: Vec<String> = (0..40).map(|i| format!("[{i}]")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut group = Group::new("paper", "files", &[]);
        group.add("0.json", 1, found(&names));
        let lines = group.lines();
        assert_eq!(lines.len(), 11);
        assert_eq!(lines[10], "  0.json: [9]: base 0, new 1; and 30 more");
        for i in 1..20 {
            group.add(&format!("{i}.json"), 1, found(&names));
        }
        let lines = group.lines();
        assert_eq!(lines.len(), 12);
        assert_eq!(lines[2], "  1.json: [0]: base 0, new 1; and 39 more");
        assert_eq!(lines[11], "  and 10 more files");
    }
}
