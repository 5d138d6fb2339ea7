//! X3 for blocks and gathers. A block of any count and position reads and writes the rows and sets
//! of its own UAVs only. A gather reads its table at the offset of two cells. Both hold at the
//! width of large fleets and at Kani's width.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Cell;
use crate::lanes::{Block, Cells, Lanes};

/// Width of large fleets.
const FLOWN: usize = 16;
/// A row of two blocks and a part of one.
const ROW: usize = 40;

fn any_block<const W: usize>(uavs: usize) -> Block<W> {
    let first = between(0, (uavs / W) as u64 - 1) as usize * W;
    let count = between(1, W as u64) as usize;
    Block { first, count }
}

/// What a block loads is its UAVs' part of a row, and what it stores is written there and nowhere
/// else.
fn loads_and_stores_its_own<const W: usize>(
    block: Block<W>,
    row: &[u8; ROW],
    lanes: &Lanes<u8, W>,
) {
    let index = between(0, block.count as u64 - 1) as usize;
    let lane = block.lane(index);
    assert!(lane < W && block.indices()[lane] as usize == index);
    assert!(block.load(row)[lane] == row[block.first + index]);
    let mut after = *row;
    block.store(lanes, &mut after);
    assert!(after[block.first + index] == lanes[lane]);
    let other = between(0, ROW as u64 - 1) as usize;
    let own = other >= block.first && other < block.first + block.count;
    assert!(own || after[other] == row[other]);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(17))]
pub fn a_block_loads_and_stores_its_own_uavs() {
    let block = any_block::<FLOWN>(ROW);
    kani::cover!(block.count == FLOWN, "a full block");
    kani::cover!(block.count == FLOWN / 2 - 1, "less than half of one");
    kani::cover!(
        block.count == 9 && block.first == FLOWN,
        "one with spare lanes"
    );
    loads_and_stores_its_own(block, &kani::any(), &kani::any());
    if !cfg!(kani) {
        loads_and_stores_its_own(any_block::<2>(ROW), &kani::any(), &kani::any());
        loads_and_stores_its_own(any_block::<1>(ROW), &kani::any(), &kani::any());
    }
}

/// A set goes into lanes and back, the block's UAVs alone are written, and each UAV has the bit of
/// its lane.
fn sets_are_its_uavs<const W: usize>(block: Block<W>, set: u64, lanes: u64) {
    let uavs = u64::MAX >> (64 - block.count) << block.first;
    let mut after = [set];
    block.put_bits(lanes, &mut after);
    assert!((after[0] ^ set) & !uavs == 0);
    assert!(after[0] & uavs == block.uavs_in(lanes) << block.first);
    assert!(block.bits(&after) == lanes & block.mask());
    assert!(block.mask().count_ones() as usize == block.count);
    let index = between(0, block.count as u64 - 1) as usize;
    assert!(after[0] >> (block.first + index) & 1 == lanes >> block.lane(index) & 1);
}

#[cfg_attr(kani, kani::proof)]
pub fn a_blocks_sets_are_those_of_its_uavs() {
    let block = any_block::<FLOWN>(64);
    let (set, lanes): (u64, u64) = (kani::any(), kani::any());
    kani::cover!(
        block.first == 48 && block.count == FLOWN,
        "the last full block"
    );
    kani::cover!(block.count == 3, "less than half of one");
    kani::cover!(block.count == 9, "one with spare lanes");
    sets_are_its_uavs(block, set, lanes);
    if !cfg!(kani) {
        sets_are_its_uavs(any_block::<2>(64), set, lanes);
        sets_are_its_uavs(any_block::<1>(64), set, lanes);
    }
}

/// Most cells of a grid whose offsets are bytes.
const CELLS: usize = 256;
/// The widest grid of the proof, which is the widest square one whose offsets are bytes.
const WIDTH_MAX: u32 = 16;

const fn indices() -> [u64; CELLS] {
    let mut table = [0; CELLS];
    let mut index = 0;
    while index < CELLS {
        table[index] = index as u64;
        index += 1;
    }
    table
}

fn any_cell(width: u32, height: u32) -> Cell {
    Cell {
        x: between(0, u64::from(width) - 1) as u32,
        y: between(0, u64::from(height) - 1) as u32,
    }
}

/// In any grid of a width, the index of an offset is |Δy| · width + |Δx|, in bytes and in words,
/// and lies in the grid.
fn indexes_the_offset<const W: usize>(width: u32) -> u32 {
    let height = between(1, CELLS as u64 / u64::from(width)) as u32;
    let (from, to) = (any_cell(width, height), any_cell(width, height));
    let rows = Cells::of(&[from.to_word(); W]).rows(width);
    let (bytes, words) = (rows.byte_offsets(to, width), rows.offsets(to, width));
    let offset = from.y.abs_diff(to.y) * width + from.x.abs_diff(to.x);
    let lane = between(0, W as u64 - 1) as usize;
    assert!(offset < width * height);
    assert!(words[lane] == offset && u32::from(bytes[lane]) == offset);
    offset
}

/// A gather reads the entry of the offset. Each entry of this table is its own index.
fn gathers_the_offset<const W: usize>(width: u32, height: u32) -> u64 {
    const TABLE: [u64; CELLS] = indices();
    let (from, to) = (any_cell(width, height), any_cell(width, height));
    let lane = between(0, W as u64 - 1) as usize;
    let rows = Cells::of(&[from.to_word(); W]).rows(width);
    let len = (width * height) as usize;
    let offset = u64::from(from.y.abs_diff(to.y) * width + from.x.abs_diff(to.x));
    let (mut by_bytes, mut by_words) = ([0; W], [0; W]);
    rows.gather(&TABLE, len, to, width, &mut by_bytes);
    rows.gather(&TABLE[..len], len, to, width, &mut by_words);
    assert!(by_bytes[lane] == offset && by_words[lane] == offset);
    offset
}

/// The width is a constant of each turn, so that no product is symbolic.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(17))]
pub fn an_offset_is_an_index_of_the_grid() {
    for width in 1..=WIDTH_MAX {
        let offset = indexes_the_offset::<2>(width);
        kani::cover!(offset == 0, "the same cell");
        kani::cover!(offset == 255, "the opposite corner");
    }
    if !cfg!(kani) {
        indexes_the_offset::<FLOWN>(between(1, CELLS as u64) as u32);
        indexes_the_offset::<1>(between(1, CELLS as u64) as u32);
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(17))]
pub fn a_gather_stays_within_its_table() {
    let offset = gathers_the_offset::<2>(12, 12);
    kani::cover!(offset == 0, "the same cell");
    kani::cover!(offset == 143, "the opposite corner");
    if !cfg!(kani) {
        gathers_the_offset::<FLOWN>(16, 16);
        gathers_the_offset::<1>(16, 16);
    }
}

#[cfg(not(kani))]
super::standin::twins! {
    a_block_loads_and_stores_its_own_uavs: 4000 cases, 3 covers;
    a_blocks_sets_are_those_of_its_uavs: 4000 cases, 3 covers;
    an_offset_is_an_index_of_the_grid: 1000 cases, 2 covers;
    a_gather_stays_within_its_table: 4000 cases, 2 covers;
}
