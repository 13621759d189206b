//! Numbers in little endian. Reading beyond the end gives zeros, writing beyond the end
//! does nothing: lengths are checked once, before.

use crate::error::Error;

/// A fixed number of bytes at `at`.
#[inline]
pub(crate) fn get<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let tail = bytes.get(at..).unwrap_or(&[]);
    tail.first_chunk().copied().unwrap_or([0; N])
}

/// Writes bytes at `at`.
#[inline]
pub(crate) fn put<const N: usize>(bytes: &mut [u8], at: usize, value: [u8; N]) {
    if let Some(place) = bytes.get_mut(at..).and_then(|tail| tail.first_chunk_mut()) {
        *place = value;
    }
}

/// The first of `values` that is infinite or NaN.
pub(crate) fn check_finite(field: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(Error::NotFinite { field, index }),
        None => Ok(()),
    }
}

/// A bool: 0 or 1 in a byte.
pub(crate) fn check_bool(field: &'static str, index: usize, byte: u8) -> Result<bool, Error> {
    match byte {
        0 => Ok(false),
        1 => Ok(true),
        found => Err(Error::Bool {
            field,
            index,
            found,
        }),
    }
}

/// Reads fields that lie one behind the other.
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let value = get(self.bytes, self.at);
        self.at = self.at.saturating_add(N);
        value
    }

    pub(crate) fn u8(&mut self) -> u8 {
        u8::from_le_bytes(self.take())
    }

    pub(crate) fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    pub(crate) fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub(crate) fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    pub(crate) fn real(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    pub(crate) fn reals<const N: usize>(&mut self) -> [f64; N] {
        core::array::from_fn(|_| self.real())
    }

    pub(crate) fn bool(&mut self, field: &'static str) -> Result<bool, Error> {
        check_bool(field, 0, self.u8())
    }

    pub(crate) fn bools<const N: usize>(
        &mut self,
        field: &'static str,
    ) -> Result<[bool; N], Error> {
        let mut values = [false; N];
        for (index, value) in values.iter_mut().enumerate() {
            *value = check_bool(field, index, self.u8())?;
        }
        Ok(values)
    }

    /// What has not been read.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or(&[])
    }
}

/// Writes fields one behind the other.
pub(crate) struct Writer<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl<'a> Writer<'a> {
    pub(crate) fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(crate) fn put<const N: usize>(&mut self, value: [u8; N]) {
        put(self.bytes, self.at, value);
        self.at = self.at.saturating_add(N);
    }

    pub(crate) fn u8(&mut self, value: u8) {
        self.put([value]);
    }

    pub(crate) fn u16(&mut self, value: u16) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn u32(&mut self, value: u32) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn reals(&mut self, values: &[f64]) {
        for value in values {
            self.put(value.to_le_bytes());
        }
    }

    pub(crate) fn bools(&mut self, values: &[bool]) {
        for &value in values {
            self.u8(u8::from(value));
        }
    }

    pub(crate) fn slice(&mut self, values: &[u8]) {
        let place = self.bytes.iter_mut().skip(self.at);
        for (place, value) in place.zip(values) {
            *place = *value;
        }
        self.at = self.at.saturating_add(values.len());
    }

    /// Bytes so far, those beyond the end included.
    pub(crate) fn written(&self) -> usize {
        self.at
    }

    /// What has been written, if there was room for it.
    pub(crate) fn finish(self) -> Result<&'a [u8], Error> {
        let (needed, found) = (self.at, self.bytes.len());
        let bytes: &'a [u8] = self.bytes;
        bytes.get(..needed).ok_or(Error::Room { found, needed })
    }
}
