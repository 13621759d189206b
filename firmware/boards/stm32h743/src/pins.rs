//! Pins of the HAL, which implement embedded-hal 0.2, for the interlock, which wants 1.0.

use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin, OutputPin};
use embedded_hal_02::digital::v2;

/// A pin.
#[derive(Debug)]
pub struct Pin<P>(pub P);

/// The pin could not be read or set.
#[derive(Clone, Copy, Debug)]
pub struct Unusable;

impl Error for Unusable {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl<P> ErrorType for Pin<P> {
    type Error = Unusable;
}

impl<P: v2::InputPin> InputPin for Pin<P> {
    fn is_high(&mut self) -> Result<bool, Unusable> {
        self.0.is_high().map_err(|_| Unusable)
    }

    fn is_low(&mut self) -> Result<bool, Unusable> {
        self.0.is_low().map_err(|_| Unusable)
    }
}

impl<P: v2::OutputPin> OutputPin for Pin<P> {
    fn set_low(&mut self) -> Result<(), Unusable> {
        self.0.set_low().map_err(|_| Unusable)
    }

    fn set_high(&mut self) -> Result<(), Unusable> {
        self.0.set_high().map_err(|_| Unusable)
    }
}
