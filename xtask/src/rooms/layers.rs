//! The list of layers, docs/rooms.txt.

use std::collections::{BTreeMap, BTreeSet};

/// Layers of one crate.
#[derive(Debug)]
pub struct Section {
    /// As `cargo -p` takes it.
    pub package: String,
    /// Bottom to top.
    pub layers: Vec<Layer>,
    /// Where its name is.
    pub line: usize,
}

/// Files that are at the same height.
#[derive(Debug)]
pub struct Layer {
    /// For messages.
    pub name: String,
    /// Files below `src`, and folders with `/` at their end.
    pub paths: Vec<String>,
    /// Where it is in the list.
    pub line: usize,
}

/// Reads the list: `[crate]`, below it `layer: path path`, bottom to top. Empty lines and
/// lines with `#` at the beginning count nothing.
pub fn parse(text: &str) -> Result<Vec<Section>, String> {
    let mut sections: Vec<Section> = Vec::new();
    for (line, text) in (1..).zip(text.lines().map(str::trim)) {
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        if let Some(name) = text.strip_prefix('[').and_then(|it| it.strip_suffix(']')) {
            if sections.iter().any(|section| section.package == name) {
                return Err(format!("{line}: [{name}] is there twice"));
            }
            sections.push(Section {
                package: name.to_string(),
                layers: Vec::new(),
                line,
            });
            continue;
        }
        let Some((name, paths)) = text.split_once(':') else {
            return Err(format!(
                "{line}: '{text}'; allowed: [crate], or layer: path path"
            ));
        };
        let Some(section) = sections.last_mut() else {
            return Err(format!("{line}: a layer before the first [crate]"));
        };
        if section.layers.iter().any(|layer| layer.name == name) {
            return Err(format!("{line}: layer {name} is there twice"));
        }
        section.layers.push(Layer {
            name: name.to_string(),
            paths: paths.split_whitespace().map(str::to_string).collect(),
            line,
        });
    }
    Ok(sections)
}

impl Section {
    /// The height of each file, and what is wrong with the list. Of the paths that fit a
    /// file the longest counts.
    pub fn heights<'a>(
        &self,
        files: &BTreeSet<&'a str>,
    ) -> (BTreeMap<&'a str, usize>, Vec<String>) {
        let mut wrong = Vec::new();
        let mut owner: BTreeMap<&str, usize> = BTreeMap::new();
        for (height, layer) in self.layers.iter().enumerate() {
            for path in &layer.paths {
                if owner.insert(path, height).is_some() {
                    wrong.push(format!("{}: {path} is there twice", layer.line));
                }
            }
        }
        let mut heights = BTreeMap::new();
        let mut used = BTreeSet::new();
        for file in files {
            let fitting = owner.iter().filter(|(path, _)| fits(path, file));
            if let Some((path, height)) = fitting.max_by_key(|(path, _)| path.len()) {
                used.insert(*path);
                heights.insert(*file, *height);
            }
        }
        for layer in &self.layers {
            for path in layer.paths.iter().filter(|it| !used.contains(it.as_str())) {
                wrong.push(format!(
                    "{}: {path} is no file of {}",
                    layer.line, layer.name
                ));
            }
        }
        (heights, wrong)
    }
}

fn fits(path: &str, file: &str) -> bool {
    file == path || (path.ends_with('/') && file.starts_with(path))
}
