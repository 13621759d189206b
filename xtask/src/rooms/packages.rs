//! The crates of the workspace and the text of their files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::tools::{Trouble, failed};

/// Kinds of targets whose files are not under `src` or do not belong to the product.
const LEFT_OUT: [&str; 4] = ["bench", "custom-build", "example", "test"];

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

/// All members of the workspace at `root` that have files under `src`, in order of their
/// names.
pub fn packages(root: &Path) -> Result<Vec<Package>, Trouble> {
    let output = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()))
        .args(["metadata", "--no-deps", "--format-version", "1"])
        .current_dir(root)
        .output()?;
    if !output.status.success() {
        return Err(failed("cargo metadata", &output));
    }
    let metadata: Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| Trouble::Content(format!("cargo metadata: {error}")))?;
    let list = metadata["packages"].as_array();
    let mut packages = Vec::new();
    for value in list.into_iter().flatten() {
        packages.extend(package(root, value)?);
    }
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(packages)
}

fn package(root: &Path, value: &Value) -> Result<Option<Package>, Trouble> {
    let manifest = Path::new(value["manifest_path"].as_str().unwrap_or_default());
    let source = manifest.with_file_name("src");
    if !source.is_dir() {
        return Ok(None);
    }
    let folder = source.strip_prefix(root).unwrap_or(&source);
    let targets = value["targets"].as_array();
    let roots = targets.into_iter().flatten().filter_map(|target| {
        let kinds = target["kind"].as_array()?;
        let is = |name: &&str| kinds.iter().any(|kind| kind == name);
        let path = Path::new(target["src_path"].as_str()?);
        let file = path.strip_prefix(&source).ok()?;
        (!LEFT_OUT.iter().any(is)).then(|| Root {
            name: target["name"]
                .as_str()
                .unwrap_or_default()
                .replace('-', "_"),
            file: slashes(file),
            library: !is(&"bin"),
        })
    });
    let mut package = Package {
        name: value["name"].as_str().unwrap_or_default().to_string(),
        folder: slashes(folder),
        roots: roots.collect(),
        files: BTreeMap::new(),
    };
    read(&source, &source, &mut package.files)?;
    Ok(Some(package))
}

fn read(source: &Path, folder: &Path, files: &mut BTreeMap<String, String>) -> Result<(), Trouble> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            read(source, &path, files)?;
        } else if path.extension().is_some_and(|it| it == "rs") {
            let name = slashes(path.strip_prefix(source).unwrap_or(&path));
            files.insert(name, fs::read_to_string(&path)?);
        }
    }
    Ok(())
}

fn slashes(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}
