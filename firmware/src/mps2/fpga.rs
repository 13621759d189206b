//! FPGAIO: two LEDs, two buttons, a counter of 25 MHz.

use core::convert::Infallible;
use core::ptr;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};

const LED: *mut u32 = 0x4002_8000 as *mut u32;
const BUTTON: *const u32 = 0x4002_8008 as *const u32;
const COUNTER: *mut u32 = 0x4002_8018 as *mut u32;
const PRESCALE: *mut u32 = 0x4002_801c as *mut u32;

/// Instructions in so many counter ticks, with `-icount shift=10`: an instruction
/// takes 1024 ns, a tick 40 ns.
#[must_use]
pub fn instructions(ticks: u32) -> u32 {
    // 25.6 ticks each; the reading is cut to whole ticks.
    ((u64::from(ticks) * 10 + 128) / 256) as u32
}

/// The free-running counter; also the delay of the board.
#[derive(Debug)]
pub struct Counter(());

impl Counter {
    /// Starts it at its full rate.
    #[must_use]
    pub fn start() -> Self {
        // SAFETY: a register of the board; it has no other user.
        unsafe { ptr::write_volatile(PRESCALE, 0) };
        Self(())
    }

    /// Ticks of 40 ns, wrapping around.
    #[must_use]
    #[inline(always)]
    pub fn ticks(&self) -> u32 {
        // SAFETY: reading the counter has no effect.
        unsafe { ptr::read_volatile(COUNTER) }
    }
}

impl DelayNs for Counter {
    fn delay_ns(&mut self, ns: u32) {
        let start = self.ticks();
        while self.ticks().wrapping_sub(start) < ns.div_ceil(40) {}
    }
}

/// LED 0 or 1 as an output.
#[derive(Debug)]
pub struct Led(u32);

impl Led {
    /// LED `index`, 0 or 1.
    #[must_use]
    pub fn new(index: u32) -> Self {
        Self(1 << index)
    }

    fn set(&mut self, on: bool) {
        // SAFETY: a register of the board, used by this thread only.
        unsafe {
            let others = ptr::read_volatile(LED) & !self.0;
            ptr::write_volatile(LED, if on { others | self.0 } else { others });
        }
    }

    /// Off, for a panic handler.
    pub fn force_low(&mut self) {
        self.set(false);
    }

    /// What the register says.
    #[must_use]
    pub fn is_on(&self) -> bool {
        // SAFETY: as above.
        unsafe { ptr::read_volatile(LED) & self.0 != 0 }
    }
}

impl ErrorType for Led {
    type Error = Infallible;
}

impl OutputPin for Led {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

/// Button 0 or 1 as an emergency stop: high while it is not pressed. QEMU's
/// buttons cannot be pressed.
#[derive(Debug)]
pub struct Button(u32);

impl Button {
    /// Button `index`, 0 or 1.
    #[must_use]
    pub fn new(index: u32) -> Self {
        Self(1 << index)
    }
}

impl ErrorType for Button {
    type Error = Infallible;
}

impl InputPin for Button {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        self.is_low().map(|low| !low)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        // SAFETY: reading the buttons has no effect.
        Ok(unsafe { ptr::read_volatile(BUTTON) } & self.0 != 0)
    }
}
