//! Linker arguments of the bare-metal images; nothing on a host.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../memory.x");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let crate_dir = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let root = Path::new(&crate_dir).join("..");
    println!("cargo::rustc-link-search={}", root.display());
    for image in ["selftest", "bench", "arm", "fri", "footprint"] {
        println!("cargo::rustc-link-arg-bin={image}=-Tlink.x");
        println!("cargo::rustc-link-arg-bin={image}=--nmagic");
    }
    println!("cargo::rustc-link-arg-bin=arm=-Tdefmt.x");
    // Linked to prove something, never run: no start-up code, no memory map.
    println!("cargo::rustc-link-arg-bin=panic-free=--entry=exercise_all");
}
