//! Words of a table at an index for each lane.

use super::{Lanes, force_vector};

/// Largest table whose indices fit a byte, which needs no bounds check.
const BYTE: usize = 256;

/// The table as one with byte indices, if it is small. `None` at a width of one, where a bounds
/// check costs no more than the conversion to a byte.
#[inline(always)]
pub(super) fn in_bytes<const W: usize>(table: &[u64], len: usize) -> Option<&[u64; BYTE]> {
    if W > 1 && len <= BYTE {
        table.first_chunk()
    } else {
        None
    }
}

/// Gathers the words of a table at an index for each lane. The table has `len` entries; `table` may
/// hold more words after it.
#[inline(always)]
pub(crate) fn gather<const W: usize>(
    table: &[u64],
    len: usize,
    index: &Lanes<u32, W>,
) -> Lanes<u64, W> {
    let mut words = [0; W];
    match in_bytes::<W>(table, len) {
        Some(table) => gather_bytes(table, index.map(|index| index as u8), &mut words),
        None => gather_words(table, *index, &mut words),
    }
    words
}

#[inline(always)]
pub(super) fn gather_bytes<const W: usize>(
    table: &[u64; BYTE],
    mut index: Lanes<u8, W>,
    words: &mut Lanes<u64, W>,
) {
    force_vector(&mut index);
    for lane in 0..W {
        words[lane] = table[usize::from(index[lane])];
    }
}

#[inline(always)]
pub(super) fn gather_words<const W: usize>(
    table: &[u64],
    mut index: Lanes<u32, W>,
    words: &mut Lanes<u64, W>,
) {
    force_vector(&mut index);
    for lane in 0..W {
        words[lane] = table[index[lane] as usize];
    }
}
