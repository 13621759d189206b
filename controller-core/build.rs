//! Tells the square root in `real` whether the target CPU is a Cortex-M7 with its
//! FPU: stable Rust does not expose ARM FPU features as `cfg(target_feature)`.

use std::env;

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
}
