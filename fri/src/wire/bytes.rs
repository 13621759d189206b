//! Numbers in bytes, total: what lies beyond the data reads as zero and is not
//! written. The checks of the views make sure that nothing does.

use super::field::Field;

fn read<const N: usize>(data: &[u8], field: Field) -> [u8; N] {
    let range = data.get(field.start..field.end);
    range
        .and_then(|bytes| bytes.first_chunk())
        .copied()
        .unwrap_or([0; N])
}

fn write<const N: usize>(data: &mut [u8], field: Field, value: [u8; N]) {
    let range = data.get_mut(field.start..field.end);
    if let Some(slot) = range.and_then(|bytes| bytes.first_chunk_mut()) {
        *slot = value;
    }
}

/// The field in groups of four bytes.
pub(super) fn words(data: &[u8], field: Field) -> impl Iterator<Item = &[u8; 4]> {
    data.get(field.start..field.end)
        .unwrap_or_default()
        .as_chunks()
        .0
        .iter()
}

fn words_mut(data: &mut [u8], field: Field) -> impl Iterator<Item = &mut [u8; 4]> {
    data.get_mut(field.start..field.end)
        .unwrap_or_default()
        .as_chunks_mut()
        .0
        .iter_mut()
}

pub(super) fn u16(data: &[u8], field: Field) -> u16 {
    u16::from_le_bytes(read(data, field))
}

pub(super) fn set_u16(data: &mut [u8], field: Field, value: u16) {
    write(data, field, value.to_le_bytes());
}

pub(super) fn u32(data: &[u8], field: Field) -> u32 {
    u32::from_le_bytes(read(data, field))
}

pub(super) fn set_u32(data: &mut [u8], field: Field, value: u32) {
    write(data, field, value.to_le_bytes());
}

pub(super) fn f32(data: &[u8], field: Field) -> f32 {
    f32::from_le_bytes(read(data, field))
}

pub(super) fn set_f32(data: &mut [u8], field: Field, value: f32) {
    write(data, field, value.to_le_bytes());
}

pub(super) fn f32s<const N: usize>(data: &[u8], field: Field) -> [f32; N] {
    let mut values = [0.0; N];
    for (value, word) in values.iter_mut().zip(words(data, field)) {
        *value = f32::from_le_bytes(*word);
    }
    values
}

pub(super) fn set_f32s(data: &mut [u8], field: Field, values: &[f32]) {
    for (word, value) in words_mut(data, field).zip(values) {
        *word = value.to_le_bytes();
    }
}

/// A matrix of `R` rows and `C` columns, row by row.
pub(super) fn rows<const R: usize, const C: usize>(data: &[u8], field: Field) -> [[f32; C]; R] {
    let mut rows = [[0.0; C]; R];
    for (value, word) in rows.as_flattened_mut().iter_mut().zip(words(data, field)) {
        *value = f32::from_le_bytes(*word);
    }
    rows
}

pub(super) fn i32s<const N: usize>(data: &[u8], field: Field) -> [i32; N] {
    let mut values = [0; N];
    for (value, word) in values.iter_mut().zip(words(data, field)) {
        *value = i32::from_le_bytes(*word);
    }
    values
}

pub(super) fn set_i32s(data: &mut [u8], field: Field, values: &[i32]) {
    for (word, value) in words_mut(data, field).zip(values) {
        *word = value.to_le_bytes();
    }
}
