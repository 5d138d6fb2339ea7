//! The radio graph: who hears whom, and the throughput of each UAV in it.

use crate::bits;
use crate::config::Cell;
use crate::lanes::{self, Block, Cells, Lanes, WIDTH};
use crate::model::Model;
use crate::scratch::Scratch;
use crate::state::StateMut;
use crate::word::stored;

/// Up to this many UAVs, looking at every pair beats sorting them into buckets.
const FEW: usize = 48;
/// Room for the UAVs of a fleet that is not flown in lanes. A proof has no more UAVs than its model, and a longer
/// array would only cost its solver memory.
const ROOM: usize = if cfg!(kani) { 2 } else { lanes::FLEET };

/// Whether a fleet's links are looked for pair by pair, in lanes.
pub(crate) const fn in_lanes(uavs: usize) -> bool {
    uavs >= lanes::FLEET && uavs <= FEW
}

/// Builds the graph from positions and pilot densities.
#[inline(always)]
pub(crate) fn build_graph(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    let uavs = model.uav_count();
    if uavs < lanes::FLEET {
        link_few(model, state);
    } else if in_lanes(uavs) {
        for block in lanes::blocks(uavs) {
            link_in_lanes(model, state, scratch.pairs(), block);
        }
        average_throughput(model, state);
    } else {
        link_by_buckets(model, state, scratch);
        measure_throughput(model, state);
    }
}

/// A UAV that communicates.
#[derive(Clone, Copy, Default)]
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

    /// Whether two UAVs hear each other: η_ij and η_ji both reach η_link.
    #[inline(always)]
    fn hears(&self, other: &Self, full_throughput: f64, least: f64) -> bool {
        let least_load = if self.load < other.load {
            self.load
        } else {
            other.load
        };
        least_load * full_throughput >= least
    }
}

/// Graph and throughput in one pass over the pairs. A UAV meets the others in ascending order, so that its
/// throughput has the same sum as in [`measure_throughput`].
#[inline(always)]
fn link_few(model: &Model<'_>, state: &mut StateMut<'_>) {
    let (full, least) = (model.full_throughput(), model.link_throughput_min());
    let mut radios = [Radio::default(); ROOM];
    let mut count = 0;
    for i in 0..model.uav_count() {
        if !bits::get(state.grounded, i) {
            radios[count] = Radio::of(state, i);
            count += 1;
        }
    }
    let (mut rows, mut sums) = ([0u64; ROOM], [0.0; ROOM]);
    for later in 1..count {
        let radio = radios[later];
        let (mut row, mut sum) = (0, 0.0);
        let earlier = radios[..later].iter().zip(&mut rows).zip(&mut sums);
        for ((other, other_row), other_sum) in earlier {
            let throughput = full.between(radio.cell, other.cell);
            let hears = radio.hears(other, throughput, least);
            let added = if hears { throughput } else { 0.0 };
            row |= u64::from(hears) << other.uav;
            *other_row |= u64::from(hears) << radio.uav;
            sum += added;
            *other_sum += added;
        }
        rows[later] = row;
        sums[later] = sum;
    }
    state.links.fill(0);
    state.throughput.fill(0);
    for slot in 0..count {
        let Radio { uav, load, .. } = radios[slot];
        state.links[uav] = rows[slot];
        state.set_throughput(
            uav,
            mean_throughput(load, sums[slot], rows[slot].count_ones()),
        );
    }
    average_throughput(model, state);
}

/// The links of a block's UAVs with the whole fleet, met in ascending order as in [`link_few`].
#[inline(always)]
fn link_in_lanes(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    throughput: &mut [Lanes<u64>],
    block: Block,
) {
    let (full, least) = (model.full_throughput(), model.link_throughput_min());
    let cells = Cells::load(block, state.cells).rows(model.config().grid_width);
    let (flies, pilot) = (
        !block.bits(state.grounded) & block.mask(),
        block.load(state.pilot),
    );
    let flies = lanes::spread(flies);
    let mut loads = [0.0; WIDTH];
    for lane in 0..WIDTH {
        loads[lane] = 1.0 - f64::from_bits(pilot[lane]);
    }
    let (mut rows, mut sums) = ([0u64; WIDTH], [0.0; WIDTH]);
    for others in lanes::blocks(model.uav_count()) {
        for (throughput, &cell) in throughput
            .iter_mut()
            .zip(&state.cells[others.first..][..others.count])
        {
            full.gather_into(&cells, Cell::from_word(cell), throughput);
        }
        if others.first == block.first {
            // A UAV is no neighbour of itself: nothing is above NaN.
            for (lane, &index) in block.indices().iter().enumerate() {
                throughput[index as usize][lane] = f64::NAN.to_bits();
            }
        }
        let pilot = &state.pilot[others.first..][..others.count];
        let mut flying = others.uavs_in(!others.bits(state.grounded) & others.mask());
        while flying != 0 {
            let k = flying.trailing_zeros() as usize % WIDTH;
            flying &= flying - 1;
            let (load, bit) = (1.0 - f64::from_bits(pilot[k]), 1 << (others.first + k));
            let throughput = &throughput[k];
            for lane in 0..WIDTH {
                let least_load = if loads[lane] < load {
                    loads[lane]
                } else {
                    load
                };
                let hears = least_load * f64::from_bits(throughput[lane]) >= least;
                let mask = 0u64.wrapping_sub(u64::from(hears));
                rows[lane] |= mask & bit;
                sums[lane] += f64::from_bits(throughput[lane] & mask);
            }
        }
    }
    lanes::in_memory(&mut rows);
    lanes::in_memory(&mut sums);
    let (mut degrees, mut means) = ([0.0; WIDTH], [0; WIDTH]);
    for lane in 0..WIDTH {
        rows[lane] &= flies[lane];
        sums[lane] = f64::from_bits(sums[lane].to_bits() & flies[lane]);
        // A UAV without neighbours has a sum of 0, over anything.
        degrees[lane] = f64::from(rows[lane].count_ones().max(1) as i32);
    }
    for lane in 0..WIDTH {
        means[lane] = stored(loads[lane] * sums[lane] / degrees[lane]);
    }
    block.store(&rows, state.links);
    block.store(&means, state.throughput);
}

/// Sorts the UAVs into square buckets as wide as the longest possible link, so that a UAV's neighbours
/// lie in its own bucket and the eight around it.
#[inline(always)]
fn link_by_buckets(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
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
    if radio.hears(&other, throughput, model.link_throughput_min()) {
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
#[inline]
pub(crate) fn mean_throughput(load: f64, sum: f64, degree: u32) -> f64 {
    if degree == 0 {
        0.0
    } else {
        load * sum / f64::from(degree)
    }
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
