//! Which file uses what of which other file.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, TokenStream};
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Expr, Item, Pat, Token, Visibility};

use super::methods::{Methods, methods, things};
use super::resolve::{Found, resolve};
use super::syntax::{Way, chains, head, leaves, line, only_test, quoted, text};
use super::tree::{ModuleId, Thing, Tree};

/// Where a file uses another, and the path that is written there.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    pub line: usize,
    pub path: String,
}

/// From a file to another that it uses: all places, in the order of the text.
pub type Edges = BTreeMap<(String, String), BTreeSet<Place>>;

/// All edges of the package.
///
/// A path counts where it ends: at the file that declares what is named, whatever modules
/// it goes through. A module that is named is no use of its file; what is then taken
/// from it is one. No edge are `mod`, a re-export of what is below the module itself, and
/// calls of methods on anything but `self`: their types are not known here.
pub fn edges(tree: &Tree) -> Edges {
    let methods = methods(tree);
    let mut edges = Edges::new();
    for (id, module) in tree.modules.iter().enumerate() {
        if module.test {
            continue;
        }
        let mut uses = Uses {
            tree,
            methods: &methods,
            id,
            own: Vec::new(),
            bound: Vec::new(),
            edges: &mut edges,
        };
        for item in &module.items {
            uses.visit_item(item);
        }
    }
    edges
}

struct Uses<'a> {
    tree: &'a Tree,
    methods: &'a Methods,
    id: ModuleId,
    /// What `Self` is, block by block.
    own: Vec<Vec<Thing>>,
    /// Local variables, function by function.
    bound: Vec<BTreeSet<String>>,
    edges: &'a mut Edges,
}

impl Uses<'_> {
    fn add(&mut self, file: &str, line: usize, path: String) {
        let from = &self.tree.modules[self.id].file;
        if from != file {
            let places = self.edges.entry((from.clone(), file.to_string()));
            places.or_default().insert(Place { line, path });
        }
    }

    fn note(&mut self, way: &Way, line: usize) {
        if let [first, rest @ ..] = &way.segments[..]
            && first == "Self"
        {
            if let Some(name) = rest.first() {
                self.note_own(name, line, way.to_string());
            }
            return;
        }
        for found in resolve(self.tree, self.id, way) {
            let Found::Thing(thing, then) = found else {
                continue;
            };
            self.add(&self.tree.modules[thing.module].file, line, way.to_string());
            if let Some(files) = then.and_then(|then| self.methods.get(&(thing, then))) {
                for file in files {
                    self.add(file, line, way.to_string());
                }
            }
        }
    }

    /// A method of `Self`.
    fn note_own(&mut self, name: &str, line: usize, path: String) {
        let methods = self.methods;
        for thing in self.own.last().cloned().unwrap_or_default() {
            for file in methods
                .get(&(thing, name.to_string()))
                .into_iter()
                .flatten()
            {
                self.add(file, line, path.clone());
            }
        }
    }

    /// A name in a place where a local variable may be meant.
    fn note_unless_bound(&mut self, way: &Way, line: usize) {
        let bound = way
            .single()
            .is_some_and(|name| self.bound.iter().any(|names| names.contains(name)));
        if !bound {
            self.note(way, line);
        }
    }

    fn note_tokens(&mut self, tokens: TokenStream) {
        for chain in chains(tokens) {
            self.note_unless_bound(&chain.way, chain.line);
            if let Some(name) = chain.of_self {
                self.note_own(&name, chain.line, format!("self.{name}"));
            }
            self.note_macro(&chain.way, chain.line);
        }
    }

    fn note_macro(&mut self, way: &Way, line: usize) {
        if let Some(name) = way.single()
            && let Some(thing) = self.tree.textual_macro(self.id, name)
        {
            self.add(
                &self.tree.modules[thing.module].file,
                line,
                format!("{name}!"),
            );
        }
    }

    /// Whether a re-export shows what is in this module or below it.
    fn is_own(&self, way: &Way) -> bool {
        let found = resolve(self.tree, self.id, way);
        !found.is_empty()
            && found.iter().all(|found| match found {
                Found::Module(id) => self.tree.is_within(*id, self.id),
                Found::Thing(thing, _) => self.tree.is_within(thing.module, self.id),
                Found::Outside => false,
            })
    }

    fn in_function(&mut self, names: Bound, visit: impl FnOnce(&mut Self)) {
        self.bound.push(names.0);
        visit(self);
        self.bound.pop();
    }
}

impl<'ast> Visit<'ast> for Uses<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !only_test(head(item).0) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let private = match &item.vis {
            Visibility::Inherited => true,
            Visibility::Restricted(to) => to.path.is_ident("self"),
            _ => false,
        };
        for leaf in leaves(item) {
            let from = if leaf.glob {
                leaf.way.clone()
            } else {
                leaf.way.prefix()
            };
            if !private && self.is_own(&from) {
                continue;
            }
            if leaf.glob {
                for found in resolve(self.tree, self.id, &leaf.way) {
                    let module = match found {
                        Found::Module(id) => id,
                        Found::Thing(thing, _) => thing.module,
                        Found::Outside => continue,
                    };
                    let path = format!("{}::*", leaf.way);
                    self.add(&self.tree.modules[module].file, leaf.line, path);
                }
            } else {
                self.note(&leaf.way, leaf.line);
            }
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        self.own.push(things(self.tree, self.id, &item.self_ty));
        visit::visit_item_impl(self, item);
        self.own.pop();
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        self.own.push(Vec::new());
        visit::visit_item_trait(self, item);
        self.own.pop();
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        let mut names = Bound::default();
        names.visit_item_fn(item);
        self.in_function(names, |uses| visit::visit_item_fn(uses, item));
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if only_test(&item.attrs) {
            return;
        }
        let mut names = Bound::default();
        names.visit_impl_item_fn(item);
        self.in_function(names, |uses| visit::visit_impl_item_fn(uses, item));
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        let mut names = Bound::default();
        names.visit_trait_item_fn(item);
        self.in_function(names, |uses| visit::visit_trait_item_fn(uses, item));
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if let Some(first) = path.segments.first() {
            self.note(&Way::new(path), line(&first.ident));
        }
        visit::visit_path(self, path);
    }

    fn visit_expr_path(&mut self, item: &'ast syn::ExprPath) {
        let way = Way::new(&item.path);
        if let (None, Some(name)) = (&item.qself, item.path.get_ident()) {
            self.note_unless_bound(&way, line(name));
        } else {
            visit::visit_expr_path(self, item);
        }
    }

    fn visit_expr_call(&mut self, item: &'ast syn::ExprCall) {
        // A variable may have the name of the function that gives its value.
        if let Expr::Path(function) = &*item.func
            && let Some(name) = function.path.get_ident()
        {
            self.note(&Way::new(&function.path), line(name));
        }
        visit::visit_expr_call(self, item);
    }

    fn visit_expr_method_call(&mut self, item: &'ast syn::ExprMethodCall) {
        if matches!(&*item.receiver, Expr::Path(it) if it.path.is_ident("self")) {
            let name = text(&item.method);
            self.note_own(&name, line(&item.method), format!("self.{name}"));
        }
        visit::visit_expr_method_call(self, item);
    }

    fn visit_pat_ident(&mut self, item: &'ast syn::PatIdent) {
        if !is_variable(&item.ident) {
            let mut way = Way::default();
            way.segments.push(text(&item.ident));
            self.note(&way, line(&item.ident));
        }
        visit::visit_pat_ident(self, item);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        let way = Way::new(&item.path);
        let at = item.path.segments.first().map_or(0, |it| line(&it.ident));
        self.note(&way, at);
        self.note_macro(&way, at);
        match item.parse_body_with(Punctuated::<Expr, Token![,]>::parse_terminated) {
            Ok(list) => {
                for part in &list {
                    // What is parsed does not live as long as the tree.
                    Visit::visit_expr(self, part);
                }
            }
            Err(_) => self.note_tokens(item.tokens.clone()),
        }
    }

    fn visit_attribute(&mut self, item: &'ast syn::Attribute) {
        if let syn::Meta::List(list) = &item.meta
            && !list.path.is_ident("cfg")
        {
            self.note_tokens(list.tokens.clone());
            for (way, line) in quoted(list.tokens.clone()) {
                self.note(&way, line);
            }
        }
    }

    fn visit_vis_restricted(&mut self, _: &'ast syn::VisRestricted) {}
}

/// Names of local variables.
#[derive(Default)]
struct Bound(BTreeSet<String>);

impl<'ast> Visit<'ast> for Bound {
    fn visit_pat(&mut self, pattern: &'ast Pat) {
        if let Pat::Ident(item) = pattern
            && is_variable(&item.ident)
        {
            self.0.insert(text(&item.ident));
        }
        visit::visit_pat(self, pattern);
    }
}

/// Not a constant or a variant, by its first letter.
fn is_variable(name: &Ident) -> bool {
    !text(name).starts_with(char::is_uppercase)
}
