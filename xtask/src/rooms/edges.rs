//! Which file uses what of which other file, and which files use each other.

use std::collections::{BTreeMap, BTreeSet};

use super::tokens::{Import, Way};
use super::tree::{Found, ModuleId, Thing, Tree};

/// Where a file uses another, and the path that is written there.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// From 1.
    pub line: usize,
    /// As it is written.
    pub path: String,
}

/// From a file to another that it uses: all places, in the order of the text.
pub type Edges = BTreeMap<(String, String), BTreeSet<Place>>;

/// All edges of the package.
///
/// A path counts where it ends: at the file that declares what is named, whatever modules
/// it goes through. A module that is named is no use of its file; what is then taken
/// from it is one. No edge are `mod`, a re-export of what is below the module itself, and
/// calls of methods on anything but `self`: their types are not known here. Nor is a function
/// that is named without being called, where no `use` of its own brings it.
pub fn edges(tree: &Tree) -> Edges {
    let methods = methods(tree);
    let mut edges = Edges::new();
    for (id, module) in tree.modules.iter().enumerate().filter(|(_, it)| !it.test) {
        let mut note = |way: &Way, path: &str, line: usize| {
            let files = tree
                .resolve(id, way)
                .into_iter()
                .flat_map(|found| match found {
                    Found::Thing(thing, then) => {
                        // The block itself has named the type of `self`.
                        let of_self = ["self.", "Self"].iter().any(|it| path.starts_with(it));
                        let own = (!of_self).then_some(tree.modules[thing.0].file.as_str());
                        let mut files: Vec<&str> = own.into_iter().collect();
                        if let Some(more) = then.and_then(|then| methods.get(&(thing, then))) {
                            files.extend(more);
                        }
                        files
                    }
                    Found::Module(id) if path.ends_with('*') => {
                        vec![tree.modules[id].file.as_str()]
                    }
                    Found::Module(_) | Found::Outside => Vec::new(),
                });
            for file in files.filter(|file| *file != module.file) {
                let places = edges.entry((module.file.clone(), file.to_string()));
                let path = path.to_string();
                places.or_default().insert(Place { line, path });
            }
        };
        for import in module
            .text
            .imports
            .iter()
            .filter(|it| !is_own(tree, id, it))
        {
            let path = match import.name.as_str() {
                "*" => format!("{}::*", import.way),
                _ => import.way.to_string(),
            };
            note(&import.way, &path, import.line);
        }
        for place in &module.text.uses {
            note(&place.way, &place.shown, place.line);
        }
    }
    edges
}

/// In which files methods and constants are that are not in the file of their type.
fn methods(tree: &Tree) -> BTreeMap<(Thing, String), BTreeSet<&str>> {
    let mut all = BTreeMap::<_, BTreeSet<&str>>::new();
    for (id, module) in tree.modules.iter().enumerate().filter(|(_, it)| !it.test) {
        for (own, name) in &module.text.methods {
            for found in tree.resolve(id, own) {
                if let Found::Thing(thing, None) = found
                    && tree.modules[thing.0].file != module.file
                {
                    all.entry((thing, name.clone()))
                        .or_default()
                        .insert(&module.file);
                }
            }
        }
    }
    all
}

/// Whether this is a re-export of what is in the module or below it.
fn is_own(tree: &Tree, id: ModuleId, import: &Import) -> bool {
    let mut from = import.way.clone();
    if import.name != "*" {
        from.segments.pop();
    }
    let found = tree.resolve(id, &from);
    import.public
        && !found.is_empty()
        && found.iter().all(|found| match found {
            Found::Module(module) | Found::Thing((module, _), _) => tree.is_within(*module, id),
            Found::Outside => false,
        })
}

/// Sets of files that use each other, by whatever way round: each reaches all others along
/// edges, and itself.
pub fn circles(edges: &Edges) -> BTreeSet<BTreeSet<&str>> {
    let mut reach = BTreeMap::<&str, BTreeSet<&str>>::new();
    for (from, to) in edges.keys() {
        reach.entry(from).or_default().insert(to);
    }
    loop {
        let mut farther = reach.clone();
        for to in farther.values_mut() {
            let next: Vec<_> = to.iter().filter_map(|file| reach.get(file)).collect();
            to.extend(next.into_iter().flatten());
        }
        if farther == reach {
            break;
        }
        reach = farther;
    }
    let mut circles = BTreeSet::new();
    for (file, to) in &reach {
        let back = |other: &&str| reach.get(other).is_some_and(|it| it.contains(file));
        circles.insert(to.iter().copied().filter(back).collect());
    }
    circles.remove(&BTreeSet::new());
    circles
}
