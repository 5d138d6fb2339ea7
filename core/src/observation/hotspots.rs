//! The entries of each hotspot in an observation.

use core::ops::Range;

use super::{OWN, ROWS, View, flag};
use crate::config::Cell;
use crate::lanes::force_vector;
use crate::lanes::real::{Divisors, ENTRIES, repeat};

/// Number of hotspots that are written at a time.
const GROUP: usize = 8;

/// Number of entries of a hotspot.
const HOTSPOT_LEN: usize = 4;

/// The bits of 1.0 as f32.
const ONE: u32 = 1.0f32.to_bits();

/// Number of hotspots whose entries are computed together.
const QUARTET: usize = ENTRIES / HOTSPOT_LEN;

/// The set of four hotspots.
const ALL: usize = (1 << QUARTET) - 1;

/// Masks for each set of four hotspots. `KNOWN` has the bits of 1.0 in the entries for knowledge,
/// and `POSITIONS` has all ones in the entries for positions.
static KNOWN: [[u32; ENTRIES]; ALL + 1] = entries([0, 0, 0, ONE]);
static POSITIONS: [[u32; ENTRIES]; ALL + 1] = entries([u32::MAX, u32::MAX, 0, 0]);

const fn entries(bits: [u32; HOTSPOT_LEN]) -> [[u32; ENTRIES]; ALL + 1] {
    let (mut sets, mut set) = ([[0; ENTRIES]; ALL + 1], 0);
    while set <= ALL {
        let mut lane = 0;
        while lane < ENTRIES {
            if set >> (lane / HOTSPOT_LEN) & 1 == 1 {
                sets[set][lane] = bits[lane % HOTSPOT_LEN];
            }
            lane += 1;
        }
        set += 1;
    }
    sets
}

impl View<'_> {
    /// Writes (Δx/(W-1), Δy/(H-1), confirmed, known) of each hotspot for every UAV, eight hotspots
    /// at a time. If fewer than eight are left and the row has room, eight are written, because the
    /// entries after them are written later.
    #[inline(always)]
    pub(super) fn write_hotspots<const HIDDEN: bool>(&self, uavs: Range<usize>, out: &mut [f32]) {
        let (len, row_words) = (self.model.observation_len(), self.model.hotspot_words());
        // (x, y, 0, 0) of each UAV. All are stored before the first is read, because a load that
        // spans recent stores waits for them.
        let mut observers = [0.0; ROWS * HOTSPOT_LEN];
        let cells = self.state.cells[uavs.clone()].iter();
        for (own, &cell) in observers.chunks_exact_mut(HOTSPOT_LEN).zip(cells) {
            own[0] = cell as u32 as i32 as f32;
            own[1] = (cell >> 32) as i32 as f32;
        }
        force_vector(&mut observers);
        let knowledge = &self.state.knowledge[uavs.start * row_words..uavs.end * row_words];
        let divisors = Divisors::of([self.spans.0, self.spans.1, 1.0, 1.0]);
        for (block, words) in self.state.hotspots.chunks(GROUP).enumerate() {
            let (word, shift) = (block * GROUP / 64, block * GROUP % 64);
            let hotspots = hotspots(words, self.state.confirmed[word] >> shift);
            let begin = OWN + HOTSPOT_LEN * GROUP * block;
            let observers = observers.chunks_exact(HOTSPOT_LEN);
            let uavs = observers.zip(knowledge.chunks_exact(row_words));
            for (row, (own, known)) in out.chunks_exact_mut(len).zip(uavs) {
                let own = repeat([own[0], own[1], own[2], own[3]]);
                let known = (known[word] >> shift) as usize;
                let row = &mut row[begin..];
                if let Some(room) = row.first_chunk_mut() {
                    see::<HIDDEN>(&own, &hotspots, &divisors, known, room);
                } else {
                    let mut seen = [0.0; HOTSPOT_LEN * GROUP];
                    see::<HIDDEN>(&own, &hotspots, &divisors, known, &mut seen);
                    for (value, &seen) in row[..HOTSPOT_LEN * words.len()].iter_mut().zip(&seen) {
                        *value = seen;
                    }
                }
            }
        }
    }
}

/// Entries of eight hotspots, in parts that are computed together.
const PARTS: usize = GROUP * HOTSPOT_LEN / ENTRIES;

/// Entries of eight hotspots for one UAV. The UAV's place is (x, y, 0, 0), repeated.
#[inline(always)]
fn see<const HIDDEN: bool>(
    own: &[f32; ENTRIES],
    hotspots: &[f32; HOTSPOT_LEN * GROUP],
    divisors: &Divisors,
    known: usize,
    seen: &mut [f32; HOTSPOT_LEN * GROUP],
) {
    for part in 0..PARTS {
        let known = (known >> (part * QUARTET)) % (ALL + 1);
        for lane in 0..ENTRIES {
            let index = part * ENTRIES + lane;
            let mut offset = divisors.offset(own[lane], hotspots[index], lane).to_bits();
            if HIDDEN {
                offset &= !POSITIONS[ALL - known][lane];
            }
            seen[index] = f32::from_bits(offset | KNOWN[known][lane]);
        }
    }
}

/// (x, y, confirmed, 0) of up to eight hotspots.
#[inline(always)]
fn hotspots(words: &[u64], confirmed: u64) -> [f32; GROUP * HOTSPOT_LEN] {
    let mut hotspots = [0.0; GROUP * HOTSPOT_LEN];
    for (j, (&word, entries)) in words
        .iter()
        .zip(hotspots.chunks_exact_mut(HOTSPOT_LEN))
        .enumerate()
    {
        let cell = Cell::from_word(word);
        entries[0] = cell.x as i32 as f32;
        entries[1] = cell.y as i32 as f32;
        entries[2] = flag(confirmed >> j & 1 == 1);
    }
    force_vector(&mut hotspots);
    hotspots
}
