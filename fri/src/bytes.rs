//! Numbers at an offset of a datagram. Reading beyond the end gives zeros,
//! writing beyond the end does nothing: views check the length once.

/// A fixed number of bytes at `at`.
#[must_use]
#[inline]
pub fn get<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let tail = bytes.get(at..).unwrap_or(&[]);
    tail.first_chunk().copied().unwrap_or([0; N])
}

/// Writes bytes at `at`.
#[inline]
pub fn put<const N: usize>(bytes: &mut [u8], at: usize, value: [u8; N]) {
    if let Some(place) = bytes.get_mut(at..).and_then(|tail| tail.first_chunk_mut()) {
        *place = value;
    }
}

/// An unsigned 16-bit number.
#[must_use]
#[inline]
pub fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(get(bytes, at))
}

/// An unsigned 32-bit number.
#[must_use]
#[inline]
pub fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(get(bytes, at))
}

/// Consecutive reals.
#[must_use]
#[inline]
pub fn f32s_at<const N: usize>(bytes: &[u8], at: usize) -> [f32; N] {
    core::array::from_fn(|i| f32::from_le_bytes(get(bytes, at.saturating_add(4 * i))))
}

/// Consecutive integers.
#[must_use]
#[inline]
pub fn i32s_at<const N: usize>(bytes: &[u8], at: usize) -> [i32; N] {
    core::array::from_fn(|i| i32::from_le_bytes(get(bytes, at.saturating_add(4 * i))))
}

/// Writes consecutive reals.
#[inline]
pub fn put_f32s(bytes: &mut [u8], at: usize, values: &[f32]) {
    for (i, value) in values.iter().enumerate() {
        put(bytes, at.saturating_add(4 * i), value.to_le_bytes());
    }
}

/// Writes consecutive integers.
#[inline]
pub fn put_i32s(bytes: &mut [u8], at: usize, values: &[i32]) {
    for (i, value) in values.iter().enumerate() {
        put(bytes, at.saturating_add(4 * i), value.to_le_bytes());
    }
}

/// The first number of `count` reals at `at` that is not finite.
pub(crate) fn first_not_finite(bytes: &[u8], at: usize, count: usize) -> Option<usize> {
    (0..count).find(|i| !f32::from_le_bytes(get(bytes, at + 4 * i)).is_finite())
}
