//! Largest use of the stack by painting it.

use core::arch::asm;
use core::ptr;

/// Painted below the present stack pointer \[bytes\]: more than anything here needs.
const PAINTED: usize = 64 * 1024;

/// Left unpainted, for the painting itself: the floor of the method \[bytes\].
const MARGIN: usize = 64;

const PAINT: u32 = 0x5ca1_ab1e;

/// Bytes of stack that `work` uses at most, below the caller's frame. A lower
/// bound: only the paths that were taken count, and words that happen to keep
/// the paint do not.
#[inline(never)]
pub fn high_water(work: impl FnOnce()) -> u32 {
    let top = stack_pointer();
    let bottom = top - PAINTED;
    // SAFETY: the memory between the data and the stack pointer is free: the map
    // gives them 4 MB, and nothing interrupts.
    unsafe {
        for address in (bottom..top - MARGIN).step_by(4) {
            ptr::write_volatile(address as *mut u32, PAINT);
        }
    }
    work();
    // SAFETY: as above.
    let untouched = unsafe {
        (bottom..top)
            .step_by(4)
            .position(|address| ptr::read_volatile(address as *const u32) != PAINT)
    };
    untouched.map_or(0, |words| (PAINTED - 4 * words) as u32)
}

#[inline(always)]
fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack)) };
    pointer & !3
}
