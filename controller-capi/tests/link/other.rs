//! Somebody else's static library in Rust, which knows nothing of the controller: with a panic
//! handler, with unwinding where there is any, with copies and 64-bit division.

#![cfg_attr(target_os = "none", no_std)]

/// Sum of the decimal digits of `number`.
#[unsafe(no_mangle)]
pub extern "C" fn other_digit_sum(number: u64) -> u32 {
    let (mut rest, mut sum) = (number, 0);
    while rest > 0 {
        sum += (rest % 10) as u32;
        rest /= 10;
    }
    sum
}

/// The entry of a table; 0 beyond its end, which is found out by a panic on systems that
/// unwind, and by looking on bare metal.
#[unsafe(no_mangle)]
pub extern "C" fn other_entry(index: usize) -> u32 {
    let mut table = [0; 8];
    table.copy_from_slice(core::hint::black_box(&[11, 12, 13, 14, 15, 16, 17, 18]));
    #[cfg(not(target_os = "none"))]
    {
        std::panic::set_hook(Box::new(|_| ())); // says nothing
        std::panic::catch_unwind(|| table[index]).unwrap_or(0)
    }
    #[cfg(target_os = "none")]
    if index < core::hint::black_box(8) { table[index] } else { 0 }
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
