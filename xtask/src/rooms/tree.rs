//! The modules of a crate and what is declared in each.

use std::collections::{BTreeMap, BTreeSet};

use syn::visit::{self, Visit};
use syn::{Expr, Item, ItemMod, Lit, Meta};

use super::packages::Package;
use super::syntax::{Way, declared, head, leaves, line, only_test, text};

/// Index of [`Tree::modules`].
pub type ModuleId = usize;

/// What is declared: module and place in the order of declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Thing {
    /// Where it is declared.
    pub module: ModuleId,
    number: usize,
}

/// What a name stands for.
#[derive(Clone, Debug)]
pub enum Name {
    Module(ModuleId),
    Thing(Thing),
    Import(Way),
}

/// A file, or a part of one between the braces of `mod`.
pub struct Module {
    /// Below `src`.
    pub file: String,
    /// None of a crate's root.
    pub parent: Option<ModuleId>,
    /// Of the crate it belongs to: a package with programs has several.
    pub root: ModuleId,
    /// Compiled for tests only.
    pub test: bool,
    /// Everything that has a name here, imports in bodies of functions too.
    pub names: BTreeMap<String, Vec<Name>>,
    /// What is before `*`.
    pub globs: Vec<Way>,
    /// Of `macro_rules!`: there in all modules below.
    pub macros: BTreeMap<String, Thing>,
    /// What a macro may have declared here.
    pub unknown: Thing,
    /// Everything but modules.
    pub items: Vec<Item>,
    /// Where files of its modules are.
    folder: String,
    things: usize,
}

/// All modules of a package.
#[derive(Default)]
pub struct Tree {
    pub modules: Vec<Module>,
    /// Of each `enum`.
    pub variants: BTreeMap<Thing, BTreeSet<String>>,
    /// Name and root of the library, which programs of the package name from outside.
    pub library: Option<(String, ModuleId)>,
    /// What is wrong with the tree itself.
    pub problems: Vec<String>,
}

impl Tree {
    /// Reads all files of the package.
    pub fn new(package: &Package) -> Self {
        let mut tree = Self::default();
        for root in &package.roots {
            let folder = folder_of(&root.file).to_string();
            let id = tree.add(None, &root.file, folder, false);
            if root.library {
                tree.library = Some((root.name.clone(), id));
            }
            tree.read(package, id);
        }
        let known: BTreeSet<&str> = tree.modules.iter().map(|it| it.file.as_str()).collect();
        let unknown = package
            .files
            .keys()
            .filter(|file| !known.contains(file.as_str()));
        let lines = unknown.map(|file| format!("{}: no `mod` names it", package.path(file)));
        tree.problems.extend(lines.collect::<Vec<_>>());
        tree
    }

    /// Files that are there not only for tests.
    pub fn files(&self) -> BTreeSet<&str> {
        let modules = self.modules.iter().filter(|module| !module.test);
        modules.map(|module| module.file.as_str()).collect()
    }

    /// The macro of this name that is there by the order of the text, not by a path.
    pub fn textual_macro(&self, from: ModuleId, name: &str) -> Option<Thing> {
        let mut here = Some(from);
        while let Some(module) = here.map(|id| &self.modules[id]) {
            if let Some(thing) = module.macros.get(name) {
                return Some(*thing);
            }
            here = module.parent;
        }
        None
    }

    /// Whether `module` is `ancestor` or below it.
    pub fn is_within(&self, module: ModuleId, ancestor: ModuleId) -> bool {
        let mut here = Some(module);
        while let Some(id) = here {
            if id == ancestor {
                return true;
            }
            here = self.modules[id].parent;
        }
        false
    }

    fn add(&mut self, parent: Option<ModuleId>, file: &str, folder: String, test: bool) -> usize {
        let id = self.modules.len();
        self.modules.push(Module {
            file: file.to_string(),
            parent,
            root: parent.map_or(id, |parent| self.modules[parent].root),
            test: test || parent.is_some_and(|parent| self.modules[parent].test),
            names: BTreeMap::new(),
            globs: Vec::new(),
            macros: BTreeMap::new(),
            unknown: Thing {
                module: id,
                number: 0,
            },
            items: Vec::new(),
            folder,
            things: 0,
        });
        id
    }

    fn read(&mut self, package: &Package, id: ModuleId) {
        let file = &self.modules[id].file;
        let path = package.path(file);
        match package.files.get(file).map(|text| syn::parse_file(text)) {
            Some(Ok(parsed)) => self.declare(package, id, parsed.items),
            Some(Err(error)) => {
                let line = error.span().start().line;
                self.problems.push(format!("{path}:{line}: {error}"));
            }
            None => self.problems.push(format!("{path}: not there")),
        }
    }

    fn declare(&mut self, package: &Package, id: ModuleId, items: Vec<Item>) {
        for item in items {
            let test = only_test(head(&item).0);
            match item {
                Item::Mod(module) => self.declare_module(package, id, module, test),
                _ if test => {}
                item => {
                    Names { tree: self, id }.visit_item(&item);
                    self.modules[id].items.push(item);
                }
            }
        }
    }

    fn declare_module(&mut self, package: &Package, id: ModuleId, item: ItemMod, test: bool) {
        let parent = &self.modules[id];
        let name = text(&item.ident);
        let inner = join(&parent.folder, &name);
        let child = if let Some((_, items)) = item.content {
            let file = parent.file.clone();
            let child = self.add(Some(id), &file, inner, test);
            self.declare(package, child, items);
            child
        } else {
            let explicit = item.attrs.iter().find_map(explicit_path);
            let candidates = match explicit {
                Some(path) => vec![join(folder_of(&parent.file), &path)],
                None => vec![format!("{inner}.rs"), format!("{inner}/mod.rs")],
            };
            let found = candidates
                .iter()
                .find(|file| package.files.contains_key(*file));
            let Some(file) = found else {
                let (path, line) = (package.path(&parent.file), line(&item.ident));
                self.problems
                    .push(format!("{path}:{line}: mod {name}: no file"));
                return;
            };
            let folder = match file.strip_suffix("mod.rs") {
                Some(folder) => folder.trim_end_matches('/').to_string(),
                None => file.trim_end_matches(".rs").to_string(),
            };
            let child = self.add(Some(id), file, folder, test);
            self.read(package, child);
            child
        };
        if !test {
            self.name(id, &name, Name::Module(child));
        }
    }

    fn name(&mut self, id: ModuleId, name: &str, what: Name) {
        let names = &mut self.modules[id].names;
        names.entry(name.to_string()).or_default().push(what);
    }

    fn thing(&mut self, id: ModuleId, name: &str) -> Thing {
        let module = &mut self.modules[id];
        module.things += 1;
        let thing = Thing {
            module: id,
            number: module.things,
        };
        self.name(id, name, Name::Thing(thing));
        thing
    }
}

/// Puts what an item declares into its module, what is in bodies too: names that are there
/// in one function only count in the whole module.
struct Names<'a> {
    tree: &'a mut Tree,
    id: ModuleId,
}

impl<'ast> Visit<'ast> for Names<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let (attributes, name) = head(item);
        if only_test(attributes) {
            return;
        }
        let thing = name.map(|name| (text(name), self.tree.thing(self.id, &text(name))));
        if let (Item::Enum(item), Some((_, thing))) = (item, &thing) {
            let names = item.variants.iter().map(|variant| text(&variant.ident));
            self.tree.variants.insert(*thing, names.collect());
        }
        if let Item::Macro(item) = item {
            for name in declared(item.mac.tokens.clone(), item.ident.is_none()) {
                self.tree.thing(self.id, &name);
            }
            if let Some((name, thing)) = thing {
                if item
                    .attrs
                    .iter()
                    .any(|it| it.path().is_ident("macro_export"))
                {
                    let root = self.tree.modules[self.id].root;
                    self.tree.name(root, &name, Name::Thing(thing));
                }
                self.tree.modules[self.id].macros.insert(name, thing);
            }
        }
        visit::visit_item(self, item);
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        for leaf in leaves(item) {
            if leaf.glob {
                self.tree.modules[self.id].globs.push(leaf.way);
            } else if let Some(name) = leaf.name {
                self.tree.name(self.id, &name, Name::Import(leaf.way));
            }
        }
    }

    fn visit_item_foreign_mod(&mut self, item: &'ast syn::ItemForeignMod) {
        for item in &item.items {
            match item {
                syn::ForeignItem::Fn(item) => self.tree.thing(self.id, &text(&item.sig.ident)),
                syn::ForeignItem::Static(item) => self.tree.thing(self.id, &text(&item.ident)),
                _ => continue,
            };
        }
    }
}

fn explicit_path(attribute: &syn::Attribute) -> Option<String> {
    match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("path") => match &pair.value {
            Expr::Lit(value) => match &value.lit {
                Lit::Str(path) => Some(path.value()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    }
}

fn folder_of(file: &str) -> &str {
    file.rsplit_once('/').map_or("", |(folder, _)| folder)
}

fn join(folder: &str, name: &str) -> String {
    if folder.is_empty() {
        name.to_string()
    } else {
        format!("{folder}/{name}")
    }
}
