//! Which thing a path names: imports, re-exports and globs are followed to the module
//! that declares it.

use super::syntax::Way;
use super::tree::{ModuleId, Name, Thing, Tree};

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// The path names a module.
    Module(ModuleId),
    /// A declaration, and the segment behind it: variant, method, constant.
    Thing(Thing, Option<String>),
    /// Of another crate.
    Outside,
}

/// Names that are looked up at the moment: imports may go round in a circle.
type Pending = Vec<(ModuleId, String)>;

/// What a path written in `from` names, in all namespaces. Empty where its first name is
/// not of this package.
pub fn resolve(tree: &Tree, from: ModuleId, way: &Way) -> Vec<Found> {
    walk(tree, from, way, &mut Vec::new())
}

fn walk(tree: &Tree, from: ModuleId, way: &Way, pending: &mut Pending) -> Vec<Found> {
    let Some((first, rest)) = way.segments.split_first() else {
        return vec![Found::Module(from)];
    };
    let mut here = match first.as_str() {
        _ if way.outside => library(tree, first),
        "crate" => vec![Found::Module(tree.modules[from].root)],
        "self" => vec![Found::Module(from)],
        "super" => above(tree, from),
        name => {
            let found = lookup(tree, from, name, pending);
            if found.is_empty() {
                library(tree, name)
            } else {
                found
            }
        }
    };
    for segment in rest {
        // A function may have the name of a module, but nothing is behind it.
        if here.iter().any(|it| matches!(it, Found::Module(_))) {
            here.retain(|it| matches!(it, Found::Module(_)));
        }
        let step = |place| match place {
            Found::Module(id) => behind(tree, id, segment, pending),
            Found::Thing(thing, then) => {
                vec![Found::Thing(thing, then.or_else(|| Some(segment.clone())))]
            }
            Found::Outside => vec![Found::Outside],
        };
        here = here.into_iter().flat_map(step).collect();
    }
    here
}

/// What `segment` is in a module. What is not found there is made by a macro.
fn behind(tree: &Tree, id: ModuleId, segment: &str, pending: &mut Pending) -> Vec<Found> {
    match segment {
        "self" => vec![Found::Module(id)],
        "super" => above(tree, id),
        name => {
            let found = lookup(tree, id, name, pending);
            if found.is_empty() {
                vec![Found::Thing(tree.modules[id].unknown, None)]
            } else {
                found
            }
        }
    }
}

fn lookup(tree: &Tree, id: ModuleId, name: &str, pending: &mut Pending) -> Vec<Found> {
    let asked = (id, name.to_string());
    if pending.contains(&asked) {
        return Vec::new();
    }
    pending.push(asked);
    let module = &tree.modules[id];
    let mut found = Vec::new();
    for what in module.names.get(name).into_iter().flatten() {
        match what {
            Name::Module(id) => found.push(Found::Module(*id)),
            Name::Thing(thing) => found.push(Found::Thing(*thing, None)),
            Name::Import(way) => {
                let places = walk(tree, id, way, pending);
                if places.is_empty() {
                    found.push(Found::Outside);
                }
                found.extend(places);
            }
        }
    }
    if found.is_empty() {
        for glob in &module.globs {
            for place in walk(tree, id, glob, pending) {
                match place {
                    Found::Module(id) => found.extend(lookup(tree, id, name, pending)),
                    Found::Thing(thing, None) if has_variant(tree, thing, name) => {
                        found.push(Found::Thing(thing, Some(name.to_string())));
                    }
                    Found::Thing(..) | Found::Outside => {}
                }
            }
        }
    }
    pending.pop();
    found
}

fn has_variant(tree: &Tree, kind: Thing, name: &str) -> bool {
    let variants = tree.variants.get(&kind);
    variants.is_some_and(|variants| variants.contains(name))
}

fn above(tree: &Tree, id: ModuleId) -> Vec<Found> {
    let parent = tree.modules[id].parent;
    parent.map(Found::Module).into_iter().collect()
}

fn library(tree: &Tree, name: &str) -> Vec<Found> {
    match &tree.library {
        Some((known, root)) if known == name => vec![Found::Module(*root)],
        _ => Vec::new(),
    }
}
