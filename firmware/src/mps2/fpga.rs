//! FPGAIO: two LEDs, a counter of 25 MHz. Its buttons cannot be pressed in QEMU.

use core::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};

use super::register::{read, write};

const LED: usize = 0x4002_8000;
const COUNTER: usize = 0x4002_8018;
const PRESCALE: usize = 0x4002_801c;

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
        write(PRESCALE, 0);
        Self(())
    }

    /// Ticks of 40 ns, wrapping around.
    #[must_use]
    #[inline(always)]
    pub fn ticks(&self) -> u32 {
        read(COUNTER)
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

    /// What the register says.
    #[must_use]
    pub fn is_on(&self) -> bool {
        read(LED) & self.0 != 0
    }
}

impl ErrorType for Led {
    type Error = Infallible;
}

impl OutputPin for Led {
    fn set_low(&mut self) -> Result<(), Infallible> {
        write(LED, read(LED) & !self.0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        write(LED, read(LED) | self.0);
        Ok(())
    }
}
