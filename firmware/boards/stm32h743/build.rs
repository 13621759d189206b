//! Linker arguments: memory map, start-up code, code in ITCM.

use std::env;

fn main() {
    for file in ["build.rs", "memory.x", "itcm.x"] {
        println!("cargo::rerun-if-changed={file}");
    }
    let here = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo::rustc-link-search={here}");
    for argument in ["-Titcm.x", "-Tlink.x", "--nmagic"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
