//! The modules of a crate, and what a path in one of them names: imports, re-exports and
//! globs are followed to the module that declares it.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{LexError, TokenStream};

use super::packages::Package;
use super::text::Text;
use super::tokens::{Child, Way};

/// Index of [`Tree::modules`].
pub type ModuleId = usize;

/// What is declared: module and name.
pub type Thing = (ModuleId, String);

/// A file, or a part of one between the braces of `mod`.
#[derive(Debug, Default)]
pub struct Module {
    /// Below `src`.
    pub file: String,
    /// Compiled for tests only.
    pub test: bool,
    /// All that it says.
    pub text: Text,
    /// None of a crate's root.
    parent: Option<ModuleId>,
    /// Of the crate it belongs to: a package with programs has several.
    root: ModuleId,
    children: BTreeMap<String, ModuleId>,
    /// Where files of its modules are.
    folder: String,
}

/// All modules of a package.
#[derive(Debug, Default)]
pub struct Tree {
    /// Each behind the one that it is in.
    pub modules: Vec<Module>,
    /// What is wrong with the tree itself.
    pub problems: Vec<String>,
    /// Name and root of the library, which programs of the package name from outside.
    library: Option<(String, ModuleId)>,
}

/// What a path leads to.
#[derive(Clone, Debug, PartialEq)]
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

impl Tree {
    /// Reads all files of the package.
    pub fn new(package: &Package) -> Self {
        let mut tree = Self::default();
        for root in &package.roots {
            let folder = root.file.rsplit_once('/').map_or("", |(folder, _)| folder);
            let module = Module {
                file: root.file.clone(),
                folder: folder.into(),
                root: tree.modules.len(),
                ..Module::default()
            };
            if root.library {
                tree.library = Some((root.name.clone(), module.root));
            }
            tree.add(package, module, None);
        }
        let known: BTreeSet<&String> = tree.modules.iter().map(|it| &it.file).collect();
        let unknown = package.files.keys().filter(|file| !known.contains(file));
        let lines = unknown.map(|file| format!("{}: no `mod` names it", package.path(file)));
        tree.problems.extend(lines);
        tree
    }

    /// Files that are there not only for tests.
    pub fn files(&self) -> BTreeSet<&str> {
        let modules = self.modules.iter().filter(|module| !module.test);
        modules.map(|module| module.file.as_str()).collect()
    }

    /// Adds a module and those below it; without a body it is the whole file.
    fn add(&mut self, package: &Package, mut module: Module, body: Option<TokenStream>) {
        let path = package.path(&module.file);
        let tokens = body.unwrap_or_else(|| {
            let text = package.files.get(&module.file).map_or("", String::as_str);
            text.parse().unwrap_or_else(|error: LexError| {
                let line = error.span().start().line;
                self.problems.push(format!("{path}:{line}: {error}"));
                TokenStream::new()
            })
        });
        module.text = Text::new(tokens);
        let children = std::mem::take(&mut module.text.children);
        let id = self.modules.len();
        self.modules.push(module);
        for Child {
            name,
            line,
            test,
            body,
        } in children
        {
            let parent = &self.modules[id];
            let folder = [&parent.folder, &name].map(String::as_str).join("/");
            let folder = folder.trim_start_matches('/').to_string();
            let files = [format!("{folder}.rs"), format!("{folder}/mod.rs")];
            let mut files = files
                .into_iter()
                .filter(|it| package.files.contains_key(it));
            let file = match &body {
                Some(_) => Some(parent.file.clone()),
                None => files.next(),
            };
            let Some(file) = file else {
                self.problems
                    .push(format!("{path}:{line}: mod {name}: no file"));
                continue;
            };
            let test = test || parent.test;
            let module = Module {
                file,
                folder,
                test,
                root: parent.root,
                parent: Some(id),
                ..Module::default()
            };
            if !test {
                let child = self.modules.len();
                self.modules[id].children.insert(name, child);
            }
            self.add(package, module, body);
        }
    }

    /// Whether `module` is `ancestor` or below it.
    pub fn is_within(&self, module: ModuleId, ancestor: ModuleId) -> bool {
        self.ancestors(module).any(|id| id == ancestor)
    }

    /// The module and those that it is in, outward.
    fn ancestors(&self, module: ModuleId) -> impl Iterator<Item = ModuleId> {
        std::iter::successors(Some(module), |&id| self.modules[id].parent)
    }

    /// What a path written in `from` names, in all namespaces. Empty where its first name is
    /// not of this package.
    pub fn resolve(&self, from: ModuleId, way: &Way) -> Vec<Found> {
        self.walk(from, way, &mut Pending::new())
    }

    fn walk(&self, from: ModuleId, way: &Way, pending: &mut Pending) -> Vec<Found> {
        let Some((first, rest)) = way.segments.split_first() else {
            return vec![Found::Module(from)];
        };
        let library = || {
            let library = self.library.iter().filter(|(name, _)| name == first);
            library.map(|(_, root)| Found::Module(*root)).collect()
        };
        let mut here: Vec<Found> = match first.as_str() {
            _ if way.outside => library(),
            "crate" => vec![Found::Module(self.modules[from].root)],
            "self" | "super" => self.behind(from, first, pending),
            name if name.ends_with('!') && rest.is_empty() => {
                // By the order of the text, not by a path.
                let declares = |id: &ModuleId| self.modules[*id].text.declared.contains(name);
                match self.ancestors(from).find(declares) {
                    Some(id) => vec![Found::Thing((id, name.into()), None)],
                    None => self.lookup(from, name, pending),
                }
            }
            name => {
                let found = self.lookup(from, name, pending);
                if found.is_empty() { library() } else { found }
            }
        };
        for segment in rest {
            // A function may have the name of a module, but nothing is behind it.
            if here.iter().any(|it| matches!(it, Found::Module(_))) {
                here.retain(|it| matches!(it, Found::Module(_)));
            }
            let step = |place| match place {
                Found::Module(id) => self.behind(id, segment, pending),
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
    fn behind(&self, id: ModuleId, segment: &str, pending: &mut Pending) -> Vec<Found> {
        match segment {
            "self" => vec![Found::Module(id)],
            "super" => self.modules[id]
                .parent
                .map(Found::Module)
                .into_iter()
                .collect(),
            name => match self.lookup(id, name, pending) {
                found if found.is_empty() => vec![Found::Thing((id, name.into()), None)],
                found => found,
            },
        }
    }

    fn lookup(&self, id: ModuleId, name: &str, pending: &mut Pending) -> Vec<Found> {
        let asked = (id, name.to_string());
        if pending.contains(&asked) {
            return Vec::new();
        }
        let module = &self.modules[id];
        let mut found: Vec<Found> = (module.children.get(name).copied().map(Found::Module))
            .into_iter()
            .collect();
        let declares = |(other, it): &(ModuleId, &Module)| {
            *other == id && it.text.declared.contains(name)
                || it.root == id && it.text.exported.contains(name)
        };
        let declaring = self.modules.iter().enumerate().filter(declares);
        found.extend(declaring.map(|(id, _)| Found::Thing((id, name.into()), None)));
        pending.push(asked);
        for import in module.text.imports.iter().filter(|it| it.name == name) {
            match self.walk(id, &import.way, pending) {
                places if places.is_empty() => found.push(Found::Outside),
                places => found.extend(places),
            }
        }
        if found.is_empty() {
            for glob in module.text.imports.iter().filter(|it| it.name == "*") {
                for place in self.walk(id, &glob.way, pending) {
                    match place {
                        Found::Module(id) => found.extend(self.lookup(id, name, pending)),
                        Found::Thing(thing, None) if self.has_variant(&thing, name) => {
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

    fn has_variant(&self, (id, kind): &Thing, name: &str) -> bool {
        let variants = self.modules[*id].text.variants.get(kind);
        variants.is_some_and(|variants| variants.contains(name))
    }
}
