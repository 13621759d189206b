//! Methods whose `impl` is in another file than the type.

use std::collections::{BTreeMap, BTreeSet};

use syn::{ImplItem, Item, Type};

use super::resolve::{Found, resolve};
use super::syntax::{Way, text};
use super::tree::{ModuleId, Thing, Tree};

/// In which files methods and constants are that are not in the file of their type.
pub type Methods = BTreeMap<(Thing, String), BTreeSet<String>>;

/// Those of all types of the package.
pub fn methods(tree: &Tree) -> Methods {
    let mut all = Methods::new();
    for (id, module) in tree.modules.iter().enumerate() {
        let blocks = module.items.iter().filter_map(|item| match item {
            Item::Impl(block) if block.trait_.is_none() && !module.test => Some(block),
            _ => None,
        });
        for block in blocks {
            for thing in things(tree, id, &block.self_ty) {
                if tree.modules[thing.module].file == module.file {
                    continue;
                }
                for item in &block.items {
                    let name = match item {
                        ImplItem::Fn(item) => text(&item.sig.ident),
                        ImplItem::Const(item) => text(&item.ident),
                        _ => continue,
                    };
                    let files = all.entry((thing, name)).or_default();
                    files.insert(module.file.clone());
                }
            }
        }
    }
    all
}

/// What the name of a type stands for.
pub fn things(tree: &Tree, id: ModuleId, kind: &Type) -> Vec<Thing> {
    let Type::Path(kind) = kind else {
        return Vec::new();
    };
    let found = resolve(tree, id, &Way::new(&kind.path));
    let things = found.into_iter().filter_map(|found| match found {
        Found::Thing(thing, None) => Some(thing),
        _ => None,
    });
    things.collect()
}
