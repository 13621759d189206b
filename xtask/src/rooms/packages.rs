//! The crates of the workspace and the text of their files.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use serde::Deserialize;

use crate::tools::{Trouble, cargo, files, root, run};

/// A crate's files under `src`.
#[derive(Debug, Default)]
pub struct Package {
    /// As `cargo -p` takes it.
    pub name: String,
    /// Of the folder `src`, from the workspace's root.
    pub folder: String,
    /// Library and programs.
    pub roots: Vec<Root>,
    /// Name below `src` -> text.
    pub files: BTreeMap<String, String>,
}

/// Where a crate begins.
#[derive(Debug)]
pub struct Root {
    /// As other crates name it.
    pub name: String,
    /// Below `src`.
    pub file: String,
    /// Not a program.
    pub library: bool,
}

impl Package {
    /// A file from the workspace's root.
    pub fn path(&self, file: &str) -> String {
        format!("{}/{file}", self.folder)
    }
}

/// What is read of `cargo metadata`.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Manifest>,
}

#[derive(Deserialize)]
struct Manifest {
    name: String,
    manifest_path: PathBuf,
    targets: Vec<Target>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
    kind: Vec<String>,
    src_path: PathBuf,
}

/// All members of the workspace that have files under `src`, in order of their names.
pub fn packages() -> Result<Vec<Package>, Trouble> {
    let mut command = cargo("metadata");
    let text = run(command.args(["--no-deps", "--format-version", "1"]))?;
    let metadata: Metadata = serde_json::from_str(&text)?;
    let packages = metadata.packages.into_iter().map(package);
    let mut packages: Vec<Package> = packages.collect::<Result<_, _>>()?;
    packages.retain(|package| !package.files.is_empty());
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(packages)
}

fn package(manifest: Manifest) -> Result<Package, Trouble> {
    let source = manifest.manifest_path.with_file_name("src");
    let folder = source.strip_prefix(root()).unwrap_or(&source);
    // Tests, examples and the like are elsewhere.
    let roots = manifest.targets.into_iter().filter_map(|target| {
        Some(Root {
            file: target
                .src_path
                .strip_prefix(&source)
                .ok()?
                .display()
                .to_string(),
            name: target.name.replace('-', "_"),
            library: !target.kind.contains(&"bin".to_string()),
        })
    });
    let mut package = Package {
        name: manifest.name,
        folder: folder.display().to_string(),
        roots: roots.collect(),
        files: BTreeMap::new(),
    };
    for file in files(&source)? {
        if file.extension().is_some_and(|it| it == "rs") {
            let text = fs::read_to_string(source.join(&file))?;
            package.files.insert(file.display().to_string(), text);
        }
    }
    Ok(package)
}
