//! Tells the square root in `real` whether the target CPU has a
//! double-precision FPU: stable Rust does not expose ARM FPU features as
//! `cfg(target_feature)`.

use std::env;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(fpu_f64)");
    println!("cargo::rerun-if-changed=build.rs");
    let arch = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    if arch == "arm"
        && flags
            .split('\x1f')
            .any(|flag| flag.ends_with("target-cpu=cortex-m7"))
    {
        println!("cargo::rustc-cfg=fpu_f64");
    }
}
