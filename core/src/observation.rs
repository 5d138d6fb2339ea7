//! What each UAV sees, and the global state that a centralised critic sees.

pub mod fields;

use crate::bits;
use crate::config::{Cell, TargetVisibility};
use crate::error::Error;
use crate::lanes::neighbours::Ranking;
use crate::lanes::real::Divisors;
use crate::lanes::{self, Block, Cells, Lanes, WIDTH, in_memory, repeat};
use crate::model::Model;
use crate::scratch::Scratch;
use crate::search::unsearched_shares;
use crate::state::StateRef;

/// Hotspots that are written at a time, and what a UAV sees of each.
const TARGETS: usize = 8;
const TARGET: usize = 4;

/// The bits of 1.
const ONE: u32 = 1.0f32.to_bits();

/// Hotspots whose entries fill a block of lanes.
const QUARTET: usize = WIDTH / TARGET;
/// The set of four hotspots.
const ALL: usize = (1 << QUARTET) - 1;

/// By a set of four hotspots the bits of 1 for those entries of theirs that say what the UAV knows, and all ones for
/// those that say where they are.
static KNOWN: [Lanes<u32>; ALL + 1] = entries([0, 0, 0, ONE]);
static POSITIONS: [Lanes<u32>; ALL + 1] = entries([u32::MAX, u32::MAX, 0, 0]);

const fn entries(bits: [u32; TARGET]) -> [Lanes<u32>; ALL + 1] {
    let (mut sets, mut set) = ([[0; WIDTH]; ALL + 1], 0);
    while set <= ALL {
        let mut lane = 0;
        while lane < WIDTH {
            if set >> (lane / TARGET) & 1 == 1 {
                sets[set][lane] = bits[lane % TARGET];
            }
            lane += 1;
        }
        set += 1;
    }
    sets
}

/// Entries of what a UAV sees of itself.
const OWN: usize = 5;

/// Entries of connectivity, sustainability and progress.
const COMMON: usize = 6;

/// Writes the observation of every UAV, one after the other.
///
/// In order: self (x, y, SoC, pilot density, η̄_i), each hotspot (Δx, Δy, confirmed, known), each
/// neighbour slot (present, Δx, Δy), connectivity, sustainability (carbon intensity, depot distance),
/// progress (confirmed, informed, time), then what the configuration adds: a window of the search map, the
/// unsearched share of each direction, a tag. [`fields::fields`] names every entry.
///
/// # Errors
/// [`Error::Length`] unless `out` has N · [`Model::observation_len`] elements.
pub fn observe(
    model: &Model<'_>,
    state: &StateRef<'_>,
    scratch: &mut Scratch<'_>,
    out: &mut [f32],
) -> Result<(), Error> {
    observe_here(model, state, scratch, out)
}

/// [`observe`], compiled into its caller.
#[inline(always)]
pub(crate) fn observe_here(
    model: &Model<'_>,
    state: &StateRef<'_>,
    scratch: &mut Scratch<'_>,
    out: &mut [f32],
) -> Result<(), Error> {
    let (uavs, len) = (model.uav_count(), model.observation_len());
    if out.len() != uavs * len {
        return Err(Error::Length {
            what: "observations",
            expected: uavs * len,
            got: out.len(),
        });
    }
    let view = View::new(model, state);
    let mut ranking = Ranking::room(model);
    if let Some(ranking) = &mut ranking {
        ranking.rank(state);
    }
    for block in lanes::blocks(uavs) {
        let rows = &mut out[block.first * len..][..block.count * len];
        if view.hidden {
            view.write_targets::<true>(block, rows);
        } else {
            view.write_targets::<false>(block, rows);
        }
        for (i, row) in (block.first..).zip(rows.chunks_exact_mut(len)) {
            let row = &mut row[view.slots..];
            match &mut ranking {
                Some(ranking) => ranking.write(i, model.neighbour_slots(), row),
                None => {
                    let slots = &mut row[..view.common - view.slots];
                    view.write_neighbours(i, scratch.list(uavs), slots);
                }
            }
        }
        view.write_own(block, rows);
        if view.common + COMMON < len {
            for (i, row) in (block.first..).zip(rows.chunks_exact_mut(len)) {
                view.write_added(i, &mut row[view.common + COMMON..]);
            }
        }
    }
    Ok(())
}

/// Writes the global state: per UAV (x, y, SoC, pilot density, η̄_i, fraction of hotspots known), per
/// hotspot (x, y, confirmed, fraction of UAVs that know it), then carbon intensity and progress
/// (confirmed, informed, time).
///
/// # Errors
/// [`Error::Length`] unless `out` has [`Model::global_len`] elements.
pub fn observe_global(
    model: &Model<'_>,
    state: &StateRef<'_>,
    out: &mut [f32],
) -> Result<(), Error> {
    if out.len() != model.global_len() {
        return Err(Error::Length {
            what: "global state",
            expected: model.global_len(),
            got: out.len(),
        });
    }
    let view = View::new(model, state);
    let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
    let (per_uav, rest) = out.split_at_mut(6 * uavs);
    let (per_hotspot, common) = rest.split_at_mut(4 * hotspots);
    for (i, row) in per_uav.chunks_exact_mut(6).enumerate() {
        row[..OWN].copy_from_slice(&view.own(i));
        row[OWN] = bits::count(state.knowledge_of(i)) as f32 / hotspots as f32;
    }
    for (j, row) in per_hotspot.chunks_exact_mut(4).enumerate() {
        let (x, y) = view.position(state.hotspot_cell(j));
        let mut knowing = 0u32;
        for i in 0..uavs {
            knowing += u32::from(state.knows(i, j));
        }
        row.copy_from_slice(&[x, y, flag(state.confirmed(j)), knowing as f32 / uavs as f32]);
    }
    common[0] = view.carbon;
    common[1..].copy_from_slice(&view.progress);
    Ok(())
}

/// What all UAVs of a state see alike, worked out once.
struct View<'v> {
    model: &'v Model<'v>,
    state: &'v StateRef<'v>,
    offset_x: &'v [u64],
    offset_y: &'v [u64],
    /// Where the neighbour slots begin in a row, and where connectivity, sustainability and progress do.
    slots: usize,
    common: usize,
    per_capacity: f64,
    pilot_min: f64,
    per_pilot_span: f64,
    per_span: f64,
    per_other: f64,
    /// (W - 1, H - 1), at least 1.
    spans: (f32, f32),
    hidden: bool,
    carbon: f32,
    progress: [f32; 3],
}

/// The tag of a UAV by its index, i/(N-1): what `uav_tag = "index"` shows.
#[must_use]
pub fn index_tag(index: usize, uav_count: usize) -> f32 {
    (index as f64 * inverse((uav_count - 1) as f64)) as f32
}

fn inverse(value: f64) -> f64 {
    if value > 0.0 { 1.0 / value } else { 0.0 }
}

const fn flag(value: bool) -> f32 {
    if value { 1.0 } else { 0.0 }
}

impl<'v> View<'v> {
    fn new(model: &'v Model<'_>, state: &'v StateRef<'_>) -> Self {
        let config = model.config();
        let (offset_x, offset_y) = model.offset_tables();
        let hotspots = f64::from(config.hotspot_count);
        let slots = OWN + 4 * model.hotspot_count();
        Self {
            model,
            state,
            offset_x,
            offset_y,
            slots,
            common: slots + 3 * model.neighbour_slots(),
            per_capacity: 1.0 / model.energy().capacity_uj as f64,
            pilot_min: config.pilot_density_min,
            per_pilot_span: inverse(config.pilot_density_max - config.pilot_density_min),
            per_span: inverse(f64::from(config.grid_width + config.grid_height - 2)),
            per_other: inverse(f64::from(config.uav_count - 1)),
            spans: model.offset_spans(),
            hidden: config.target_visibility == TargetVisibility::Hidden,
            carbon: model
                .carbon()
                .normalised(state.carbon_intensity_mg_per_kwh()) as f32,
            progress: [
                (state.confirmed_count() as f64 / hotspots) as f32,
                (state.informed_count() as f64 / hotspots) as f32,
                (f64::from(state.t()) / f64::from(config.horizon_steps)) as f32,
            ],
        }
    }

    /// (x/(W-1), y/(H-1)).
    #[inline]
    fn position(&self, cell: Cell) -> (f32, f32) {
        (
            cell.x as i32 as f32 / self.spans.0,
            cell.y as i32 as f32 / self.spans.1,
        )
    }

    /// Offsets from a cell: the tables hold 0 at extent - 1.
    #[inline(always)]
    fn from(&self, cell: Cell) -> From<'_> {
        let config = self.model.config();
        From {
            x: &self.offset_x[(config.grid_width - 1 - cell.x) as usize..],
            y: &self.offset_y[(config.grid_height - 1 - cell.y) as usize..],
        }
    }

    /// What each UAV sees of itself, and what stands behind its neighbours: connectivity, sustainability, progress.
    #[inline(always)]
    fn write_own(&self, block: Block, rows: &mut [f32]) {
        let len = self.model.observation_len();
        if block.count < lanes::FLEET {
            for (i, row) in (block.first..).zip(rows.chunks_exact_mut(len)) {
                let degree = bits::count(self.state.links_of(i)) as i32;
                let distance = self.model.depot_distance(self.state.cell(i)) as i32;
                self.put_own(&self.own(i), row);
                self.put_common(self.connection(degree), self.to_depot(distance), row);
            }
        } else {
            let own = self.own_in_lanes(block);
            let (connection, to_depot) = self.common_in_lanes(block);
            for (lane, row) in block.lanes().zip(rows.chunks_exact_mut(len)) {
                self.put_own(&own.each_ref().map(|lanes| lanes[lane]), row);
                self.put_common(connection[lane], to_depot[lane], row);
            }
        }
    }

    #[inline(always)]
    fn put_own(&self, own: &[f32; OWN], row: &mut [f32]) {
        row[..OWN].copy_from_slice(own);
    }

    /// x/(W-1), y/(H-1), state of charge, pilot density and η̄_i of UAV i.
    #[inline(always)]
    fn own(&self, i: usize) -> [f32; OWN] {
        self.own_of(
            self.state.cells[i],
            self.state.battery[i],
            self.state.pilot[i],
            self.state.throughput[i],
        )
    }

    #[inline(always)]
    fn own_of(&self, cell: u64, battery: u64, pilot: u64, throughput: u64) -> [f32; OWN] {
        let above = f64::from_bits(pilot) - self.pilot_min;
        [
            cell as u32 as i32 as f32 / self.spans.0,
            (cell >> 32) as i32 as f32 / self.spans.1,
            (battery as f64 * self.per_capacity) as f32,
            (above * self.per_pilot_span) as f32,
            f64::from_bits(throughput) as f32,
        ]
    }

    /// [`Self::own`] of each UAV of a block.
    #[inline(always)]
    fn own_in_lanes(&self, block: Block) -> [Lanes<f32>; OWN] {
        let (cells, battery) = (block.load(self.state.cells), block.load(self.state.battery));
        let (pilot, throughput) = (
            block.load(self.state.pilot),
            block.load(self.state.throughput),
        );
        let mut own = [[0.0; WIDTH]; OWN];
        for lane in 0..WIDTH {
            let one = self.own_of(cells[lane], battery[lane], pilot[lane], throughput[lane]);
            for (lanes, value) in own.iter_mut().zip(one) {
                lanes[lane] = value;
            }
        }
        own.iter_mut().for_each(in_memory);
        own
    }

    /// Neighbours/(N-1).
    #[inline(always)]
    fn connection(&self, neighbours: i32) -> f32 {
        (f64::from(neighbours) * self.per_other) as f32
    }

    /// Depot distance/(W+H-2).
    #[inline(always)]
    fn to_depot(&self, distance: i32) -> f32 {
        (f64::from(distance) * self.per_span) as f32
    }

    /// [`Self::connection`] and [`Self::to_depot`] of each UAV of a block.
    #[inline(always)]
    fn common_in_lanes(&self, block: Block) -> (Lanes<f32>, Lanes<f32>) {
        let (mut degrees, row) = ([0; WIDTH], self.model.uav_words());
        if row == 1 {
            degrees = block
                .load(self.state.links)
                .map(|links| links.count_ones() as i32);
        } else {
            let links = self.state.links[block.first * row..].chunks_exact(row);
            for (lane, links) in block.lanes().zip(links) {
                degrees[lane] = bits::count(links) as i32;
            }
        }
        let distances = self
            .model
            .depot_distances(&Cells::load(block, self.state.cells));
        let (mut connection, mut to_depot) = ([0.0; WIDTH], [0.0; WIDTH]);
        for lane in 0..WIDTH {
            connection[lane] = self.connection(degrees[lane]);
            to_depot[lane] = self.to_depot(distances[lane] as i32);
        }
        in_memory(&mut connection);
        in_memory(&mut to_depot);
        (connection, to_depot)
    }

    /// Connectivity, sustainability and progress.
    #[inline(always)]
    fn put_common(&self, connection: f32, to_depot: f32, row: &mut [f32]) {
        row[self.common..self.common + COMMON].copy_from_slice(&[
            connection,
            self.carbon,
            to_depot,
            self.progress[0],
            self.progress[1],
            self.progress[2],
        ]);
    }

    /// What the configuration adds: a window of the map, the unsearched shares, a tag.
    fn write_added(&self, i: usize, out: &mut [f32]) {
        let cell = self.state.cell(i);
        let (window, rest) = out.split_at_mut(self.model.window_len());
        let (directions, tag) = rest.split_at_mut(self.model.directions_len());
        if !window.is_empty() {
            self.write_window(i, cell, window);
        }
        if !directions.is_empty() {
            let config = self.model.config();
            let map = self.state.searched_of(i);
            unsearched_shares(map, cell, config.grid_width, config.grid_height, directions);
        }
        if let Some(tag) = tag.first_mut() {
            *tag = self.tag(i);
        }
    }

    /// The map around the cell, row by row from below: 1 unsearched, 0 searched, -1 off the grid.
    fn write_window(&self, i: usize, cell: Cell, out: &mut [f32]) {
        let config = self.model.config();
        let (radius, map) = (config.map_window_radius, self.state.searched_of(i));
        let side = 2 * radius + 1;
        for (row, dy) in out.chunks_exact_mut(side as usize).zip(0..side) {
            for (value, dx) in row.iter_mut().zip(0..side) {
                // Off the grid on the low side, the difference wraps to above any size.
                let x = (cell.x + dx).wrapping_sub(radius);
                let y = (cell.y + dy).wrapping_sub(radius);
                let there = Cell { x, y };
                *value = if self.model.contains(there) {
                    flag(!bits::get(map, self.model.cell_index(there)))
                } else {
                    -1.0
                };
            }
        }
    }

    /// What tells UAV i apart.
    fn tag(&self, i: usize) -> f32 {
        index_tag(i, self.model.uav_count())
    }

    /// What every UAV sees of each hotspot, (Δx/(W-1), Δy/(H-1), confirmed, known), eight hotspots at a time. Where there
    /// is room in its row, eight are written where fewer are left: what follows them is written later.
    #[inline(always)]
    fn write_targets<const HIDDEN: bool>(&self, uavs: Block, out: &mut [f32]) {
        let (len, row_words) = (self.model.observation_len(), self.model.hotspot_words());
        // (x, y, 0, 0) of each UAV, all before the first is read: a load waits for stores that it spans.
        let mut observers = [[0.0; WIDTH]; TARGET];
        let cells = self.state.cells[uavs.first..][..uavs.count].iter();
        for (own, &cell) in observers
            .as_flattened_mut()
            .chunks_exact_mut(TARGET)
            .zip(cells)
        {
            own[0] = cell as u32 as i32 as f32;
            own[1] = (cell >> 32) as i32 as f32;
        }
        in_memory(&mut observers);
        let knowledge = &self.state.knowledge[uavs.first * row_words..][..uavs.count * row_words];
        let divisors = Divisors::of([self.spans.0, self.spans.1, 1.0, 1.0]);
        for (block, words) in self.state.hotspots.chunks(TARGETS).enumerate() {
            let (word, shift) = (block * TARGETS / 64, block * TARGETS % 64);
            let targets = targets(words, self.state.confirmed[word] >> shift);
            let begin = OWN + TARGET * TARGETS * block;
            let observers = observers.as_flattened().chunks_exact(TARGET);
            let uavs = observers.zip(knowledge.chunks_exact(row_words));
            for (row, (own, known)) in out.chunks_exact_mut(len).zip(uavs) {
                let own = repeat([own[0], own[1], own[2], own[3]]);
                let known = (known[word] >> shift) as usize;
                let row = &mut row[begin..];
                if let Some(room) = row.first_chunk_mut() {
                    see::<HIDDEN>(&own, &targets, &divisors, known, room);
                } else {
                    let mut seen = [0.0; TARGET * TARGETS];
                    see::<HIDDEN>(&own, &targets, &divisors, known, &mut seen);
                    for (value, &seen) in row[..TARGET * words.len()].iter_mut().zip(&seen) {
                        *value = seen;
                    }
                }
            }
        }
    }

    /// Fills the slots with the nearest neighbours, ties to the lower index.
    #[inline(always)]
    fn write_neighbours(&self, i: usize, keys: &mut [u64], out: &mut [f32]) {
        let cell = self.state.cell(i);
        let mut degree = 0;
        for (word, &set) in self.state.links_of(i).iter().enumerate() {
            let mut rest = set;
            while rest != 0 {
                let k = word * 64 + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let other = self.state.cell(k);
                let (dx, dy) = (cell.x.abs_diff(other.x), cell.y.abs_diff(other.y));
                keys[degree] = u64::from(dx * dx + dy * dy) << INDEX_BITS | k as u64;
                degree += 1;
            }
        }
        let (from, slots) = (self.from(cell), out.len() / 3);
        let (filled, empty) = out.split_at_mut(3 * degree.min(slots));
        empty.fill(0.0);
        let keys = &mut keys[..degree];
        nearest_first(keys, slots);
        for (row, &key) in filled.chunks_exact_mut(3).zip(&*keys) {
            let other = self.state.cell((key & ((1 << INDEX_BITS) - 1)) as usize);
            let (dx, dy) = from.to(other);
            row[0] = 1.0;
            row[1] = dx;
            row[2] = dy;
        }
    }
}

/// Eight hotspots, in blocks of lanes.
const PARTS: usize = TARGETS * TARGET / WIDTH;

/// What a UAV at (x, y, 0, 0), over and over, sees of eight hotspots, of which it knows some.
#[inline(always)]
fn see<const HIDDEN: bool>(
    own: &Lanes<f32>,
    targets: &[f32; TARGET * TARGETS],
    divisors: &Divisors,
    known: usize,
    seen: &mut [f32; TARGET * TARGETS],
) {
    for part in 0..PARTS {
        let known = (known >> (part * QUARTET)) % (ALL + 1);
        for lane in 0..WIDTH {
            let index = part * WIDTH + lane;
            let mut offset = divisors.offset(own[lane], targets[index], lane).to_bits();
            if HIDDEN {
                offset &= !POSITIONS[ALL - known][lane];
            }
            seen[index] = f32::from_bits(offset | KNOWN[known][lane]);
        }
    }
}

/// (x, y, confirmed, 0) of up to eight hotspots.
#[inline(always)]
fn targets(words: &[u64], confirmed: u64) -> [f32; TARGETS * TARGET] {
    let mut targets = [0.0; TARGETS * TARGET];
    for (j, (&word, target)) in words
        .iter()
        .zip(targets.chunks_exact_mut(TARGET))
        .enumerate()
    {
        let cell = Cell::from_word(word);
        target[0] = cell.x as i32 as f32;
        target[1] = cell.y as i32 as f32;
        target[2] = flag(confirmed >> j & 1 == 1);
    }
    in_memory(&mut targets);
    targets
}

/// Up to this many keys, insertion beats a general sort: neighbours in one cell are in order already.
const FEW: usize = 24;

/// Moves the smallest `count` keys to the front, ascending.
#[inline(always)]
fn nearest_first(keys: &mut [u64], count: usize) {
    if keys.len() <= FEW {
        for end in 1..keys.len() {
            let key = keys[end];
            let mut slot = end;
            while slot > 0 && keys[slot - 1] > key {
                keys[slot] = keys[slot - 1];
                slot -= 1;
            }
            keys[slot] = key;
        }
        return;
    }
    if count < keys.len() {
        keys.select_nth_unstable(count);
    }
    let nearest = count.min(keys.len());
    keys[..nearest].sort_unstable();
}

/// Normalised offsets from a cell.
struct From<'v> {
    x: &'v [u64],
    y: &'v [u64],
}

impl From<'_> {
    /// (Δx/(W-1), Δy/(H-1)).
    #[inline(always)]
    fn to(&self, cell: Cell) -> (f32, f32) {
        (
            f32::from_bits(self.x[cell.x as usize] as u32),
            f32::from_bits(self.y[cell.y as usize] as u32),
        )
    }
}

/// Bits of a UAV's index in a sorting key; squared distances take the bits above.
const INDEX_BITS: u32 = 12;
