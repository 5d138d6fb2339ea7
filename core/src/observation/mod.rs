//! Observations of each UAV, and the global state for a centralised critic.

pub(crate) mod added;
pub mod fields;
mod hotspots;
mod neighbours;
mod ranking;
mod unsearched;

use core::ops::Range;

use crate::config::{Cell, TargetVisibility};
use crate::error::Error;
use crate::lanes::{self, Block, Cells, Lanes, at_width, force_vector};
use crate::model::Model;
use crate::observation::ranking::Ranking;
use crate::state::StateRef;
use crate::state::scratch::Scratch;
use crate::words::bits;

/// Number of UAVs whose rows are written at a time.
const ROWS: usize = 16;

/// Number of entries about the UAV itself.
const OWN: usize = 5;

/// Number of entries for connectivity, sustainability and progress.
const COMMON: usize = 6;

/// Writes the observation of every UAV, `[N][observation_len]`, row by row.
///
/// A row has these entries in order; [`fields::fields`] names each:
///
/// - the UAV itself: x, y, state of charge, pilot density, η̄_i;
/// - for each hotspot: Δx, Δy, confirmed, known;
/// - for each neighbour slot, nearest first: present, Δx, Δy;
/// - connectivity: the fraction of the other UAVs that are neighbours;
/// - sustainability: carbon intensity, distance to the nearest depot;
/// - progress: fractions of hotspots confirmed and informed, fraction of the horizon;
/// - what the configuration adds of the search map and the UAV: a window, unsearched fractions, a
///   tag;
/// - what it adds of the reports: a window of each level, the nearest reported cells.
///
/// Positions and offsets are divided by the extent of the grid less 1. Positions, fractions,
/// charge, pilot density, intensity and depot distance are in [0, 1], and offsets in [−1, 1].
///
/// # Errors
/// [`Error::Length`] unless `out` has N · [`Model::observation_len`] elements.
pub fn observe(
    model: &Model<'_>,
    state: &StateRef<'_>,
    scratch: &mut Scratch<'_>,
    out: &mut [f32],
) -> Result<(), Error> {
    observe_inline(model, state, scratch, out)
}

/// [`observe`], compiled into its caller.
#[inline(always)]
pub(crate) fn observe_inline(
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
    for first in (0..uavs).step_by(ROWS) {
        let end = if first + ROWS < uavs {
            first + ROWS
        } else {
            uavs
        };
        let rows = &mut out[first * len..end * len];
        if view.hidden {
            view.write_hotspots::<true>(first..end, rows);
        } else {
            view.write_hotspots::<false>(first..end, rows);
        }
        for (i, row) in (first..).zip(rows.chunks_exact_mut(len)) {
            let row = &mut row[view.slots..];
            match &mut ranking {
                Some(ranking) => ranking.write(i, model.neighbour_slots(), row),
                None => {
                    let slots = &mut row[..view.common - view.slots];
                    view.write_neighbours(i, scratch.list(uavs), slots);
                }
            }
        }
        // These entries come after the neighbours, whose last slot is stored with one extra real.
        at_width!(model, write_own(&view, first..end, rows));
        if view.common + COMMON < len {
            for (i, row) in (first..).zip(rows.chunks_exact_mut(len)) {
                view.write_added(i, &mut row[view.common + COMMON..]);
            }
        }
    }
    Ok(())
}

/// Writes the entries about the UAV itself, and those for connectivity, sustainability and
/// progress.
#[inline(always)]
fn write_own<const W: usize>(view: &View<'_>, uavs: Range<usize>, rows: &mut [f32]) {
    let len = view.model.observation_len();
    let mut rows = rows.chunks_exact_mut(len);
    for block in lanes::blocks_of::<W>(uavs) {
        let cells = block.load(view.state.cells);
        let own = view.own(block, &cells);
        let (connection, to_depot) = view.common(block, &cells);
        for (lane, row) in block.lanes().zip(&mut rows) {
            row[..OWN].copy_from_slice(&own.each_ref().map(|lanes| lanes[lane]));
            row[view.common..view.common + COMMON].copy_from_slice(&[
                connection[lane],
                view.carbon,
                to_depot[lane],
                view.progress[0],
                view.progress[1],
                view.progress[2],
            ]);
        }
    }
}

/// Writes the global state, 6 N + 4 n + 4 reals, normalised as in [`observe`].
///
/// - For each UAV: x, y, state of charge, pilot density, η̄_i, fraction of hotspots known.
/// - For each hotspot: x, y, confirmed, fraction of UAVs that know it.
/// - Carbon intensity, then progress: fractions confirmed, informed and of the horizon.
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
        let block = Block::<1> { first: i, count: 1 };
        let own = view.own(block, &block.load(state.cells));
        row[..OWN].copy_from_slice(own.as_flattened());
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

/// Quantities that all observations of a state share, computed once.
struct View<'v> {
    model: &'v Model<'v>,
    state: &'v StateRef<'v>,
    offset_x: &'v [u64],
    offset_y: &'v [u64],
    /// Position in a row at which the neighbour slots begin. `common` is the position of
    /// connectivity, sustainability and progress.
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

/// The tag of a UAV for `uav_tag = "index"`: i/(N-1), in [0, 1].
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

    /// x/(W-1), y/(H-1), state of charge, pilot density and η̄_i of each UAV of a block.
    #[inline(always)]
    fn own<const W: usize>(&self, block: Block<W>, cells: &Lanes<u64, W>) -> [Lanes<f32, W>; OWN] {
        let battery = block.load(self.state.battery);
        let (pilot, throughput) = (
            block.load(self.state.pilot),
            block.load(self.state.throughput),
        );
        let mut own = [[0.0; W]; OWN];
        for lane in 0..W {
            let above = f64::from_bits(pilot[lane]) - self.pilot_min;
            own[0][lane] = cells[lane] as u32 as i32 as f32 / self.spans.0;
            own[1][lane] = (cells[lane] >> 32) as i32 as f32 / self.spans.1;
            own[2][lane] = (battery[lane] as f64 * self.per_capacity) as f32;
            own[3][lane] = (above * self.per_pilot_span) as f32;
            own[4][lane] = f64::from_bits(throughput[lane]) as f32;
        }
        own.iter_mut().for_each(force_vector);
        own
    }

    /// Neighbours/(N-1) and depot distance/(W+H-2) of each UAV of a block.
    #[inline(always)]
    fn common<const W: usize>(
        &self,
        block: Block<W>,
        cells: &Lanes<u64, W>,
    ) -> (Lanes<f32, W>, Lanes<f32, W>) {
        let (mut degrees, row) = ([0; W], self.model.uav_words());
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
        let distances = self.model.depot_distances(&Cells::of(cells));
        let (mut connection, mut to_depot) = ([0.0; W], [0.0; W]);
        for lane in 0..W {
            connection[lane] = (f64::from(degrees[lane]) * self.per_other) as f32;
            to_depot[lane] = (f64::from(distances[lane] as i32) * self.per_span) as f32;
        }
        force_vector(&mut connection);
        force_vector(&mut to_depot);
        (connection, to_depot)
    }

    /// The tables of offsets from a cell, which hold 0 at extent - 1.
    #[inline(always)]
    fn offsets_from(&self, cell: Cell) -> OffsetsFrom<'_> {
        let config = self.model.config();
        OffsetsFrom {
            x: &self.offset_x[(config.grid_width - 1 - cell.x) as usize..],
            y: &self.offset_y[(config.grid_height - 1 - cell.y) as usize..],
        }
    }
}

/// Normalised offsets from a cell.
struct OffsetsFrom<'v> {
    x: &'v [u64],
    y: &'v [u64],
}

impl OffsetsFrom<'_> {
    /// (Δx/(W-1), Δy/(H-1)).
    #[inline(always)]
    fn to(&self, cell: Cell) -> (f32, f32) {
        (
            f32::from_bits(self.x[cell.x as usize] as u32),
            f32::from_bits(self.y[cell.y as usize] as u32),
        )
    }
}
