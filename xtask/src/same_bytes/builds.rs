//! Where a program to compare comes from.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools::{Trouble, cargo, program, root, run, target};

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

impl Source {
    /// What `word` names; a file rather than a revision of the same name.
    pub fn named(what: &str, word: &str) -> Result<Self, Trouble> {
        if Path::new(word).is_file() {
            return Ok(Self::File(word.into()));
        }
        let commit = format!("{word}^{{commit}}");
        let options = ["rev-parse", "--verify", "--quiet", "--end-of-options"];
        match run(git(&options).arg(commit)) {
            Ok(commit) => Ok(Self::Revision(commit.trim().into())),
            Err(_) => Err(Trouble::usage(format!(
                "{what}: '{word}'; allowed: the path of a hil-sim executable, or a git revision"
            ))),
        }
    }

    /// The executable, built if it has to be.
    pub fn program(&self) -> Result<PathBuf, Trouble> {
        let commit = match self {
            Self::File(path) => return Ok(path.clone()),
            Self::WorkingTree => return program("hil-sim", "hil-sim"),
            Self::Revision(commit) => commit,
        };
        let folder = target().join("same-bytes");
        let kept = folder.join(format!("hil-sim-{commit}"));
        if !kept.exists() {
            // Left behind by a comparison that was ended.
            let tree = folder.join(commit);
            if tree.exists() {
                fs::remove_dir_all(&tree)?;
            }
            let add = ["worktree", "add", "--quiet", "--force", "--detach"];
            run(git(&add).arg(&tree).arg(commit))?;
            let build = folder.join("build");
            let mut cargo = cargo("build");
            cargo
                .args(["--release", "-p", "hil-sim", "--target-dir"])
                .arg(&build);
            run(cargo.current_dir(&tree))?;
            fs::copy(build.join("release/hil-sim"), &kept)?;
            run(git(&["worktree", "remove", "--force"]).arg(&tree))?;
        }
        Ok(kept)
    }
}

/// Git in the workspace; not in the repository of a hook that this may run in.
fn git(arguments: &[&str]) -> Command {
    let mut git = Command::new("git");
    git.args(arguments).current_dir(root());
    for variable in ["GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"] {
        git.env_remove(variable);
    }
    git
}
