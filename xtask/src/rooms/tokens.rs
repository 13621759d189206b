//! What is read off a few tokens: a path, the paths of a `use`, the type of an `impl`.

use std::fmt;

use proc_macro2::{Delimiter, Group, Ident, TokenStream, TokenTree};

/// A path as it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Way {
    /// Begins with `::`: another crate's.
    pub outside: bool,
    /// `crate`, `self` and `super` among them.
    pub segments: Vec<String>,
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start = if self.outside { "::" } else { "" };
        write!(f, "{start}{}", self.segments.join("::"))
    }
}

/// One path of a `use`.
#[derive(Clone, Debug, Default)]
pub struct Import {
    /// With the parts before the braces; of a glob, what is before `*`.
    pub way: Way,
    /// Under which name it is there afterwards; `*` of a glob.
    pub name: String,
    /// Where it ends.
    pub line: usize,
    /// Whether others see it.
    pub public: bool,
}

/// A module below.
#[derive(Debug)]
pub struct Child {
    /// Its name.
    pub name: String,
    /// Where that is.
    pub line: usize,
    /// Compiled for tests only.
    pub test: bool,
    /// None where it has a file of its own.
    pub body: Option<TokenStream>,
}

/// The path that begins at a word, and where it ends; generics in it are left out.
pub fn way(tokens: &[TokenTree], at: usize) -> (Way, usize) {
    let mut way = Way {
        outside: before(tokens, at, "::"),
        segments: Vec::new(),
    };
    let mut end = at;
    while let Some(TokenTree::Ident(name)) = tokens.get(end) {
        way.segments.push(text(name));
        end += 1;
        if punct(tokens, end, "::<") {
            end = behind_generics(tokens, end + 2);
        }
        if !punct(tokens, end, "::") || !matches!(tokens.get(end + 2), Some(TokenTree::Ident(_))) {
            break;
        }
        end += 2;
    }
    (way, end)
}

/// Where `<` is closed again.
pub fn behind_generics(tokens: &[TokenTree], at: usize) -> usize {
    let mut depth = 0;
    for end in at..tokens.len() {
        depth += i32::from(is(tokens.get(end), '<'));
        depth -= i32::from(is(tokens.get(end), '>') && !before(tokens, end, "-"));
        if depth == 0 {
            return end + 1;
        }
    }
    tokens.len()
}

/// The type of an `impl` by what is before its braces, and whether it is a trait's.
pub fn own_type(head: &[TokenTree]) -> (Option<Way>, bool) {
    let mut of_trait = false;
    let mut start = None;
    let mut at = 0;
    while let Some(token) = head.get(at) {
        match token {
            TokenTree::Ident(word) if word == "where" => break,
            TokenTree::Ident(word) if word == "for" => (of_trait, start) = (true, None),
            TokenTree::Ident(_) if start.is_none() => {
                let (own, end) = way(head, at);
                start = Some(own);
                at = end;
                continue;
            }
            token if is(Some(token), '<') => {
                at = behind_generics(head, at);
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    (start, of_trait)
}

/// All paths of a `use` behind what `start` has.
pub fn leaves(tokens: &[TokenTree], start: &Import, all: &mut Vec<Import>) {
    for part in tokens.split(|token| is(Some(token), ',')) {
        let mut leaf = start.clone();
        leaf.way.outside |= punct(part, 0, "::");
        let mut renamed = false;
        for token in part {
            match token {
                TokenTree::Ident(word) if word == "as" => renamed = true,
                TokenTree::Ident(name) if renamed => leaf.name = text(name),
                TokenTree::Ident(name) => {
                    leaf.line = line(name);
                    if name != "self" || leaf.way.segments.is_empty() {
                        leaf.name = text(name);
                        leaf.way.segments.push(text(name));
                    }
                }
                TokenTree::Punct(mark) if mark.as_char() == '*' => {
                    leaf.line = mark.span().start().line;
                    leaf.name = "*".into();
                }
                TokenTree::Group(group) => leaves(&inside(group), &leaf, all),
                _ => {}
            }
        }
        if !matches!(part.last(), None | Some(TokenTree::Group(_))) {
            all.push(leaf);
        }
    }
}

/// The module that is declared here.
pub fn child(tokens: &[TokenTree]) -> Option<Child> {
    match tokens {
        [TokenTree::Ident(word), TokenTree::Ident(name), end, ..] if word == "mod" => Some(Child {
            name: text(name),
            line: line(name),
            test: false,
            body: braces(Some(end)).map(Group::stream),
        }),
        _ => None,
    }
}

/// Whether an attribute begins here that leaves what follows to tests.
pub fn is_test(tokens: &[TokenTree], at: usize) -> bool {
    let (true, Some(TokenTree::Group(group))) = (is(tokens.get(at), '#'), tokens.get(at + 1))
    else {
        return false;
    };
    let attribute = group.stream().to_string();
    let mut words = attribute.split([' ', '(', ')', ',']);
    match words.next() {
        Some("cfg") => {
            let words: Vec<&str> = words.collect();
            words.contains(&"test") && !words.contains(&"not") && !words.contains(&"any")
        }
        first => first == Some("test"),
    }
}

/// Whether one of the attributes at the end is `macro_export`: then the macro is there at the
/// crate's root, wherever it is declared.
pub fn is_exported(before: &[TokenTree]) -> bool {
    let attributes = before.rchunks(2).map_while(|pair| match pair {
        [mark, TokenTree::Group(group)] if is(Some(mark), '#') => Some(group.stream().to_string()),
        _ => None,
    });
    attributes
        .into_iter()
        .any(|attribute| attribute == "macro_export")
}

/// Whether this `impl` or `trait` is an item and not part of a type.
pub fn begins_item(tokens: &[TokenTree], at: usize) -> bool {
    let before = at.checked_sub(1).map(|at| &tokens[at]);
    is(before, ';') || !matches!(before, Some(TokenTree::Punct(_)))
}

/// A small name that is not called.
pub fn is_variable(name: &Ident, next: Option<&TokenTree>) -> bool {
    let called = matches!(next, Some(TokenTree::Group(group))
        if group.delimiter() == Delimiter::Parenthesis);
    !called && !text(name).starts_with(char::is_uppercase)
}

/// Whether `'` is before it.
/// The tokens of a group.
pub fn inside(group: &Group) -> Vec<TokenTree> {
    group.stream().into_iter().collect()
}

/// The group, if it is one in braces.
pub fn braces(token: Option<&TokenTree>) -> Option<&Group> {
    match token {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => Some(group),
        _ => None,
    }
}

/// Whether it is this mark, one of those that `::` and the like consist of.
pub fn is(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == mark)
}

/// Whether these marks begin at `at`.
pub fn punct(tokens: &[TokenTree], at: usize, marks: &str) -> bool {
    marks
        .chars()
        .enumerate()
        .all(|(i, mark)| is(tokens.get(at + i), mark))
}

/// Whether these marks end before `at`.
pub fn before(tokens: &[TokenTree], at: usize, marks: &str) -> bool {
    at.checked_sub(marks.len())
        .is_some_and(|from| punct(tokens, from, marks))
}

/// `r#type` as `type`.
pub fn text(name: &Ident) -> String {
    name.to_string().trim_start_matches("r#").to_string()
}

/// The line where a name is, from 1.
pub fn line(name: &Ident) -> usize {
    name.span().start().line
}
