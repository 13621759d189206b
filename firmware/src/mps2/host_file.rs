//! A file on the host, read through semihosting.

use cortex_m_semihosting::syscall;

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
