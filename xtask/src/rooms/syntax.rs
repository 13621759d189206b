//! What is read off the syntax alone: paths, leaves of `use`, chains of tokens in
//! macros, what is there for tests only.

use std::fmt;

use proc_macro2::{Delimiter, Ident, TokenStream, TokenTree};
use syn::ext::IdentExt;
use syn::punctuated::Punctuated;
use syn::{Attribute, Item, Meta, Token, UseTree};

/// Keywords before a name that a macro's tokens may declare.
const DECLARE: [&str; 9] = [
    "const", "enum", "fn", "mod", "static", "struct", "trait", "type", "union",
];

/// Attributes whose value is a path in quotes.
const QUOTED: [&str; 8] = [
    "default",
    "deserialize_with",
    "from",
    "into",
    "serialize_with",
    "skip_serializing_if",
    "try_from",
    "with",
];

/// A path as it is written.
#[derive(Clone, Debug, Default)]
pub struct Way {
    /// Begins with `::`: another crate's.
    pub outside: bool,
    /// `crate`, `self`, `super` and `Self` among them.
    pub segments: Vec<String>,
}

impl Way {
    /// Of a path in an expression, a type or a pattern.
    pub fn new(path: &syn::Path) -> Self {
        let segments = path.segments.iter().map(|segment| text(&segment.ident));
        Self {
            outside: path.leading_colon.is_some(),
            segments: segments.collect(),
        }
    }

    /// Without its last segment.
    pub fn prefix(&self) -> Self {
        let mut prefix = self.clone();
        prefix.segments.pop();
        prefix
    }

    /// The name, if it is nothing else.
    pub fn single(&self) -> Option<&str> {
        match &self.segments[..] {
            [name] if !self.outside => Some(name),
            _ => None,
        }
    }

    fn with(&self, name: &Ident) -> Self {
        let mut longer = self.clone();
        longer.segments.push(text(name));
        longer
    }
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start = if self.outside { "::" } else { "" };
        write!(f, "{start}{}", self.segments.join("::"))
    }
}

/// A name as it is declared, `r#type` as `type`.
pub fn text(name: &Ident) -> String {
    name.unraw().to_string()
}

/// The line of a name.
pub fn line(name: &Ident) -> usize {
    name.span().start().line
}

/// One path of a `use`.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// With the parts before the braces; of a glob, what is before `*`.
    pub way: Way,
    /// Under which name it is there afterwards: none of a glob, none of `as _`.
    pub name: Option<String>,
    /// Whether it ends with `*`.
    pub glob: bool,
    /// Where it ends.
    pub line: usize,
}

/// All paths of a `use`.
pub fn leaves(item: &syn::ItemUse) -> Vec<Leaf> {
    let start = Way {
        outside: item.leading_colon.is_some(),
        segments: Vec::new(),
    };
    let mut all = Vec::new();
    collect_leaves(&item.tree, &start, &mut all);
    all
}

fn collect_leaves(tree: &UseTree, before: &Way, all: &mut Vec<Leaf>) {
    let way = |name: &Ident| {
        if name == "self" && !before.segments.is_empty() {
            before.clone()
        } else {
            before.with(name)
        }
    };
    match tree {
        UseTree::Path(path) => collect_leaves(&path.tree, &before.with(&path.ident), all),
        UseTree::Group(group) => {
            for tree in &group.items {
                collect_leaves(tree, before, all);
            }
        }
        UseTree::Name(name) => {
            let way = way(&name.ident);
            all.push(Leaf {
                name: way.segments.last().cloned(),
                way,
                glob: false,
                line: line(&name.ident),
            });
        }
        UseTree::Rename(renamed) => {
            let name = text(&renamed.rename);
            all.push(Leaf {
                way: way(&renamed.ident),
                name: (name != "_").then_some(name),
                glob: false,
                line: line(&renamed.ident),
            });
        }
        UseTree::Glob(glob) => all.push(Leaf {
            way: before.clone(),
            name: None,
            glob: true,
            line: glob.star_token.spans[0].start().line,
        }),
    }
}

/// A path among tokens.
#[derive(Clone, Debug)]
pub struct Chain {
    /// As it is written, `$crate` as `crate`.
    pub way: Way,
    /// Where it begins.
    pub line: usize,
    /// The name of `self.name`.
    pub of_self: Option<String>,
}

/// All paths among tokens of a macro, in groups too. What they mean to the macro is not
/// known: names of fields that are given a value are left out, local variables are not.
pub fn chains(tokens: TokenStream) -> Vec<Chain> {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut all = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        match &tokens[at] {
            TokenTree::Group(group) => all.extend(chains(group.stream())),
            TokenTree::Ident(first) => {
                let start = at;
                let mut way = Way::default().with(first);
                while punct(&tokens, at + 1, "::") {
                    let Some(TokenTree::Ident(name)) = tokens.get(at + 3) else {
                        break;
                    };
                    way = way.with(name);
                    at += 3;
                }
                way.outside = before(&tokens, start, "::");
                if is_path(&tokens, start, at) {
                    if let (true, Some(TokenTree::Group(group))) =
                        (punct(&tokens, at + 1, "::"), tokens.get(at + 3))
                        && group.delimiter() == Delimiter::Brace
                    {
                        all.extend(inside(&way, group.stream()));
                        at += 3;
                    }
                    let of_self = match tokens.get(at + 2) {
                        Some(TokenTree::Ident(name))
                            if way.single() == Some("self") && punct(&tokens, at + 1, ".") =>
                        {
                            Some(text(name))
                        }
                        _ => None,
                    };
                    all.push(Chain {
                        way,
                        line: line(first),
                        of_self,
                    });
                }
            }
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
        at += 1;
    }
    all
}

/// Of a `use` among tokens: what is in the braces behind a path.
fn inside(way: &Way, group: TokenStream) -> Vec<Chain> {
    let mut inner = chains(group);
    for chain in &mut inner {
        chain.way.outside = way.outside;
        chain.way.segments.splice(0..0, way.segments.clone());
    }
    inner
}

/// Whether the names from `start` to `end` are a path: not a field or method, a variable of
/// the macro, a lifetime, the name of a field, the end of `<T>::name`.
fn is_path(tokens: &[TokenTree], start: usize, end: usize) -> bool {
    let field = before(tokens, start, ".") && !before(tokens, start, "..");
    let variable = before(tokens, start, "$")
        && !matches!(&tokens[start], TokenTree::Ident(name) if name == "crate");
    let named = start == end && punct(tokens, end + 1, ":") && !punct(tokens, end + 1, "::");
    let behind_type = before(tokens, start, ">::");
    !(field || variable || named || behind_type || before(tokens, start, "'"))
}

fn punct(tokens: &[TokenTree], at: usize, text: &str) -> bool {
    text.chars().enumerate().all(|(i, wanted)| {
        matches!(tokens.get(at + i), Some(TokenTree::Punct(is)) if is.as_char() == wanted)
    })
}

fn before(tokens: &[TokenTree], at: usize, text: &str) -> bool {
    at.checked_sub(text.len())
        .is_some_and(|from| punct(tokens, from, text))
}

/// Names that tokens of a macro may declare: those behind a keyword like `struct`; where a
/// macro is called, those before `:`, `=` and braces too.
pub fn declared(tokens: TokenStream, called: bool) -> Vec<String> {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut names = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Group(group) => names.extend(declared(group.stream(), called)),
            TokenTree::Ident(name) => {
                let keyword = at.checked_sub(1).is_some_and(|at| {
                    matches!(&tokens[at], TokenTree::Ident(word)
                        if DECLARE.iter().any(|known| word == known))
                });
                let colon = punct(&tokens, at + 1, ":") && !punct(&tokens, at + 1, "::");
                let braces = matches!(tokens.get(at + 1), Some(TokenTree::Group(group))
                    if group.delimiter() == Delimiter::Brace);
                if keyword || called && (colon || braces || punct(&tokens, at + 1, "=")) {
                    names.push(text(name));
                }
            }
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
    }
    names
}

/// Paths in quotes, as serde has them.
pub fn quoted(tokens: TokenStream) -> Vec<(Way, usize)> {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let paths = tokens.windows(3).filter_map(|three| match three {
        [
            TokenTree::Ident(key),
            TokenTree::Punct(is),
            TokenTree::Literal(value),
        ] if is.as_char() == '=' && QUOTED.iter().any(|known| key == known) => {
            let text = value.to_string();
            let path = syn::parse_str(text.trim_matches('"')).ok()?;
            Some((Way::new(&path), value.span().start().line))
        }
        _ => None,
    });
    paths.collect()
}

/// Whether this is compiled for tests only.
pub fn only_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let path = attribute.path();
        path.is_ident("test")
            || (path.is_ident("cfg")
                && attribute
                    .parse_args::<Meta>()
                    .is_ok_and(|condition| needs_test(&condition)))
    })
}

fn needs_test(condition: &Meta) -> bool {
    let parts = |list: &syn::MetaList| {
        list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated)
            .unwrap_or_default()
    };
    match condition {
        Meta::Path(path) => path.is_ident("test") || path.is_ident("doctest"),
        Meta::List(list) if list.path.is_ident("all") => parts(list).iter().any(needs_test),
        Meta::List(list) if list.path.is_ident("any") => {
            let parts = parts(list);
            !parts.is_empty() && parts.iter().all(needs_test)
        }
        _ => false,
    }
}

/// The attributes of an item, and the name under which it is there.
pub fn head(item: &Item) -> (&[Attribute], Option<&Ident>) {
    match item {
        Item::Const(item) => (&item.attrs, Some(&item.ident)),
        Item::Enum(item) => (&item.attrs, Some(&item.ident)),
        Item::ExternCrate(item) => (&item.attrs, None),
        Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
        Item::ForeignMod(item) => (&item.attrs, None),
        Item::Impl(item) => (&item.attrs, None),
        Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
        Item::Mod(item) => (&item.attrs, None),
        Item::Static(item) => (&item.attrs, Some(&item.ident)),
        Item::Struct(item) => (&item.attrs, Some(&item.ident)),
        Item::Trait(item) => (&item.attrs, Some(&item.ident)),
        Item::TraitAlias(item) => (&item.attrs, Some(&item.ident)),
        Item::Type(item) => (&item.attrs, Some(&item.ident)),
        Item::Union(item) => (&item.attrs, Some(&item.ident)),
        Item::Use(item) => (&item.attrs, None),
        _ => (&[], None),
    }
}
