//! The programs that are needed: which are missing, and how they are called.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Of the Cortex-M7.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The emulator.
pub const QEMU: &str = "qemu-system-arm";

/// Disassembler, sizes and symbols.
pub const LLVM: &str = "llvm-tools";

/// Of the application's log.
pub const DEFMT: &str = "defmt-print";

/// What a command may need, and the line that installs it.
const NEEDS: [(&str, &str); 4] = [
    (TARGET, "rustup target add thumbv7em-none-eabihf"),
    (QEMU, "apt-get install qemu-system-arm"),
    (LLVM, "rustup component add llvm-tools"),
    (DEFMT, "cargo install defmt-print --version 1.2.0 --locked"),
];

/// What came out: a verdict, or why there is none.
pub type Outcome = Result<bool, Trouble>;

/// Why there is no verdict.
#[derive(Debug, PartialEq)]
pub struct Trouble {
    /// For the user.
    pub text: String,
    /// 2 where words are wrong or something has to be installed, otherwise 1.
    pub exit_code: u8,
}

impl Trouble {
    /// A file or an output is not what it should be.
    pub fn new(text: String) -> Self {
        let exit_code = 1;
        Self { text, exit_code }
    }

    /// The words behind a command are wrong, or something is missing.
    pub fn usage(text: String) -> Self {
        let exit_code = 2;
        Self { text, exit_code }
    }
}

impl<E: std::error::Error> From<E> for Trouble {
    fn from(error: E) -> Self {
        Self::new(error.to_string())
    }
}

/// Looks for the target's standard library and for `needs`; names everything that is
/// missing at once.
pub fn find(needs: &[&str]) -> Result<(), Trouble> {
    let there = |need: &str| match need {
        TARGET => (sysroot().ok()).is_some_and(|it| it.join(TARGET).join("lib").is_dir()),
        LLVM => llvm_tool("llvm-objdump").is_ok(),
        program => Command::new(program).arg("--version").output().is_ok(),
    };
    let needed = NEEDS
        .iter()
        .filter(|(need, _)| *need == TARGET || needs.contains(need));
    let missing: Vec<String> = needed
        .filter(|(need, _)| !there(need))
        .map(|(need, how)| format!("missing: {need}; install it with: {how}"))
        .collect();
    if missing.is_empty() {
        Ok(())
    } else {
        Err(Trouble::usage(missing.join("\n")))
    }
}

/// The folder of the workspace.
pub fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}

/// Where cargo builds to.
pub fn target() -> PathBuf {
    root().join(env::var_os("CARGO_TARGET_DIR").unwrap_or("target".into()))
}

/// Where images run and leave their files.
pub fn work() -> Result<PathBuf, Trouble> {
    let work = target().join("m7");
    fs::create_dir_all(&work)?;
    Ok(work)
}

/// Cargo with a command, in the workspace.
pub fn cargo(command: &str) -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.arg(command).arg("--quiet").current_dir(root());
    cargo
}

/// Runs a command that has to succeed: what it prints. An error names the whole command, and
/// says why it could not be started or what it said.
pub fn run(command: &mut Command) -> Result<String, Trouble> {
    let what = format!("{command:?}");
    let output = command.output();
    good(
        &what,
        &output.map_err(|error| Trouble::new(format!("{what}: {error}")))?,
    )
}

/// What a command printed; an error with all that it said where it failed.
pub fn good(what: &str, output: &Output) -> Result<String, Trouble> {
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(said);
    }
    let (status, errors) = (output.status, String::from_utf8_lossy(&output.stderr));
    Err(Trouble::new(format!(
        "{what} failed ({status}):\n{said}{errors}"
    )))
}

/// Cargo's command that builds an image for the target as it is shipped.
pub fn image_build(name: &str, features: &str) -> Command {
    let mut cargo = cargo("build");
    cargo.args(["-p", "firmware", "--release", "--target", TARGET]);
    cargo.args(["--bin", name, "--features", features]);
    cargo
}

/// Builds an image: its path.
pub fn image(name: &str, features: &str) -> Result<PathBuf, Trouble> {
    run(&mut image_build(name, features))?;
    Ok(target().join(TARGET).join("release").join(name))
}

/// Builds a program of a package for the host: its path.
pub fn program(package: &str, name: &str) -> Result<PathBuf, Trouble> {
    run(cargo("build").args(["-p", package, "--release", "--bin", name]))?;
    Ok(target().join("release").join(name))
}

/// Runs the host program of an image in the working directory.
pub fn host(name: &str, arguments: &[&str]) -> Result<String, Trouble> {
    let mut program = Command::new(program("firmware", name)?);
    run(program.args(arguments).current_dir(work()?))
}

/// The emulated board, in the working directory.
pub fn qemu(image: &Path) -> Result<Command, Trouble> {
    let mut qemu = Command::new(QEMU);
    qemu.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none"]);
    qemu.args(["-semihosting-config", "enable=on,target=native"]);
    qemu.arg("-kernel").arg(image);
    qemu.current_dir(work()?).stdin(Stdio::null());
    Ok(qemu)
}

/// Runs an image in QEMU to its end, without a serial port. Its exit code is for the caller
/// to judge.
pub fn emulate(image: &Path, options: &[&str]) -> Result<Output, Trouble> {
    let mut qemu = qemu(image)?;
    Ok(qemu.args(["-serial", "null"]).args(options).output()?)
}

/// Of the libraries of the compiler that builds the images.
fn sysroot() -> Result<PathBuf, Trouble> {
    let path = first_line("rustc", &["--print", "sysroot"])?;
    Ok(Path::new(&path).join("lib/rustlib"))
}

/// The first line that a program prints.
pub fn first_line(program: &str, arguments: &[&str]) -> Result<String, Trouble> {
    let text = run(Command::new(program).args(arguments))?;
    Ok(text.lines().next().unwrap_or_default().to_string())
}

/// A program of the compiler's `llvm-tools`.
pub fn llvm_tool(name: &str) -> Result<Command, Trouble> {
    let mut hosts = fs::read_dir(sysroot()?)?
        .filter_map(|entry| Some(entry.ok()?.path().join("bin").join(name)));
    match hosts.find(|path| path.is_file()) {
        Some(path) => Ok(Command::new(path)),
        None => Err(Trouble::usage(format!("missing: {name}"))),
    }
}

/// All files below a folder, as named from there, in order; none where there is no folder.
pub fn files(folder: &Path) -> Result<Vec<PathBuf>, Trouble> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(path) = open.pop() {
        if path.is_dir() {
            for entry in fs::read_dir(&path)? {
                open.push(entry?.path());
            }
        } else if path.exists() {
            found.push(path.strip_prefix(folder)?.to_path_buf());
        }
    }
    found.sort();
    Ok(found)
}
