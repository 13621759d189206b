//! The files of each crate stand in layers and none uses another in a circle: every path
//! in their text is followed to the file that declares what it names.

mod edges;
mod layers;
mod packages;
#[cfg(test)]
mod tests;
mod text;
mod tokens;
mod tree;

use std::collections::BTreeSet;
use std::fs;

use crate::tools::{Outcome, Trouble, root};
use edges::{Place, circles, edges};
use layers::Section;
use packages::{Package, packages};
use tree::Tree;

/// From the workspace's root.
const LIST: &str = "docs/rooms.txt";

/// Says what is wrong, and one line for each crate; or prints the edges of one.
pub fn run(words: &[&str]) -> Outcome {
    let packages = packages()?;
    match *words {
        [] => check_all(&packages),
        ["--graph", name] => match packages.iter().find(|it| it.name == name) {
            Some(package) => {
                print!("{}", graph(package));
                Ok(true)
            }
            None => {
                let names: Vec<&str> = packages.iter().map(|it| it.name.as_str()).collect();
                let names = names.join(", ");
                Err(Trouble::usage(format!("CRATE: '{name}'; allowed: {names}")))
            }
        },
        _ => Err(Trouble::usage(format!(
            "rooms: '{}'; allowed: nothing, or --graph CRATE",
            words.join(" ")
        ))),
    }
}

fn check_all(packages: &[Package]) -> Outcome {
    let text = fs::read_to_string(root().join(LIST))?;
    let sections = layers::parse(&text).map_err(|it| Trouble::new(format!("{LIST}:{it}")))?;
    let mut fine = true;
    for Section { package, line, .. } in &sections {
        if packages.iter().all(|it| it.name != *package) {
            println!("{LIST}:{line}: no crate {package}");
            fine = false;
        }
    }
    for package in packages {
        let checked = check(
            package,
            sections.iter().find(|it| it.package == package.name),
        );
        for line in &checked.wrong {
            println!("{line}");
        }
        println!("{}", checked.summary);
        fine &= checked.wrong.is_empty();
    }
    Ok(fine)
}

/// What came out for one crate.
struct Checked {
    /// A line for each place that is wrong, and lines above them.
    wrong: Vec<String>,
    summary: String,
}

fn check(package: &Package, section: Option<&Section>) -> Checked {
    let tree = Tree::new(package);
    let (edges, files) = (edges(&tree), tree.files());
    let mut wrong = tree.problems.clone();
    let name = &package.name;
    let mut summary = format!("{name}: {} files, {} edges", files.len(), edges.len());
    if let Some(section) = section {
        let (heights, of_list) = section.heights(&files);
        wrong.extend(of_list.iter().map(|wrong| format!("{LIST}:{wrong}")));
        let homeless = files.iter().filter(|file| !heights.contains_key(*file));
        wrong.extend(homeless.map(|file| format!("{}: in no layer", package.path(file))));
        let mut upward = 0;
        for ((from, to), places) in &edges {
            let [low, high] = [from, to].map(|file| heights.get(file.as_str()).copied());
            let (Some(low), Some(high)) = (low, high) else {
                continue;
            };
            if low < high {
                upward += 1;
                let [low, high] = [low, high].map(|height| &section.layers[height].name);
                wrong.extend(distinct(places).iter().map(|Place { line, path }| {
                    let from = package.path(from);
                    format!("{from}:{line}: {path}: {low} uses {high} above it, {to}")
                }));
            }
        }
        let layers = section.layers.len();
        summary += &format!(", {layers} layers, {upward} upward edges");
    } else {
        summary += ", no layers";
    }
    let circles = circles(&edges);
    summary += &format!(", {} circles", circles.len());
    for circle in circles {
        let names: Vec<&str> = circle.iter().copied().collect();
        let (count, names) = (names.len(), names.join(", "));
        wrong.push(format!("{name}: circle of {count} files: {names}"));
        for ((from, to), places) in &edges {
            if circle.contains(from.as_str()) && circle.contains(to.as_str()) {
                wrong.push(format!("  {from} -> {to}"));
                wrong.extend(distinct(places).iter().map(|Place { line, path }| {
                    format!("    {}:{line}: {path}", package.path(from))
                }));
            }
        }
    }
    Checked { wrong, summary }
}

/// Each path once, where it comes first; of an imported name only the `use`.
fn distinct(places: &BTreeSet<Place>) -> Vec<&Place> {
    let mut distinct: Vec<&Place> = Vec::new();
    for place in places {
        let name = place.path.split("::").next().unwrap_or_default();
        let known = distinct
            .iter()
            .any(|other| other.path == place.path || other.path.ends_with(&format!("::{name}")));
        if !known {
            distinct.push(place);
        }
    }
    distinct
}

/// The edges of a crate, file by file, for one who plans a move.
fn graph(package: &Package) -> String {
    let tree = Tree::new(package);
    let edges = edges(&tree);
    let mut text = String::new();
    for file in tree.files() {
        text += &format!("{file}\n");
        for ((_, to), places) in edges.iter().filter(|((from, _), _)| from == file) {
            let places: Vec<String> = distinct(places)
                .iter()
                .map(|Place { line, path }| format!("{path} ({line})"))
                .collect();
            text += &format!("  -> {to}: {}\n", places.join(", "));
        }
    }
    text
}
