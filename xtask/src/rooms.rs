//! The files of each crate stand in layers and none uses another in a circle: every path
//! in their text is followed to the file that declares what it names.

mod circles;
mod edges;
mod layers;
mod methods;
mod packages;
mod resolve;
mod syntax;
#[cfg(test)]
mod tests;
mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::tools::{Outcome, Trouble};
use edges::{Edges, Place};
use layers::Section;
use packages::Package;
use tree::Tree;

/// From the workspace's root.
const LIST: &str = "docs/rooms.txt";

/// What is asked for.
#[derive(Debug)]
pub struct Rooms {
    root: PathBuf,
    packages: Vec<Package>,
    /// The crate whose edges are to be printed, not checked.
    graph: Option<usize>,
}

impl Rooms {
    /// Reads the words behind the command and the workspace; the error is for the user.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let name = match words {
            [] => None,
            ["--graph", name] => Some(*name),
            _ => {
                let words = words.join(" ");
                return Err(format!(
                    "rooms: '{words}'; allowed: nothing, or --graph CRATE"
                ));
            }
        };
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("..")
            .canonicalize()
            .map_err(|error| error.to_string())?;
        let packages = packages::packages(&root).map_err(|error| error.to_string())?;
        let names: Vec<&str> = packages.iter().map(|it| it.name.as_str()).collect();
        let graph = match name {
            Some(name) => match names.iter().position(|known| *known == name) {
                None => return Err(format!("CRATE: '{name}'; allowed: {}", names.join(", "))),
                found => found,
            },
            None => None,
        };
        Ok(Self {
            root,
            packages,
            graph,
        })
    }

    /// Says what is wrong, and one line for each crate.
    pub fn run(&self) -> Outcome {
        if let Some(package) = self.graph {
            print!("{}", graph(&self.packages[package]));
            return Ok(true);
        }
        let text = fs::read_to_string(self.root.join(LIST))
            .map_err(|error| Trouble::Content(format!("{LIST}: {error}")))?;
        let sections =
            layers::parse(&text).map_err(|wrong| Trouble::Content(format!("{LIST}:{wrong}")))?;
        let mut fine = true;
        for section in &sections {
            if self.packages.iter().all(|it| it.name != section.package) {
                println!("{LIST}:{}: no crate {}", section.line, section.package);
                fine = false;
            }
        }
        for package in &self.packages {
            let section = sections.iter().find(|it| it.package == package.name);
            let checked = check(package, section);
            for line in &checked.wrong {
                println!("{line}");
            }
            println!("{}", checked.summary);
            fine &= checked.wrong.is_empty();
        }
        Ok(fine)
    }
}

/// What came out for one crate.
struct Checked {
    /// A line for each place that is wrong, and lines above them.
    wrong: Vec<String>,
    summary: String,
}

fn check(package: &Package, section: Option<&Section>) -> Checked {
    let tree = Tree::new(package);
    let edges = edges::edges(&tree);
    let files = tree.files();
    let mut wrong = tree.problems.clone();
    let mut summary = format!(
        "{}: {} files, {} edges",
        package.name,
        files.len(),
        edges.len()
    );
    if let Some(section) = section {
        let (heights, of_list) = section.heights(&files);
        wrong.extend(of_list.iter().map(|wrong| format!("{LIST}:{wrong}")));
        let homeless = files.iter().filter(|file| !heights.contains_key(*file));
        wrong.extend(homeless.map(|file| format!("{}: in no layer", package.path(file))));
        let mut upward = 0;
        for ((from, to), places) in &edges {
            let height = |file: &String| heights.get(file.as_str()).copied();
            let (Some(low), Some(high)) = (height(from), height(to)) else {
                continue;
            };
            if low < high {
                upward += 1;
                let name = |height: usize| &section.layers[height].name;
                wrong.extend(distinct(places).iter().map(|place| {
                    let (line, path) = (place.line, &place.path);
                    format!(
                        "{}:{line}: {path}: {} uses {} above it, {to}",
                        package.path(from),
                        name(low),
                        name(high)
                    )
                }));
            }
        }
        let layers = section.layers.len();
        summary += &format!(", {layers} layers, {upward} upward edges");
    } else {
        summary += ", no layers";
    }
    let circles = circles::circles(&edges);
    for files in &circles {
        let names: Vec<&str> = files.iter().map(String::as_str).collect();
        let (name, list) = (&package.name, names.join(", "));
        wrong.push(format!("{name}: circle of {} files: {list}", names.len()));
        for ((from, to), places) in &edges {
            if files.contains(from) && files.contains(to) {
                wrong.push(format!("  {from} -> {to}"));
                wrong.extend(distinct(places).iter().map(|Place { line, path }| {
                    format!("    {}:{line}: {path}", package.path(from))
                }));
            }
        }
    }
    summary += &format!(", {} circles", circles.len());
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
    let edges: Edges = edges::edges(&tree);
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
