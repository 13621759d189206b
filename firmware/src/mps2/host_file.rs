//! A file on the host, read through semihosting.

use core::convert::Infallible;

use cortex_m_semihosting::syscall;
use embedded_hal::digital::{ErrorType, InputPin};

/// An open file.
#[derive(Debug)]
pub struct HostFile(usize);

impl HostFile {
    /// Opens `path` for reading; relative to where QEMU was started.
    #[must_use]
    pub fn open(path: &core::ffi::CStr) -> Option<Self> {
        const READ_BINARY: usize = 1;
        let length = path.to_bytes().len();
        // SAFETY: the call reads `length` bytes of the path and nothing else.
        let handle = unsafe { syscall!(OPEN, path.as_ptr(), READ_BINARY, length) };
        (handle != usize::MAX).then_some(Self(handle))
    }

    /// Fills `buffer`; false at the end of the file.
    pub fn read(&mut self, buffer: &mut [u8]) -> bool {
        let length = buffer.len();
        // SAFETY: the call writes at most `length` bytes to the buffer. It returns
        // the number of bytes that are missing.
        unsafe { syscall!(READ, self.0, buffer.as_mut_ptr(), length) == 0 }
    }
}

impl Drop for HostFile {
    fn drop(&mut self) {
        // SAFETY: closes a handle that has no other user.
        unsafe { syscall!(CLOSE, self.0) };
    }
}

/// A switch on the host: low while a file of that name exists. In the place of
/// buttons, which cannot be pressed in QEMU.
#[derive(Debug)]
pub struct HostSwitch(&'static core::ffi::CStr);

impl HostSwitch {
    /// The switch with this file.
    #[must_use]
    pub fn new(path: &'static core::ffi::CStr) -> Self {
        Self(path)
    }
}

impl ErrorType for HostSwitch {
    type Error = Infallible;
}

impl InputPin for HostSwitch {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        self.is_low().map(|low| !low)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(HostFile::open(self.0).is_some())
    }
}
