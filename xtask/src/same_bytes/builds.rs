//! Where a program to compare comes from.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::tools::{Trouble, failed};

/// A program, or the code to build it from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// An executable.
    File(PathBuf),
    /// The full name of a commit.
    Revision(String),
    /// The code as it is here.
    WorkingTree,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Revision(commit) => write!(f, "revision {commit}"),
            Self::WorkingTree => f.write_str("working tree"),
        }
    }
}

/// The workspace and where it builds to.
#[derive(Debug)]
pub struct Place {
    root: PathBuf,
    build: PathBuf,
    /// Of everything that comparisons leave.
    pub folder: PathBuf,
}

impl Place {
    /// That of this program's source.
    pub fn find() -> io::Result<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("..")
            .canonicalize()?;
        let build = std::env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| root.join("target"), |path| root.join(path));
        let folder = build.join("same-bytes");
        Ok(Self {
            root,
            build,
            folder,
        })
    }

    /// What `word` names; a file rather than a revision of the same name.
    pub fn source(&self, what: &str, word: &str) -> Result<Source, String> {
        if Path::new(word).is_file() {
            return Ok(Source::File(word.into()));
        }
        let commit = format!("{word}^{{commit}}");
        let output = git(
            &self.root,
            &[
                "rev-parse",
                "--verify",
                "--quiet",
                "--end-of-options",
                &commit,
            ],
        );
        match output {
            Ok(output) if output.status.success() => Ok(Source::Revision(text(&output))),
            _ => Err(format!(
                "{what}: '{word}'; allowed: the path of a hil-sim executable, or a git revision"
            )),
        }
    }

    /// The executable, built if it has to be.
    pub fn program(&self, source: &Source) -> Result<PathBuf, Trouble> {
        match source {
            Source::File(path) => Ok(path.clone()),
            Source::WorkingTree => build(&self.root, &self.build),
            Source::Revision(commit) => {
                let folder = self.folder.join(commit);
                let tree = folder.join("tree");
                self.check_out(&tree, commit)?;
                build(&tree, &folder.join("build"))
            }
        }
    }

    /// Makes the work tree. One that is there already is used again if it is what it
    /// should be, so that cargo builds only what it has to.
    fn check_out(&self, tree: &Path, commit: &str) -> Result<(), Trouble> {
        if is_at(tree, commit) {
            return Ok(());
        }
        if tree.exists() {
            fs::remove_dir_all(tree)?;
        }
        // Work trees whose folder is gone, by us or by `cargo clean`.
        let path = tree.to_string_lossy();
        for arguments in [
            &["worktree", "prune"][..],
            &["worktree", "add", "--quiet", "--detach", &path, commit],
        ] {
            let output = git(&self.root, arguments)?;
            if !output.status.success() {
                return Err(failed(&format!("git {}", arguments.join(" ")), &output));
            }
        }
        Ok(())
    }
}

/// Whether this is a work tree of its own with that commit and nothing else. A folder
/// that is none would answer for the repository around it.
fn is_at(tree: &Path, commit: &str) -> bool {
    let says = |arguments: &[&str]| -> Option<String> {
        let output = git(tree, arguments).ok()?;
        output.status.success().then(|| text(&output))
    };
    tree.is_dir()
        && says(&["rev-parse", "--show-prefix"]).as_deref() == Some("")
        && says(&["rev-parse", "HEAD"]).as_deref() == Some(commit)
        && says(&["status", "--porcelain"]).as_deref() == Some("")
}

fn build(tree: &Path, target: &Path) -> Result<PathBuf, Trouble> {
    let output = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()))
        .args(["build", "--quiet", "--release", "-p", "hil-sim"])
        .arg("--target-dir")
        .arg(target)
        .current_dir(tree)
        .output()?;
    if !output.status.success() {
        return Err(failed(
            &format!("build of hil-sim in {}", tree.display()),
            &output,
        ));
    }
    Ok(target.join("release").join("hil-sim"))
}

/// Runs git in a folder; not in the repository of a hook that this may run in.
fn git(folder: &Path, arguments: &[&str]) -> io::Result<Output> {
    Command::new("git")
        .args(arguments)
        .current_dir(folder)
        .env_remove("GIT_DIR")
        .env_remove("GIT_WORK_TREE")
        .env_remove("GIT_INDEX_FILE")
        .output()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).trim().to_string()
}
