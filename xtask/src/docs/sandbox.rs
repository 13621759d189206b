//! Where commands of documents run: a copy of the workspace's files, with a home of its own. What
//! cargo builds there is the workspace itself, whose builds there are already.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::tools::{Trouble, good, program, root, run, target};

/// In front of a command's exit code in what a block prints.
const MARK: char = '\u{1}';

/// A folder with a copy of the workspace.
pub struct Sandbox {
    folder: PathBuf,
}

/// What a command did.
#[derive(Debug, PartialEq, Eq)]
pub struct Ran {
    /// What it printed, to both outputs.
    pub printed: String,
    /// Its exit code.
    pub code: i32,
}

/// A command, and whether it runs while the next one does.
pub struct Step<'a> {
    /// As a shell takes it.
    pub text: &'a str,
    /// Whether the next one does not wait for it.
    pub beside: bool,
}

impl Sandbox {
    /// A new copy, in the place of the one before.
    pub fn new() -> Result<Self, Trouble> {
        // Of one workspace always the same: what is built of packages in it is built once.
        let name = root().to_string_lossy().replace('/', "-");
        let folder = std::env::temp_dir().join(format!("documents{name}"));
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        let sandbox = Self { folder };
        let mut git = Command::new("git");
        git.args(["ls-files", "--cached", "--others", "--exclude-standard"]);
        for path in run(git.current_dir(root()))?.lines() {
            // One that is deleted and not yet committed is listed as well.
            if root().join(path).is_file() {
                let to = sandbox.workspace().join(path);
                fs::create_dir_all(to.parent().unwrap_or(&sandbox.folder))?;
                fs::copy(root().join(path), to)?;
            }
        }
        let programs = sandbox.programs();
        fs::create_dir_all(&programs)?;
        let cargo = programs.join("cargo");
        fs::write(&cargo, sandbox.cargo()?)?;
        run(Command::new("chmod").arg("+x").arg(cargo))?;
        for name in ["hil-sim", "firmware-host"] {
            fs::copy(program(name, name)?, programs.join(name))?;
        }
        Ok(sandbox)
    }

    /// The copy of the workspace.
    pub fn workspace(&self) -> PathBuf {
        self.folder.join("stratum")
    }

    /// Cargo for commands here: in the copy it builds the workspace, whose builds there are, and
    /// runs programs in the copy.
    fn cargo(&self) -> Result<String, Trouble> {
        let (root, target) = (root().display(), target());
        let (target, copy) = (target.display(), self.workspace());
        let cargo = run(Command::new("sh").args(["-c", "command -v cargo"]))?;
        let (cargo, copy) = (cargo.trim(), copy.display());
        Ok(format!(
            "#!/bin/sh\n\
             command=$1\n\
             case $PWD/ in\n\
             {copy}/*) export CARGO_TARGET_DIR={target} ;;\n\
             *) export CARGO_TARGET_DIR={target}/documents; exec {cargo} \"$@\" ;;\n\
             esac\n\
             case $command in\n\
             run | build | test | rustc | pkgid)\n\
             shift\n\
             exec {cargo} --config {root}/.cargo/config.toml $command \
             --manifest-path {root}/Cargo.toml \"$@\" ;;\n\
             *) cd {root} && exec {cargo} \"$@\" ;;\n\
             esac\n"
        ))
    }

    /// Runs the commands of a block in one shell, in the copy: what each did, in their order.
    pub fn run(&self, steps: &[Step]) -> Result<Vec<Ran>, Trouble> {
        let mut shell = Command::new("bash");
        shell.arg("-c").arg(script(steps));
        shell.current_dir(self.workspace()).stdin(Stdio::null());
        let path = std::env::var_os("PATH").unwrap_or_default();
        let path = std::iter::once(self.programs()).chain(std::env::split_paths(&path));
        shell.env("PATH", std::env::join_paths(path)?);
        // What cargo and rustup have there stays where it is.
        let home = PathBuf::from(std::env::var_os("HOME").unwrap_or_default());
        for (name, below) in [("CARGO_HOME", ".cargo"), ("RUSTUP_HOME", ".rustup")] {
            if std::env::var_os(name).is_none() {
                shell.env(name, home.join(below));
            }
        }
        shell.env("HOME", &self.folder);
        let output = shell.output()?;
        let printed = good("the shell of a block", &output)?;
        Ok(split(&printed, steps))
    }

    fn programs(&self) -> PathBuf {
        self.folder.join("bin")
    }
}

/// The commands of a block, each with [`MARK`] and exit code behind what it prints. Those that
/// run beside others come last.
fn script(steps: &[Step]) -> String {
    // The next command may ask for the exit code.
    let code = format!(
        "code=$?; printf '\\{:03o}%s\\n' $code; (exit $code)\n",
        MARK as u32
    );
    let mut script = String::from("exec 2>&1\n");
    for (number, step) in steps.iter().enumerate() {
        script += &match step.beside {
            true => format!("{} > ../beside-{number} &\nbeside_{number}=$!\n", step.text),
            false => format!("{}\n{code}", step.text),
        };
    }
    for (number, _) in steps.iter().enumerate().filter(|(_, step)| step.beside) {
        script += &format!(
            "wait $beside_{number}\ncode=$?; cat ../beside-{number}; (exit $code)\n{code}"
        );
    }
    script + "true\n"
}

/// What each command printed, and its exit code; of one that the shell did not reach 1.
fn split(printed: &str, steps: &[Step]) -> Vec<Ran> {
    let mut rest = printed;
    let mut next = || {
        let (printed, after) = rest.split_once(MARK).unwrap_or((rest, ""));
        let (code, after) = after.split_once('\n').unwrap_or((after, ""));
        rest = after;
        Ran {
            printed: printed.to_string(),
            code: code.parse().unwrap_or(1),
        }
    };
    let mut all: Vec<Option<Ran>> = steps.iter().map(|_| None).collect();
    for beside in [false, true] {
        for (ran, _) in all
            .iter_mut()
            .zip(steps)
            .filter(|(_, step)| step.beside == beside)
        {
            *ran = Some(next());
        }
    }
    all.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_of_a_block_has_its_output_and_exit_code() {
        let folder = std::env::temp_dir().join("stratum-sandbox-test");
        fs::create_dir_all(folder.join("stratum")).expect("a folder");
        let sandbox = Sandbox { folder };
        let steps = [
            "echo a; echo b >&2",
            "cd /; false",
            "echo $?",
            "sleep 0.1; (exit 4)",
            "pwd",
        ];
        let steps = steps.map(|text| Step {
            text,
            beside: text.starts_with("sleep"),
        });
        let ran = sandbox.run(&steps).expect("a shell");
        let ran: Vec<_> = ran
            .iter()
            .map(|it| (it.printed.as_str(), it.code))
            .collect();
        assert_eq!(
            ran,
            [("a\nb\n", 0), ("", 1), ("1\n", 0), ("", 4), ("/\n", 0)]
        );
        fs::remove_dir_all(sandbox.folder).expect("removed");
    }
}
