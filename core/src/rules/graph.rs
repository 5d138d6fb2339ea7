//! The radio graph: the pairs of UAVs that hear each other, and the throughput of each UAV.

use crate::config::Cell;
use crate::lanes::{self, Block, Cells, Lanes, at_width, ones};
use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::{Scratch, by_pairs, tile};
use crate::words::bits;
use crate::words::word::canonical_bits;

/// Builds the graph from positions and pilot densities.
// Proof: proofs/communication.rs, building_the_graph_keeps_its_contract
#[inline(always)]
pub(crate) fn build_graph(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    if by_pairs(model.uav_count()) {
        at_width!(model, link_by_pairs(model, state, scratch));
    } else {
        link_by_buckets(model, state, scratch);
        measure_throughput(model, state);
    }
}

/// Finds the links and the throughput in one pass over the pairs.
#[inline(always)]
pub(crate) fn link_by_pairs<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) {
    let (sums, throughput) = scratch.pairs::<W>(model.uav_count());
    for block in lanes::blocks(model.uav_count()) {
        meet(model, state, sums, throughput, block);
    }
    for block in lanes::blocks::<W>(model.uav_count()) {
        average(state, sums, block);
    }
    average_throughput(model, state);
}

/// A UAV with the quantities that decide its links.
#[derive(Clone, Copy)]
struct Radio {
    uav: usize,
    cell: Cell,
    load: f64,
}

impl Radio {
    #[inline(always)]
    fn of(state: &StateMut<'_>, uav: usize) -> Self {
        Self {
            uav,
            cell: state.cell(uav),
            load: 1.0 - state.pilot_density(uav),
        }
    }
}

/// Whether two UAVs with communication loads `a` and `b` hear each other: η_ij and η_ji both reach
/// η_link.
#[inline(always)]
pub(crate) fn hear_each_other(a: f64, b: f64, full_throughput: f64, least: f64) -> bool {
    let least_load = if a < b { a } else { b };
    least_load * full_throughput >= least
}

/// Finds the links of a block's UAVs, and the sums of their throughput over these links. A UAV is
/// compared with the others in ascending order, so that the sum is that of [`measure_throughput`].
///
/// A wide block is compared with the whole fleet. A single UAV is compared with those before it,
/// and is added to their links. So each pair is compared once, which would not pay with vectors.
#[inline(always)]
fn meet<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    all_sums: &mut [u64],
    throughput: &mut [Lanes<u64, W>],
    block: Block<W>,
) {
    let (full, least) = (model.full_throughput(), model.link_throughput_min());
    let cells = Cells::load(block, state.cells).rows(model.config().grid_width);
    let flies = !block.bits(state.grounded) & block.mask();
    let pilot = block.load(state.pilot);
    let mut loads = [0.0; W];
    for lane in 0..W {
        loads[lane] = 1.0 - f64::from_bits(pilot[lane]);
    }
    let (mut rows, mut sums) = ([0u64; W], [0.0; W]);
    let end = match (W, flies) {
        (_, 0) => 0,
        (1, _) => block.first,
        _ => model.uav_count(),
    };
    for first in (0..end).step_by(tile(W)) {
        let last = if first + tile(W) < end {
            first + tile(W)
        } else {
            end
        };
        for (throughput, &cell) in throughput.iter_mut().zip(&state.cells[first..last]) {
            full.gather_into(&cells, Cell::from_word(cell), throughput);
        }
        if first <= block.first && block.first < last {
            // A UAV is not its own neighbour: no comparison with NaN is true.
            for (lane, &index) in block.indices().iter().enumerate() {
                throughput[block.first - first + index as usize][lane] = f64::NAN.to_bits();
            }
        }
        let (pilot, links) = (&state.pilot[first..last], &mut state.links[first..last]);
        let their_sums = &mut all_sums[first..last];
        let mut flying = !state.grounded[0] >> first & bits::valid_mask(0, last - first);
        while flying != 0 {
            let index = flying.trailing_zeros() as usize % tile(W);
            flying &= flying - 1;
            let (load, bit) = (1.0 - f64::from_bits(pilot[index]), 1 << (first + index));
            let throughput = &throughput[index];
            for lane in 0..W {
                let full = f64::from_bits(throughput[lane]);
                let mask = ones(hear_each_other(loads[lane], load, full, least));
                let added = f64::from_bits(throughput[lane] & mask);
                rows[lane] |= mask & bit;
                sums[lane] += added;
                if W == 1 {
                    links[index] |= mask & 1 << block.first;
                    their_sums[index] = (f64::from_bits(their_sums[index]) + added).to_bits();
                }
            }
        }
    }
    lanes::force_vector(&mut rows);
    lanes::force_vector(&mut sums);
    let flies = lanes::spread::<W>(flies);
    let mut bits = [0; W];
    for lane in 0..W {
        rows[lane] &= flies[lane];
        bits[lane] = sums[lane].to_bits() & flies[lane];
    }
    block.store(&rows, state.links);
    block.store(&bits, all_sums);
}

/// η̄_i of a block's UAVs from their links and the sums over them.
#[inline(always)]
fn average<const W: usize>(state: &mut StateMut<'_>, sums: &[u64], block: Block<W>) {
    let (links, sums) = (block.load(state.links), block.load(sums));
    let pilot = block.load(state.pilot);
    let mut means = [0; W];
    for lane in 0..W {
        let load = 1.0 - f64::from_bits(pilot[lane]);
        let degree = links[lane].count_ones();
        means[lane] = canonical_bits(mean_throughput(load, f64::from_bits(sums[lane]), degree));
    }
    block.store(&means, state.throughput);
}

/// Finds the links by sorting the UAVs into square buckets as wide as the longest possible link. A
/// UAV's neighbours lie in its own bucket and the eight around it.
// Proof: proofs/communication.rs, buckets_link_the_pairs_that_pairs_link
#[inline(always)]
pub(crate) fn link_by_buckets(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) {
    state.links.fill(0);
    let columns = model.bucket_columns();
    let rows = model.bucket_count() / columns;
    let (starts, members) = scratch.buckets(model);
    fill_buckets(model, state, starts, members);
    // Filling has moved each start to its end, which is the next bucket's start.
    let start = |bucket: usize| {
        if bucket == 0 {
            0
        } else {
            starts[bucket - 1] as usize
        }
    };
    for bucket in 0..model.bucket_count() {
        let (column, row) = (bucket % columns, bucket / columns);
        for member in start(bucket)..starts[bucket] as usize {
            let radio = Radio::of(state, members[member] as usize);
            // The rest of its own bucket, the next one in its row, and three of the row above: each
            // pair of buckets once.
            let next = bucket + usize::from(column + 1 < columns);
            for other in member + 1..starts[next] as usize {
                link(model, state, radio, members[other] as usize);
            }
            if row + 1 < rows {
                let above = bucket + columns;
                let first = start(above - usize::from(column > 0));
                let last = starts[above + usize::from(column + 1 < columns)] as usize;
                for other in first..last {
                    link(model, state, radio, members[other] as usize);
                }
            }
        }
    }
}

/// Links a UAV with another if they hear each other.
#[inline(always)]
fn link(model: &Model<'_>, state: &mut StateMut<'_>, radio: Radio, other: usize) {
    let other = Radio::of(state, other);
    let throughput = model.full_throughput().between(radio.cell, other.cell);
    let least = model.link_throughput_min();
    if hear_each_other(radio.load, other.load, throughput, least) {
        let row = model.uav_words();
        bits::set(&mut state.links[radio.uav * row..], other.uav);
        bits::set(&mut state.links[other.uav * row..], radio.uav);
    }
}

/// Counting sort of the UAVs that are not grounded; `starts` ends as the end of each bucket.
#[inline(always)]
fn fill_buckets(model: &Model<'_>, state: &StateMut<'_>, starts: &mut [u64], members: &mut [u64]) {
    starts.fill(0);
    for i in 0..model.uav_count() {
        if !bits::get(state.grounded, i) {
            starts[model.bucket(state.cell(i)) + 1] += 1;
        }
    }
    for bucket in 0..starts.len() - 1 {
        starts[bucket + 1] += starts[bucket];
    }
    for i in 0..model.uav_count() {
        if !bits::get(state.grounded, i) {
            let slot = &mut starts[model.bucket(state.cell(i))];
            members[*slot as usize] = i as u64;
            *slot += 1;
        }
    }
}

/// The throughput of every UAV over the present graph, neighbours in ascending order.
#[inline(always)]
pub(crate) fn measure_throughput(model: &Model<'_>, state: &mut StateMut<'_>) {
    let full = model.full_throughput();
    let words = model.uav_words();
    for i in 0..model.uav_count() {
        let cell = state.cell(i);
        let (mut sum, mut degree) = (0.0, 0);
        for (word, &set) in state.links[i * words..(i + 1) * words].iter().enumerate() {
            let mut rest = set;
            degree += set.count_ones();
            while rest != 0 {
                let k = word * 64 + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                sum += full.between(cell, state.cell(k));
            }
        }
        let load = 1.0 - state.pilot_density(i);
        state.set_throughput(i, mean_throughput(load, sum, degree));
    }
    average_throughput(model, state);
}

/// η̄_i: the mean over neighbours of ρ_comm,i · log2(1 + SNR_ij)/6; 0 without any.
// Proof: proofs/communication.rs, a_mean_throughput_is_bounded
#[inline(always)]
pub(crate) fn mean_throughput(load: f64, sum: f64, degree: u32) -> f64 {
    // Without neighbours the sum is 0, over anything.
    let divisor = if degree == 0 { 1 } else { degree as i32 };
    load * sum / f64::from(divisor)
}

/// η̄(t): the mean over all UAVs.
#[inline(always)]
fn average_throughput(model: &Model<'_>, state: &mut StateMut<'_>) {
    let mut fleet = 0.0;
    for i in 0..model.uav_count() {
        fleet += f64::from_bits(state.throughput[i]);
    }
    let mean = fleet / model.uav_count() as f64;
    state.header.set_mean_throughput(mean);
}
