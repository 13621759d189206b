use std::collections::BTreeMap;

use super::packages::{Package, Root};
use super::tree::Tree;
use super::{check, edges, graph, layers};

/// A package of these files; `lib.rs` and `main.rs` are its roots.
fn package(files: &[(&str, &str)]) -> Package {
    let roots = files.iter().filter_map(|(file, _)| match *file {
        "lib.rs" | "main.rs" => Some(Root {
            name: "small".into(),
            file: (*file).into(),
            library: *file == "lib.rs",
        }),
        _ => None,
    });
    let texts = files
        .iter()
        .map(|(file, text)| ((*file).into(), (*text).into()));
    Package {
        name: "small".into(),
        folder: "small/src".into(),
        roots: roots.collect(),
        files: texts.collect::<BTreeMap<String, String>>(),
    }
}

/// All edges, each with its paths in order of the text.
fn edges_of(files: &[(&str, &str)]) -> Vec<String> {
    let tree = Tree::new(&package(files));
    assert_eq!(tree.problems, Vec::<String>::new());
    let edges = edges::edges(&tree);
    let lines = edges.iter().map(|((from, to), places)| {
        let paths: Vec<&str> = places.iter().map(|place| place.path.as_str()).collect();
        format!("{from} -> {to}: {}", paths.join(" "))
    });
    lines.collect()
}

/// What is wrong with the files against this list of layers.
fn wrong(files: &[(&str, &str)], list: &str) -> Vec<String> {
    let sections = layers::parse(list).unwrap();
    check(&package(files), sections.first()).wrong
}

#[test]
fn two_files_that_use_each_other_are_a_circle() {
    let files = [
        ("lib.rs", "mod a;\nmod b;\nmod c;"),
        ("a.rs", "use crate::b::B;\npub struct A(B);"),
        ("b.rs", "\npub struct B;\nfn f() -> super::a::A { loop {} }"),
        ("c.rs", "use crate::a::A;\nfn f(_: A) {}"),
    ];
    let lines = [
        "small: circle of 2 files: a.rs, b.rs",
        "  a.rs -> b.rs",
        "    small/src/a.rs:1: crate::b::B",
        "  b.rs -> a.rs",
        "    small/src/b.rs:3: super::a::A",
    ];
    assert_eq!(wrong(&files, ""), lines);
    let summary = check(&package(&files), None).summary;
    assert_eq!(summary, "small: 4 files, 3 edges, no layers, 1 circles");
}

#[test]
fn a_re_export_hides_no_circle() {
    let files = [
        (
            "lib.rs",
            "pub mod a;\npub mod b;\npub use a::*;\npub use a::Kind::*;",
        ),
        ("a.rs", "mod inner;\npub use inner::{Kind, Y};"),
        (
            "a/inner.rs",
            "pub struct Y(crate::b::Z);\npub enum Kind { One }",
        ),
        ("b.rs", "pub struct Z;\nfn f(_: crate::Y) { crate::One }"),
    ];
    assert_eq!(
        edges_of(&files),
        [
            "a/inner.rs -> b.rs: crate::b::Z",
            "b.rs -> a/inner.rs: crate::One crate::Y"
        ]
    );
    assert_eq!(
        wrong(&files, "")[0],
        "small: circle of 2 files: a/inner.rs, b.rs"
    );
}

#[test]
fn children_that_use_each_other_through_their_parent_do_not_use_the_parent() {
    let files = [
        ("lib.rs", "pub mod parent;"),
        (
            "parent/mod.rs",
            "mod one;\npub(crate) mod two;\nmod three;\npub use one::{One, make as new};
             pub(crate) use self::three::*;",
        ),
        (
            "parent/one.rs",
            "pub struct One;\npub fn make() -> One { One }",
        ),
        (
            "parent/two.rs",
            "use super::One;\nfn f() -> One { super::new() }",
        ),
        ("parent/three.rs", "pub fn three(_: crate::parent::One) {}"),
        ("parent/unused.rs", ""),
    ];
    let files = &files[..5];
    assert_eq!(
        edges_of(files),
        [
            "parent/three.rs -> parent/one.rs: crate::parent::One",
            "parent/two.rs -> parent/one.rs: super::One One super::new",
        ]
    );
    assert_eq!(wrong(files, ""), Vec::<String>::new());
}

#[test]
fn a_parent_that_uses_what_it_shows_uses_the_child() {
    let files = [
        (
            "lib.rs",
            "mod child;\npub use child::Y;\npub fn f(_: Y) {}\npub struct X;",
        ),
        ("child.rs", "use super::X;\npub struct Y(X);"),
    ];
    assert_eq!(
        edges_of(&files),
        ["child.rs -> lib.rs: super::X X", "lib.rs -> child.rs: Y"]
    );
}

#[test]
fn a_path_without_use_goes_upward() {
    let files = [
        ("lib.rs", "mod low;\nmod high;"),
        (
            "low.rs",
            "fn f() -> f64 {\n    crate::high::g(1.0) + 2.0\n}",
        ),
        ("high/mod.rs", "mod part;\npub use part::g;"),
        ("high/part.rs", "pub fn g(x: f64) -> f64 { x }"),
    ];
    let list = "# bottom to top\n[small]\nbottom: low.rs\n\ntop: high/\nroot: lib.rs";
    let line = "small/src/low.rs:2: crate::high::g: bottom uses top above it, high/part.rs";
    assert_eq!(wrong(&files, list), [line]);
    let summary = check(&package(&files), layers::parse(list).unwrap().first()).summary;
    assert_eq!(
        summary,
        "small: 4 files, 1 edges, 3 layers, 1 upward edges, 0 circles"
    );
}

#[test]
fn paths_in_macros_count() {
    let files = [
        (
            "lib.rs",
            "#[macro_use]\nmod m;\nmod a;\nmod b;\nmod c;\nmod d;\nmod e;\n
             macro_rules! late { () => {}; }\nmod f;",
        ),
        (
            "m.rs",
            "#[macro_export]\nmacro_rules! made {\n    ($x:ident) => { $crate::a::A::new($x) };\n}\n
             made!{ pub struct Made; }",
        ),
        ("a.rs", "pub struct A;\npub const C: u8 = 0;"),
        ("b.rs", "fn f(a: u8) { assert_eq!(a, crate::a::C, \"{}\", super::c::text(a)); }"),
        ("c.rs", "pub fn text(_: u8) -> String { unparsed!(a => self::super::a::C; g = 1) }"),
        ("d.rs", "fn f() { crate::made!(x); unparsed! { use crate::{a::{C}}; .crate_field } }"),
        ("e.rs", "fn f(_: crate::m::Made) {}"),
        ("f.rs", "fn f() { late!() }"),
    ];
    assert_eq!(
        edges_of(&files),
        [
            "b.rs -> a.rs: crate::a::C",
            "b.rs -> c.rs: super::c::text",
            "c.rs -> a.rs: self::super::a::C",
            "d.rs -> a.rs: crate::a::C",
            "d.rs -> m.rs: crate::made!",
            "e.rs -> m.rs: crate::m::Made",
            "f.rs -> lib.rs: late!",
            "m.rs -> a.rs: crate::a::A::new",
        ]
    );
}

#[test]
fn what_a_macro_declares_is_found_through_a_re_export() {
    let files = [
        ("lib.rs", "pub mod codes;\nmod user;\npub use codes::*;"),
        (
            "codes.rs",
            "list! { ALL: Kind { ONE = 1, \"one\"; } }\nlist! { struct Made; }",
        ),
        (
            "user.rs",
            "use super::*;\nfn f(_: crate::Kind) { (crate::ALL, ONE, Made, crate::Unseen) }",
        ),
    ];
    assert_eq!(
        edges_of(&files),
        [
            "user.rs -> codes.rs: Made ONE crate::ALL crate::Kind",
            "user.rs -> lib.rs: super::* crate::Unseen",
        ]
    );
}

#[test]
fn every_form_of_use_is_followed() {
    let files = [
        ("lib.rs", "mod a;\nmod d;\nmod e;\nmod kind;\nmod x;"),
        ("a.rs", "pub mod b;\npub mod g;\npub fn c() {}"),
        ("a/b.rs", "pub struct B;"),
        ("a/g.rs", "pub struct G;\npub fn local() {}"),
        ("d.rs", "pub fn d() {}"),
        ("e.rs", "pub struct E;\npub fn e() {}"),
        ("kind.rs", "pub enum Kind { One, Two }"),
        (
            "x.rs",
            "mod y;
             use crate::{a::{b, c}, d as renamed};
             use super::e as _;
             use self::y::Y;
             use super::a::g::*;
             fn f(_: b::B, _: Y, _: G) { c(); renamed::d(); let local = 1; h(local) }
             fn h(_: u8) { use crate::kind::Kind::*; match One { One => {}, Two => {} } }
             fn i() { use super::e::{self, E as Named}; e::e();\n let _: Named; }
             fn j() { local() }
             fn k(n: std::fmt::Error, d: ::d::D, r#gen: <u8 as crate::t::T>::D) {}",
        ),
        (
            "x/y.rs",
            "pub struct Y;\nmod inline { fn f() -> super::Y { super::super::f() } }",
        ),
    ];
    assert_eq!(
        edges_of(&files),
        [
            "x.rs -> a.rs: crate::a::c c",
            "x.rs -> a/b.rs: b::B",
            "x.rs -> a/g.rs: super::a::g::* G local",
            "x.rs -> d.rs: renamed::d",
            "x.rs -> e.rs: e::e super::e::E Named",
            "x.rs -> kind.rs: One Two crate::kind::Kind::*",
            "x.rs -> lib.rs: crate::t::T",
            "x.rs -> x/y.rs: self::y::Y Y",
            "x/y.rs -> x.rs: super::super::f",
        ]
    );
}

#[test]
fn a_program_uses_the_library_of_its_package() {
    let files = [
        ("lib.rs", "pub mod a;"),
        ("a.rs", "pub fn run() {}"),
        (
            "main.rs",
            "mod own;\nfn main() { small::a::run(); own::f(other::g()) }",
        ),
        ("own.rs", "pub fn f() { crate::main() }"),
    ];
    assert_eq!(
        edges_of(&files),
        [
            "main.rs -> a.rs: small::a::run",
            "main.rs -> own.rs: own::f",
            "own.rs -> main.rs: crate::main",
        ]
    );
}

#[test]
fn methods_beside_their_type_count_where_the_type_is_known() {
    let files = [
        ("lib.rs", "mod kind;\nmod more;\nmod user;"),
        (
            "kind.rs",
            "pub struct Kind;\nimpl Kind { fn f(&self) { self.far(); self.near() } fn near(&self) {} }",
        ),
        (
            "more.rs",
            "impl crate::kind::Kind { pub fn far(&self) {} pub const N: u8 = 1; }",
        ),
        ("user.rs", "use super::kind::Kind;\nconst M: u8 = Kind::N;"),
    ];
    assert_eq!(
        edges_of(&files),
        [
            "kind.rs -> more.rs: self.far",
            "more.rs -> kind.rs: crate::kind::Kind",
            "user.rs -> kind.rs: super::kind::Kind Kind::N",
            "user.rs -> more.rs: Kind::N",
        ]
    );
}

#[test]
fn what_serde_has_in_quotes_counts() {
    let files = [
        ("lib.rs", "mod a;\nmod b;"),
        (
            "a.rs",
            "#[derive(Debug)]\nstruct A { #[serde(default = \"crate::b::one\", rename = \"crate::b::x\")] a: u8 }",
        ),
        ("b.rs", "pub fn one() -> u8 { 1 }"),
    ];
    assert_eq!(edges_of(&files), ["a.rs -> b.rs: crate::b::one"]);
}

#[test]
fn what_is_for_tests_only_does_not_count() {
    let files = [
        ("lib.rs", "mod a;\nmod b;\n#[cfg(test)]\nmod tests;"),
        (
            "a.rs",
            "#[cfg(test)]\nmod tests { use crate::b::B; fn f(_: B) {} }
             #[cfg(all(test, unix))]\nfn f(_: crate::b::B) {}
             struct A;\nimpl A { #[cfg(test)] fn g(_: crate::b::B) {} }
             #[test]\nfn h() { crate::b::i() }",
        ),
        (
            "b.rs",
            "pub struct B;\n#[cfg(not(test))]\nfn f(_: crate::a::A) {}",
        ),
        ("tests.rs", "mod more;\nuse crate::a::A;"),
        ("tests/more.rs", "use crate::b::B;"),
    ];
    assert_eq!(edges_of(&files), ["b.rs -> a.rs: crate::a::A"]);
    let list = "[small]\nfiles: a.rs b.rs lib.rs";
    assert_eq!(wrong(&files, list), Vec::<String>::new());
}

#[test]
fn visibility_and_documentation_are_no_use() {
    let files = [
        ("lib.rs", "mod a;\nfn f() {}"),
        (
            "a.rs",
            "/// See [`crate::f`].\npub(crate) fn g() {}\npub(in crate::a) fn h() {}",
        ),
    ];
    assert_eq!(edges_of(&files), Vec::<String>::new());
}

#[test]
fn every_file_is_in_a_layer_and_every_listed_path_is_there() {
    let files = [
        ("lib.rs", "mod a;\nmod b;"),
        ("a.rs", "mod c;"),
        ("a/c.rs", ""),
        ("b.rs", ""),
        ("lost.rs", ""),
    ];
    let list = "[small]\nlow: a/ gone/\nhigh: a/c.rs lib.rs b.r b.rs\nroof: a.rs lib.rs";
    let lines = [
        "small/src/lost.rs: no `mod` names it",
        "docs/rooms.txt:4: lib.rs is there twice",
        "docs/rooms.txt:2: a/ is no file of low",
        "docs/rooms.txt:2: gone/ is no file of low",
        "docs/rooms.txt:3: b.r is no file of high",
    ];
    assert_eq!(wrong(&files, list), lines);
    let list = "[small]\nlow: a.rs a/\nhigh: lib.rs";
    assert_eq!(wrong(&files[..4], list), ["small/src/b.rs: in no layer"]);
}

#[test]
fn a_list_that_cannot_be_read_names_its_line() {
    let error = |text: &str| layers::parse(text).unwrap_err();
    assert_eq!(error("a: b"), "1: a layer before the first [crate]");
    assert_eq!(error("[x]\na: b\na: c"), "3: layer a is there twice");
    assert_eq!(error("[x]\n[x]"), "2: [x] is there twice");
    assert_eq!(
        error("[x]\n# a\na b"),
        "3: 'a b'; allowed: [crate], or layer: path path"
    );
}

#[test]
fn a_file_that_is_not_there_or_not_rust_is_named() {
    let files = [
        ("lib.rs", "\nmod gone;\nmod bad;"),
        ("bad.rs", "fn f() {}\nfn ("),
    ];
    let wrong = wrong(&files, "");
    assert_eq!(wrong[0], "small/src/lib.rs:2: mod gone: no file");
    assert!(wrong[1].starts_with("small/src/bad.rs:2: "), "{}", wrong[1]);
}

#[test]
fn the_graph_says_what_is_used_and_where() {
    let files = [
        ("lib.rs", "mod a;\nmod b;"),
        (
            "a.rs",
            "use crate::b::B;\nfn f(_: B) { B::new(); crate::b::g() }",
        ),
        ("b.rs", "pub struct B;"),
    ];
    let text = "a.rs\n  -> b.rs: crate::b::B (1), crate::b::g (2)\nb.rs\nlib.rs\n";
    assert_eq!(graph(&package(&files)), text);
}
