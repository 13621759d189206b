//! Files that use each other, by whatever way round.

use std::collections::{BTreeMap, BTreeSet};

use super::edges::Edges;

/// The strongly connected components of more than one file, each in order of names.
pub fn circles(edges: &Edges) -> Vec<BTreeSet<String>> {
    let mut next: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (from, to) in edges.keys() {
        next.entry(from).or_default().push(to);
    }
    let mut search = Search {
        next: &next,
        seen: BTreeMap::new(),
        open: Vec::new(),
        found: Vec::new(),
    };
    for file in next.keys() {
        search.visit(file);
    }
    search.found.sort();
    search.found
}

/// By R. E. Tarjan, SIAM J. Comput. 1 (1972) 146-160.
struct Search<'a> {
    next: &'a BTreeMap<&'a str, Vec<&'a str>>,
    /// Number of each visited file, in order of visits.
    seen: BTreeMap<&'a str, usize>,
    /// Visited, and not yet in a component.
    open: Vec<&'a str>,
    found: Vec<BTreeSet<String>>,
}

impl<'a> Search<'a> {
    /// The lowest number of an open file that `file` reaches.
    fn visit(&mut self, file: &'a str) -> usize {
        if let Some(&number) = self.seen.get(file) {
            let open = self.open.contains(&file);
            return if open { number } else { usize::MAX };
        }
        let number = self.seen.len();
        self.seen.insert(file, number);
        let place = self.open.len();
        self.open.push(file);
        let mut lowest = number;
        for to in self.next.get(file).into_iter().flatten() {
            lowest = lowest.min(self.visit(to));
        }
        if lowest == number {
            let members = self.open.split_off(place);
            if members.len() > 1 {
                self.found
                    .push(members.into_iter().map(str::to_string).collect());
            }
        }
        lowest
    }
}
