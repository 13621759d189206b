//! What a module says, read off its tokens: the modules below it, imports, declarations, and
//! every path. Code and the tokens of macros are read alike.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Delimiter, Ident, TokenStream, TokenTree};

use super::tokens::{
    Child, Import, Way, before, begins_item, braces, child, inside, is, is_exported, is_test,
    is_variable, leaves, line, own_type, punct, text, way,
};

/// Keywords before a name that is declared.
const DECLARE: [&str; 8] = [
    "const", "enum", "fn", "static", "struct", "trait", "type", "union",
];

/// Attributes of serde whose value is a path in quotes.
const QUOTED: [&str; 4] = ["default", "deserialize_with", "serialize_with", "with"];

/// Where something is used.
#[derive(Debug)]
pub struct Use {
    /// With the type in the place of `self` and `Self`.
    pub way: Way,
    /// As it is written.
    pub shown: String,
    /// Where it begins.
    pub line: usize,
}

/// All of it but what is for tests only. What is declared or imported in a body counts in
/// the whole module.
#[derive(Debug, Default)]
pub struct Text {
    /// The modules below.
    pub children: Vec<Child>,
    /// All of `use`.
    pub imports: Vec<Import>,
    /// Names of everything that has one; a macro's also with `!`.
    pub declared: BTreeSet<String>,
    /// Names in each `enum`.
    pub variants: BTreeMap<String, BTreeSet<String>>,
    /// Names of macros that the crate's root shows.
    pub exported: BTreeSet<String>,
    /// Type and name of each method and constant that is no trait's.
    pub methods: Vec<(Way, String)>,
    /// Every path.
    pub uses: Vec<Use>,
}

/// Where tokens are.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// In no braces but a module's.
    Items,
    /// In a macro that is called there: names before `:`, `=` and braces may be declared.
    Macro,
    /// Directly in `impl` without a trait.
    Methods,
    /// Directly in `impl` or `trait` otherwise.
    Members,
    Body,
}

impl Text {
    /// Reads all tokens of a module.
    pub fn new(tokens: TokenStream) -> Self {
        let mut text = Self::default();
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        text.read(&tokens, Place::Items, None);
        text
    }

    fn read(&mut self, tokens: &[TokenTree], place: Place, own: Option<&Way>) {
        let inner = match place {
            Place::Macro => place,
            _ => Place::Body,
        };
        let mut at = 0;
        while at < tokens.len() {
            at = match &tokens[at] {
                TokenTree::Punct(_) if is_test(tokens, at) => self.skip(tokens, at),
                TokenTree::Punct(_) => at + 1,
                TokenTree::Literal(value) => self.literal(tokens, at, &value.to_string()),
                TokenTree::Group(group) => {
                    self.read(&inside(group), inner, own);
                    at + 1
                }
                TokenTree::Ident(word) => self.word(tokens, at, word, place, own),
            };
        }
    }

    /// Leaves an item out, but for the file that it may be in.
    fn skip(&mut self, tokens: &[TokenTree], at: usize) -> usize {
        let is_end = |token: &TokenTree| is(Some(token), ';') || braces(Some(token)).is_some();
        let length = tokens[at..].iter().position(is_end);
        let end = length.map_or(tokens.len(), |length| at + length + 1);
        let child = (at..end).find_map(|at| child(&tokens[at..end]));
        let for_tests = child.map(|child| Child {
            test: true,
            ..child
        });
        self.children.extend(for_tests);
        end
    }

    /// A path in quotes, as serde has it.
    fn literal(&mut self, tokens: &[TokenTree], at: usize, value: &str) -> usize {
        if before(tokens, at, "=")
            && let Some(TokenTree::Ident(key)) = tokens.get(at.wrapping_sub(2))
            && QUOTED.iter().any(|known| key == known)
        {
            let segments = value.trim_matches('"').split("::");
            let way = Way {
                segments: segments.map(str::to_string).collect(),
                ..Way::default()
            };
            self.uses.push(Use {
                shown: way.to_string(),
                way,
                line: line(key),
            });
        }
        at + 1
    }

    /// Takes what begins with a word; returns where the next thing begins.
    fn word(
        &mut self,
        tokens: &[TokenTree],
        at: usize,
        word: &Ident,
        place: Place,
        own: Option<&Way>,
    ) -> usize {
        // Raw names keep their `r#` here and are no keywords.
        match (word.to_string().as_str(), tokens.get(at + 1)) {
            ("use", next) if !is(next, '<') => self.import(tokens, at),
            ("mod", Some(TokenTree::Ident(_))) => {
                self.children.extend(child(&tokens[at..]));
                at + 3
            }
            ("impl" | "trait", _) if begins_item(tokens, at) => self.block(tokens, at, own),
            ("macro_rules", _) => {
                let name = tokens.get(at + 2).map(TokenTree::to_string);
                self.declared.extend(name.clone());
                let called = name.map(|name| format!("{name}!"));
                if is_exported(&tokens[..at]) {
                    self.exported.extend(called.clone());
                }
                self.declared.extend(called);
                at + 3
            }
            (keyword, Some(TokenTree::Ident(name)))
                if DECLARE.contains(&keyword)
                    && name != "fn"
                    && !before(tokens, at, "*")
                    && !before(tokens, at, "'") =>
            {
                match (place, own) {
                    (Place::Methods, Some(own)) => self.methods.push((own.clone(), text(name))),
                    (Place::Methods | Place::Members, _) => {}
                    _ => _ = self.declared.insert(text(name)),
                }
                if keyword == "enum"
                    && let Some(group) = tokens[at..].iter().find_map(|it| braces(Some(it)))
                {
                    let names = inside(group).into_iter().filter_map(|token| match token {
                        TokenTree::Ident(name) => Some(text(&name)),
                        _ => None,
                    });
                    self.variants.insert(text(name), names.collect());
                }
                at + 2
            }
            _ => self.path(tokens, at, word, place, own),
        }
    }

    /// `impl` or `trait` up to its end.
    fn block(&mut self, tokens: &[TokenTree], at: usize, own: Option<&Way>) -> usize {
        let length = tokens[at..]
            .iter()
            .position(|it| braces(Some(it)).is_some());
        let Some((length, group)) = length.and_then(|it| Some((it, braces(tokens.get(at + it))?)))
        else {
            return at + 1;
        };
        let head = &tokens[at + 1..at + length];
        self.read(head, Place::Body, own);
        let (own, place) = match &tokens[at] {
            TokenTree::Ident(word) if word == "trait" => (None, Place::Members),
            _ => match own_type(head) {
                (own, true) => (own, Place::Members),
                (own, false) => (own, Place::Methods),
            },
        };
        self.read(&inside(group), place, own.as_ref());
        at + length + 1
    }

    fn import(&mut self, tokens: &[TokenTree], at: usize) -> usize {
        let length = tokens[at..].iter().position(|it| is(Some(it), ';'));
        let end = length.map_or(tokens.len(), |length| at + length);
        let before = at.checked_sub(1).map(|at| &tokens[at]);
        let start = Import {
            public: match before {
                Some(TokenTree::Ident(word)) => word == "pub",
                Some(TokenTree::Group(group)) => group.delimiter() == Delimiter::Parenthesis,
                _ => false,
            },
            ..Import::default()
        };
        leaves(&tokens[at + 1..end], &start, &mut self.imports);
        end + 1
    }

    /// A path, unless it is a field, a variable of a macro, a lifetime, the name of a field, the
    /// end of `<T>::name`, or one small name that is not called: a local variable.
    fn path(
        &mut self,
        tokens: &[TokenTree],
        at: usize,
        word: &Ident,
        place: Place,
        own: Option<&Way>,
    ) -> usize {
        let (mut way, mut end) = way(tokens, at);
        let colon = punct(tokens, end, ":") && !punct(tokens, end, "::");
        let equals = punct(tokens, end, "=");
        let calls_macro = punct(tokens, end, "!") && !punct(tokens, end, "!=");
        let single = way.segments.len() == 1;
        if place == Place::Macro && (colon || equals || braces(tokens.get(end)).is_some()) {
            self.declared.extend(way.segments.first().cloned());
        }
        if calls_macro && let Some(name) = way.segments.last_mut() {
            name.push('!');
        }
        let mut shown = way.to_string();
        if single
            && word == "self"
            && is(tokens.get(end), '.')
            && let Some(TokenTree::Ident(name)) = tokens.get(end + 1)
        {
            way.segments = vec!["Self".into(), text(name)];
            shown = format!("self.{name}");
            end += 2;
        } else if single && (colon || !calls_macro && is_variable(word, tokens.get(end)))
            || before(tokens, at, ".") && !before(tokens, at, "..")
            || before(tokens, at, "$") && word != "crate"
            || before(tokens, at, ">::")
            || before(tokens, at, "'")
        {
            return end;
        }
        if way.segments[0] == "Self" {
            let Some(own) = own else { return end };
            way.segments.splice(..1, own.segments.clone());
        }
        self.uses.push(Use {
            way,
            shown,
            line: line(word),
        });
        if calls_macro
            && place == Place::Items
            && let Some(TokenTree::Group(group)) = tokens.get(end + 1)
        {
            self.read(&inside(group), Place::Macro, own);
            return end + 2;
        }
        end
    }
}
