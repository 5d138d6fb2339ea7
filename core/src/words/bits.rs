//! Sets of small integers as rows of 64-bit words.

/// Number of `u64` words that hold `count` bits.
#[inline(always)]
#[must_use]
pub const fn words_for(count: usize) -> usize {
    count.div_ceil(64)
}

/// Whether bit `index` is set.
#[inline(always)]
#[must_use]
pub const fn get(row: &[u64], index: usize) -> bool {
    row[index / 64] >> (index % 64) & 1 == 1
}

/// Sets bit `index`.
#[inline(always)]
pub const fn set(row: &mut [u64], index: usize) {
    row[index / 64] |= 1 << (index % 64);
}

/// Writes bit `index`.
#[inline(always)]
pub const fn assign(row: &mut [u64], index: usize, value: bool) {
    let mask = 1 << (index % 64);
    row[index / 64] = row[index / 64] & !mask | if value { mask } else { 0 };
}

/// The number of nested sets that have bit `index`, of sets of `words` words each.
#[inline]
#[must_use]
pub fn level(sets: &[u64], words: usize, index: usize) -> u32 {
    let (mut level, mut begin) = (0, 0);
    while begin < sets.len() {
        level += u32::from(get(&sets[begin..], index));
        begin += words;
    }
    level
}

/// The bits of word `word` that belong to a set of `count` bits.
#[inline(always)]
#[must_use]
pub const fn valid_mask(word: usize, count: usize) -> u64 {
    let used = count.saturating_sub(word * 64);
    if used >= 64 {
        u64::MAX
    } else {
        (1 << used) - 1
    }
}

/// The bits of word `word` that lie in `begin..end`.
#[inline]
const fn range_mask(word: usize, begin: usize, end: usize) -> u64 {
    valid_mask(word, end) & !valid_mask(word, begin)
}

/// Sets the bits in `begin..end`.
#[inline]
pub fn set_range(row: &mut [u64], begin: usize, end: usize) {
    for word in begin / 64..words_for(end) {
        row[word] |= range_mask(word, begin, end);
    }
}

/// Number of set bits in `begin..end`.
#[inline]
#[must_use]
pub fn count_range(row: &[u64], begin: usize, end: usize) -> usize {
    let mut total = 0;
    for word in begin / 64..words_for(end) {
        total += (row[word] & range_mask(word, begin, end)).count_ones() as usize;
    }
    total
}

/// Number of set bits.
#[inline(always)]
#[must_use]
pub fn count(row: &[u64]) -> usize {
    let mut total = 0;
    for word in row {
        total += word.count_ones() as usize;
    }
    total
}

/// Whether no bit is set.
#[inline(always)]
#[must_use]
pub fn is_empty(row: &[u64]) -> bool {
    let mut any = 0;
    for word in row {
        any |= word;
    }
    any == 0
}

/// Whether every bit of `a` is set in `b`; both of the same length.
#[must_use]
pub fn is_subset(a: &[u64], b: &[u64]) -> bool {
    let mut outside = 0;
    for word in 0..a.len() {
        outside |= a[word] & !b[word];
    }
    outside == 0
}

/// Whether no bit at or above `count` is set.
#[must_use]
pub fn fits(row: &[u64], count: usize) -> bool {
    let mut outside = 0;
    for word in 0..row.len() {
        outside |= row[word] & !valid_mask(word, count);
    }
    outside == 0
}

/// The set bits in ascending order.
pub fn iter(row: &[u64]) -> impl Iterator<Item = usize> + '_ {
    row.iter().enumerate().flat_map(|(index, &word)| {
        let mut rest = word;
        core::iter::from_fn(move || {
            if rest == 0 {
                return None;
            }
            let bit = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            Some(index * 64 + bit)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_and_reads_across_words() {
        let mut row = [0u64; 3];
        for index in [0, 63, 64, 129] {
            set(&mut row, index);
            assert!(get(&row, index));
        }
        assert!(iter(&row).eq([0, 63, 64, 129]));
        assert_eq!(count(&row), 4);
        assign(&mut row, 64, false);
        assert!(!get(&row, 64));
        assert!(fits(&row, 130) && !fits(&row, 129));
        assert_eq!(valid_mask(1, 64), 0);
        assert_eq!(valid_mask(0, 64), u64::MAX);
        assert!(is_subset(&[1, 2], &[3, 2]) && !is_subset(&[4], &[3]));
    }

    #[test]
    fn ranges_are_the_bits_one_by_one() {
        for begin in 0..140 {
            for end in begin..=140 {
                let (mut row, mut single) = ([0u64; 3], [0u64; 3]);
                set_range(&mut row, begin, end);
                (begin..end).for_each(|index| set(&mut single, index));
                assert_eq!(row, single, "{begin}..{end}");
                assert_eq!(count_range(&[u64::MAX; 3], begin, end), end - begin);
                assert_eq!(
                    count_range(&row, 60, 130),
                    count(&row) - count_range(&row, 0, 60) - count_range(&row, 130, 140)
                );
            }
        }
    }
}
