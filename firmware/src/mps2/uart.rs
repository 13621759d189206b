//! The board's first serial port, a CMSDK UART, polled.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, ReadReady, Write};

use super::register::{read, write};

const DATA: usize = 0x4000_4000;
const STATE: usize = 0x4000_4004;
const CONTROL: usize = 0x4000_4008;
const DIVIDER: usize = 0x4000_4010;

const TX_FULL: u32 = 1;
const RX_FULL: u32 = 2;

/// The port.
#[derive(Debug)]
pub struct Uart(());

impl Uart {
    /// Turns it on.
    #[must_use]
    pub fn start() -> Self {
        const LEAST_DIVIDER: u32 = 16;
        const RECEIVE_AND_SEND: u32 = 3;
        write(DIVIDER, LEAST_DIVIDER);
        write(CONTROL, RECEIVE_AND_SEND);
        Self(())
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(read(STATE) & RX_FULL != 0)
    }
}

impl Read for Uart {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let Some(place) = buffer.first_mut() else {
            return Ok(0);
        };
        while read(STATE) & RX_FULL == 0 {}
        *place = read(DATA) as u8;
        Ok(1)
    }
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let Some(byte) = bytes.first() else {
            return Ok(0);
        };
        while read(STATE) & TX_FULL != 0 {}
        write(DATA, u32::from(*byte));
        Ok(1)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
