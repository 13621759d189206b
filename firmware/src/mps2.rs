//! QEMU's board mps2-an500: the registers of its FPGA as pins, counter and delay,
//! files on the host through semihosting, and the stack.

#![allow(unsafe_code)] // registers, semihosting calls and the painted stack

mod ethernet;
mod fpga;
mod host_file;
mod lan9118;
mod register;
mod stack;
mod uart;

pub use ethernet::{Ethernet, Memory, PORT, Trouble};
pub use fpga::{Counter, Led, instructions};
pub use host_file::{HostFile, HostSwitch};
pub use stack::high_water;
pub use uart::Uart;

/// Says what went wrong and ends the program with exit code 1.
pub fn panicked(info: &core::panic::PanicInfo<'_>) -> ! {
    cortex_m_semihosting::hprintln!("{}", info);
    exit(false)
}

/// Ends the program: exit code 0 or 1.
pub fn exit(success: bool) -> ! {
    use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
    exit(if success { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}
