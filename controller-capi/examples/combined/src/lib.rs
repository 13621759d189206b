//! One static library of several Rust crates: the controller's functions for C, which pass
//! through, and one of this crate. The panic handler is this crate's, so `controller-capi`
//! comes without its feature `panic-handler`.

#![cfg_attr(target_os = "none", no_std)]

pub use stratum::*;

/// First-order low-pass filter: `filtered` of the last cycle moved towards `input` by `share`,
/// 0 to 1, of their difference.
#[unsafe(no_mangle)]
pub extern "C" fn low_pass(filtered: f64, input: f64, share: f64) -> f64 {
    filtered + share * (input - filtered)
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
