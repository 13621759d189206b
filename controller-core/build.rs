//! Tells the square root in `real` whether the target CPU is a Cortex-M7 with its
//! FPU: stable Rust does not expose ARM FPU features as `cfg(target_feature)`. Tells files that were
//! written from this text which text it is.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo::rustc-check-cfg=cfg(fpu)");
    println!("cargo::rerun-if-changed=build.rs");
    let arch = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let abi = env::var("CARGO_CFG_TARGET_ABI").unwrap_or_default();
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let cortex_m7 = flags
        .split('\x1f')
        .any(|flag| flag.ends_with("target-cpu=cortex-m7"));
    if arch == "arm" && abi == "eabihf" && cortex_m7 {
        println!("cargo::rustc-cfg=fpu");
    }
    println!("cargo::rerun-if-changed=src");
    println!(
        "cargo::rustc-env=STRATUM_SOURCE={:016x}",
        source(Path::new("src"))
    );
}

/// FNV-1a of all files of a folder, whatever ends their lines.
fn source(folder: &Path) -> u64 {
    let (mut folders, mut files) = (vec![folder.to_path_buf()], Vec::<PathBuf>::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in files
        .iter()
        .flat_map(|file| fs::read(file).unwrap_or_default())
    {
        if byte != b'\r' {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    hash
}
