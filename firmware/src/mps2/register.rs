//! Registers of the board.

use core::ptr;

/// What the register at `address` says.
#[inline(always)]
pub fn read(address: usize) -> u32 {
    // SAFETY: the modules beside this one give addresses of the board's registers only, each
    // with one user, and the images have one thread.
    unsafe { ptr::read_volatile(address as *const u32) }
}

/// Writes the register at `address`.
#[inline(always)]
pub fn write(address: usize, value: u32) {
    // SAFETY: as above.
    unsafe { ptr::write_volatile(address as *mut u32, value) }
}
