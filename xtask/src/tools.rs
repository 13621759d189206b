//! The programs that are needed: which are missing, and how they are called.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Of the Cortex-M7.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The emulator.
pub const QEMU: &str = "qemu-system-arm";

/// What came out: a verdict, or why there is none.
pub type Outcome = Result<bool, Trouble>;

/// Why there is no verdict.
#[derive(Debug)]
pub enum Trouble {
    /// Something has to be installed: what, and the line that does it.
    Missing(Vec<(&'static str, &'static str)>),
    /// A command failed that should not: its line and what it said.
    Command(String),
    /// A file or an output is not what it should be.
    Content(String),
}

impl Trouble {
    /// 2 where something is missing, 1 otherwise.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Missing(_) => 2,
            Self::Command(_) | Self::Content(_) => 1,
        }
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(list) => {
                let lines = list
                    .iter()
                    .map(|(what, how)| format!("missing: {what}; install it with: {how}"));
                f.write_str(&lines.collect::<Vec<_>>().join("\n"))
            }
            Self::Command(text) | Self::Content(text) => f.write_str(text),
        }
    }
}

impl From<io::Error> for Trouble {
    fn from(error: io::Error) -> Self {
        Self::Content(error.to_string())
    }
}

/// What a command needs besides the target.
#[derive(Clone, Copy, Debug)]
pub enum Need {
    /// QEMU.
    Emulator,
    /// Disassembler and sizes.
    LlvmTools,
    /// Of the application's log.
    LogDecoder,
}

/// Everything that is needed is there.
#[derive(Debug)]
pub struct Tools {
    /// Of the workspace.
    pub root: PathBuf,
    /// Where cargo builds to.
    build: PathBuf,
    /// Where images run and leave their files.
    pub work: PathBuf,
}

impl Tools {
    /// Looks for the target's standard library and for `needs`; says everything
    /// that is missing at once.
    pub fn find(needs: &[Need]) -> Result<Self, Trouble> {
        let mut missing = Vec::new();
        let libraries = sysroot()?.join("lib/rustlib").join(TARGET).join("lib");
        if !libraries.is_dir() {
            missing.push((TARGET, "rustup target add thumbv7em-none-eabihf"));
        }
        for need in needs {
            let (there, what, how) = match need {
                Need::Emulator => (
                    Command::new(QEMU).arg("--version").output().is_ok(),
                    QEMU,
                    "apt-get install qemu-system-arm",
                ),
                Need::LlvmTools => (
                    llvm_tool("llvm-objdump").is_ok(),
                    "llvm-tools",
                    "rustup component add llvm-tools",
                ),
                Need::LogDecoder => (
                    Command::new("defmt-print")
                        .arg("--version")
                        .output()
                        .is_ok(),
                    "defmt-print",
                    "cargo install defmt-print --version 1.2.0 --locked",
                ),
            };
            if !there {
                missing.push((what, how));
            }
        }
        if !missing.is_empty() {
            return Err(Trouble::Missing(missing));
        }
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("..")
            .canonicalize()?;
        let build = std::env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| root.join("target"), |path| root.join(path));
        let work = build.join("m7");
        fs::create_dir_all(&work)?;
        Ok(Self { root, build, work })
    }

    /// Builds an image for the target as it is shipped.
    pub fn image(&self, name: &str, features: &[&str]) -> Result<PathBuf, Trouble> {
        let output = self.try_image(name, features)?;
        if output.status.success() {
            Ok(self.build.join(TARGET).join("release").join(name))
        } else {
            Err(failed(&format!("build of the image {name}"), &output))
        }
    }

    /// The same, whatever comes of it.
    pub fn try_image(&self, name: &str, features: &[&str]) -> Result<Output, Trouble> {
        let mut cargo = self.cargo("build");
        cargo.args(["-p", "firmware", "--release", "--target", TARGET]);
        cargo.args(["--bin", name, "--features", &features.join(",")]);
        Ok(cargo.output()?)
    }

    /// Builds a program of the workspace for the host: the package of that name.
    pub fn program(&self, name: &str) -> Result<PathBuf, Trouble> {
        let output = self
            .cargo("build")
            .args(["-p", name, "--release"])
            .output()?;
        if output.status.success() {
            Ok(self.build.join("release").join(name))
        } else {
            Err(failed(&format!("build of {name}"), &output))
        }
    }

    /// Runs the host program of that name in the working directory.
    pub fn host(&self, name: &str, arguments: &[&str]) -> Result<String, Trouble> {
        let mut cargo = self.cargo("build");
        cargo.args(["-p", "firmware", "--release", "--bin", name]);
        let built = cargo.output()?;
        if !built.status.success() {
            return Err(failed(&format!("build of the host's {name}"), &built));
        }
        let mut program = Command::new(self.build.join("release").join(name));
        let output = program.args(arguments).current_dir(&self.work).output()?;
        if output.status.success() {
            Ok(String::from_utf8_lossy(&output.stdout).into_owned())
        } else {
            Err(failed(&format!("the host's {name}"), &output))
        }
    }

    /// Runs an image in QEMU, from the working directory.
    pub fn emulate(&self, image: &Path, options: &[&str]) -> Result<Output, Trouble> {
        let mut qemu = Command::new(QEMU);
        qemu.args(["-M", "mps2-an500", "-display", "none", "-serial", "null"]);
        qemu.args(["-monitor", "none", "-semihosting-config"]);
        qemu.arg("enable=on,target=native").args(options);
        qemu.arg("-kernel").arg(image);
        qemu.current_dir(&self.work).stdin(Stdio::null());
        Ok(qemu.output()?)
    }

    fn cargo(&self, command: &str) -> Command {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        cargo.arg(command).arg("--quiet").current_dir(&self.root);
        cargo
    }
}

/// Of the compiler that builds the images.
pub fn sysroot() -> Result<PathBuf, Trouble> {
    let text = first_line("rustc", &["--print", "sysroot"])?;
    Ok(PathBuf::from(text))
}

/// The first line that a program prints.
pub fn first_line(program: &str, arguments: &[&str]) -> Result<String, Trouble> {
    let output = Command::new(program).args(arguments).output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().next().unwrap_or_default().to_string())
}

/// Version of the emulator, as it says it.
pub fn qemu_version() -> Result<String, Trouble> {
    first_line(QEMU, &["--version"])
}

/// A command that failed, with all that it said.
pub fn failed(what: &str, output: &Output) -> Trouble {
    let stdout = String::from_utf8_lossy(&output.stdout);
    let stderr = String::from_utf8_lossy(&output.stderr);
    Trouble::Command(format!(
        "{what} failed ({}):\n{stdout}{stderr}",
        output.status
    ))
}

/// A program of the compiler's `llvm-tools`.
pub fn llvm_tool(name: &str) -> Result<PathBuf, Trouble> {
    let hosts = fs::read_dir(sysroot()?.join("lib/rustlib"))?;
    hosts
        .filter_map(|entry| Some(entry.ok()?.path().join("bin").join(name)))
        .find(|path| path.is_file())
        .ok_or_else(|| Trouble::Missing(vec![("llvm-tools", "rustup component add llvm-tools")]))
}
