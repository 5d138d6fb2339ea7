//! The model: a validated configuration with every constant and table computed from it.

mod tables;

use crate::config::{Cell, Config, Depots, MAX_DEPOTS};
use crate::constants::carbon::CarbonConstants;
use crate::constants::energy::EnergyConstants;
use crate::constants::layout::Layout;
use crate::constants::observation::added_len;
use crate::constants::reward::RewardConstants;
use crate::error::{ConfigError, Error};
use crate::radio::radar::curve::AnyCurve;
use crate::radio::{false_alarms, footprint, link, radar};
use crate::words::bits::words_for;
use crate::words::geometry::Disc;

use tables::{Tables, Words};

#[cfg(any(kani, test))]
#[path = "../proofs/any_model.rs"]
pub(crate) mod any_model;

/// An immutable model, which any number of threads and states can share.
///
/// Its tables are indexed by the absolute offset between two cells, so that a step evaluates no
/// transcendental function for a pair of UAVs.
#[derive(Clone, Debug)]
pub struct Model<'m> {
    config: Config,
    hash: u64,
    depots: Depots,
    sorted_depots: [u32; MAX_DEPOTS],
    energy: EnergyConstants,
    carbon: CarbonConstants,
    reward: RewardConstants,
    layout: Layout,
    uavs: usize,
    hotspots: usize,
    width: u32,
    height: u32,
    curve: AnyCurve,
    threshold_db: f64,
    reach_cells: u32,
    bucket_side: u32,
    bucket_columns: usize,
    bucket_rows: usize,
    disc: Disc,
    footprint: Disc,
    /// Number of entries that the configuration adds to an observation.
    added: usize,
    tables: Words<'m>,
}

impl Model<'static> {
    /// Validates the configuration and builds its model in memory that it allocates.
    ///
    /// # Errors
    /// [`Error::Config`] with the first illegal field.
    #[cfg(feature = "alloc")]
    pub fn new(config: Config) -> Result<Self, Error> {
        let mut words = alloc::vec![0; Self::table_words(&config)?];
        tables::fill(&config, &mut words);
        Ok(Model::of(config, Words::Owned(words)))
    }
}

/// Row-major indices of the depots in ascending order; the remaining entries are unused.
fn sorted_indices(config: &Config) -> [u32; MAX_DEPOTS] {
    let mut sorted = [u32::MAX; MAX_DEPOTS];
    for (slot, cell) in sorted.iter_mut().zip(config.effective_depots().as_slice()) {
        *slot = cell.y * config.grid_width + cell.x;
    }
    sorted.sort_unstable();
    sorted
}

/// Longest distance along an axis at which a link is possible, in cells.
fn reach_cells(config: &Config) -> u32 {
    let (width, height) = (config.grid_width, config.grid_height);
    let mut reach_cells = 0;
    let longest = if width > height { width } else { height };
    for cells in 1..longest {
        let throughput = link::full_throughput(config, radar::range_m(config, cells, 0));
        if (1.0 - config.pilot_density_min) * throughput >= config.link_throughput_min {
            reach_cells = cells;
        }
    }
    reach_cells
}

/// Longest offset along an axis in cells, at least 1.
const fn span(extent: u32) -> f32 {
    if extent > 1 { (extent - 1) as f32 } else { 1.0 }
}

impl<'m> Model<'m> {
    /// Number of `u64` words that [`Model::new_in`] needs: 3 W H + 2 W + 2 H − 2. False alarms need
    /// another W H words, and eight for each size of a footprint.
    ///
    /// # Errors
    /// [`ConfigError`] with the first illegal field.
    pub fn table_words(config: &Config) -> Result<usize, ConfigError> {
        config.validate()?;
        let tables = Tables::of(config.grid_width, config.grid_height);
        Ok(tables.end + false_alarms::table_words(config))
    }

    /// Validates the configuration and builds its model in the caller's memory.
    ///
    /// # Errors
    /// [`Error::Config`] with the first illegal field; [`Error::Length`] unless `words` has exactly
    /// [`Model::table_words`] elements.
    pub fn new_in(config: Config, words: &'m mut [u64]) -> Result<Self, Error> {
        let expected = Self::table_words(&config)?;
        if words.len() != expected {
            return Err(Error::Length {
                what: "model memory",
                expected,
                got: words.len(),
            });
        }
        tables::fill(&config, words);
        Ok(Self::of(config, Words::Borrowed(words)))
    }

    /// Derives the constants of a model whose tables are filled.
    fn of(config: Config, tables: Words<'m>) -> Self {
        let reach_cells = reach_cells(&config);
        let bucket_side = reach_cells + 1;
        Self {
            hash: config.hash(),
            depots: config.effective_depots(),
            sorted_depots: sorted_indices(&config),
            energy: EnergyConstants::new(&config),
            carbon: CarbonConstants::new(&config),
            reward: RewardConstants::new(&config),
            layout: Layout::of(&config),
            uavs: config.uav_count as usize,
            hotspots: config.hotspot_count as usize,
            width: config.grid_width,
            height: config.grid_height,
            curve: AnyCurve::of(&config),
            threshold_db: radar::detection_threshold_db(&config),
            reach_cells,
            bucket_side,
            bucket_columns: config.grid_width.div_ceil(bucket_side) as usize,
            bucket_rows: config.grid_height.div_ceil(bucket_side) as usize,
            disc: Disc::from_radius(config.search_map_radius_m, config.cell_size_m),
            footprint: footprint::of(&config),
            added: added_len(&config),
            tables,
            config,
        }
    }

    /// The configuration of the model.
    #[must_use]
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// FNV-1a hash of the configuration, which states, snapshots and traces record.
    #[must_use]
    pub const fn config_hash(&self) -> u64 {
        self.hash
    }

    /// Number of UAVs in the fleet (N), from 1 to 4096.
    #[inline]
    #[must_use]
    pub const fn uav_count(&self) -> usize {
        self.uavs
    }

    /// Number of hotspots (n), from 1 to 4096.
    #[inline]
    #[must_use]
    pub const fn hotspot_count(&self) -> usize {
        self.hotspots
    }

    /// Number of `u64` words of a set of UAVs, one bit each.
    #[inline]
    #[must_use]
    pub const fn uav_words(&self) -> usize {
        words_for(self.uavs)
    }

    /// Number of `u64` words of a set of hotspots, one bit each.
    #[inline]
    #[must_use]
    pub const fn hotspot_words(&self) -> usize {
        words_for(self.hotspots)
    }

    /// Cells of the depots; the first is the one from which the fleet starts.
    #[must_use]
    pub fn depots(&self) -> &[Cell] {
        self.depots.as_slice()
    }

    /// Row-major indices of the depots in ascending order.
    pub(crate) fn sorted_depots(&self) -> &[u32] {
        &self.sorted_depots[..self.depots.len()]
    }

    /// Constants of the energy model, in microjoules.
    #[inline]
    #[must_use]
    pub const fn energy(&self) -> &EnergyConstants {
        &self.energy
    }

    /// Constants of the carbon model, in milligrams per kilowatt-hour.
    #[inline]
    #[must_use]
    pub const fn carbon(&self) -> &CarbonConstants {
        &self.carbon
    }

    /// Weights of the reward.
    #[inline]
    #[must_use]
    pub const fn reward(&self) -> &RewardConstants {
        &self.reward
    }

    /// Position of each quantity in a state.
    #[inline]
    #[must_use]
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Number of `u64` words of a state.
    #[must_use]
    pub const fn state_words(&self) -> usize {
        self.layout.end
    }

    /// Number of neighbours in an observation: min(N - 1, `neighbour_slots`).
    #[inline]
    #[must_use]
    pub const fn neighbour_slots(&self) -> usize {
        let slots = self.config.neighbour_slots as usize;
        if slots < self.uavs - 1 {
            slots
        } else {
            self.uavs - 1
        }
    }

    /// Number of reals in one UAV's observation: 11 + 4 n + 3 · slots, plus the entries that the
    /// configuration adds.
    #[inline]
    #[must_use]
    pub const fn observation_len(&self) -> usize {
        11 + 4 * self.hotspots + 3 * self.neighbour_slots() + self.added
    }

    /// Number of `u64` words of one UAV's search map; 0 without maps.
    #[inline]
    #[must_use]
    pub const fn map_words(&self) -> usize {
        self.layout.map
    }

    /// The disc of cells that a UAV searches around its own cell.
    #[inline]
    pub(crate) const fn disc(&self) -> Disc {
        self.disc
    }

    /// The cells of a UAV's footprint, around its own cell.
    #[inline]
    pub(crate) const fn footprint(&self) -> Disc {
        self.footprint
    }

    /// Number of reals in the global state: 6 N + 4 n + 4.
    #[inline]
    #[must_use]
    pub const fn global_len(&self) -> usize {
        6 * self.uavs + 4 * self.hotspots + 4
    }

    /// Number of reals in the actions of a step: 2 N.
    #[inline]
    #[must_use]
    pub const fn action_len(&self) -> usize {
        2 * self.uavs
    }

    /// Longest distance along an axis at which a link is possible, in cells.
    #[must_use]
    pub const fn reach_cells(&self) -> u32 {
        self.reach_cells
    }

    /// Detection threshold γ_det of the sensing SNR, in dB. Only the logistic curve uses it.
    #[must_use]
    pub const fn detection_threshold_db(&self) -> f64 {
        self.threshold_db
    }

    /// Sensing SNR in dB over an offset in cells, without the loss from communication load.
    #[must_use]
    pub fn sensing_snr_db(&self, dx: u32, dy: u32) -> f64 {
        radar::snr_db(&self.config, radar::range_m(&self.config, dx, dy))
    }

    /// Communication SNR in dB over an offset in cells.
    #[must_use]
    pub fn comm_snr_db(&self, dx: u32, dy: u32) -> f64 {
        link::snr_db(&self.config, radar::range_m(&self.config, dx, dy))
    }

    /// Probability in [0, 1] that a UAV detects a hotspot in one step (p_ij).
    ///
    /// `dx` and `dy` are the offset in cells. The result is 0 for an offset that no two cells of
    /// the grid have. `pilot_density` is a fraction of the waveform in [0, 1].
    #[must_use]
    pub fn detection_probability(&self, dx: u32, dy: u32, pilot_density: f64) -> f64 {
        let Some(offset) = self.offset(dx, dy) else {
            return 0.0;
        };
        let tabulated = f64::from_bits(self.words()[offset]);
        self.curve.probability(tabulated, pilot_density)
    }

    /// Probability in [0, 1] that a UAV raises a false alarm in one step in a cell.
    ///
    /// The cell holds no hotspot; `dx` and `dy` are its offset in cells. The result is 0 outside of
    /// the footprint.
    #[must_use]
    pub fn false_alarm_probability(&self, dx: u32, dy: u32) -> f64 {
        if self.footprint().holds(dx, dy) {
            self.config.false_alarm_per_cell
        } else {
            0.0
        }
    }

    /// Normalised throughput from one UAV to another (η_ij), without a unit.
    ///
    /// `dx` and `dy` are the offset in cells. The result is 0 for an offset that no two cells of
    /// the grid have. `pilot_density` is the sender's, a fraction of the waveform in [0, 1].
    #[must_use]
    pub fn link_throughput(&self, dx: u32, dy: u32, pilot_density: f64) -> f64 {
        let Some(offset) = self.offset(dx, dy) else {
            return 0.0;
        };
        let link = Tables::of(self.width, self.height).link;
        (1.0 - pilot_density) * f64::from_bits(self.words()[link + offset])
    }

    #[inline]
    const fn offset(&self, dx: u32, dy: u32) -> Option<usize> {
        if dx < self.width && dy < self.height {
            Some((dy * self.width + dx) as usize)
        } else {
            None
        }
    }

    #[inline]
    pub(crate) const fn curve(&self) -> &AnyCurve {
        &self.curve
    }

    #[inline]
    pub(crate) const fn link_throughput_min(&self) -> f64 {
        self.config.link_throughput_min
    }

    /// Row-major index of a cell.
    #[inline]
    pub(crate) const fn cell_index(&self, cell: Cell) -> usize {
        (cell.y * self.width + cell.x) as usize
    }

    /// The divisors of x and y offsets in an observation: the extent less 1, at least 1.
    #[inline]
    pub(crate) const fn offset_spans(&self) -> (f32, f32) {
        (span(self.width), span(self.height))
    }

    /// Whether a cell is on the grid.
    #[inline]
    pub(crate) const fn contains(&self, cell: Cell) -> bool {
        cell.x < self.width && cell.y < self.height
    }

    #[inline]
    pub(crate) const fn bucket_columns(&self) -> usize {
        self.bucket_columns
    }

    #[inline]
    pub(crate) const fn bucket_count(&self) -> usize {
        self.bucket_columns * self.bucket_rows
    }

    #[inline]
    pub(crate) const fn bucket(&self, cell: Cell) -> usize {
        (cell.y / self.bucket_side) as usize * self.bucket_columns
            + (cell.x / self.bucket_side) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The disc of three cells around a cell has 29 of them: 7 + 2 (5 + 5 + 1).
    #[test]
    fn false_alarms_come_from_the_footprint_alone() {
        let config = Config::preset(crate::Preset::Isac);
        let mut words = std::vec![0; Model::table_words(&config).unwrap()];
        let model = &Model::new_in(config, &mut words).unwrap();
        let offsets =
            (0..=3).map(|dy| (0..4).filter(move |&dx| model.false_alarm_probability(dx, dy) > 0.0));
        assert_eq!(
            offsets.map(Iterator::count).collect::<std::vec::Vec<_>>(),
            [4, 3, 3, 1]
        );
        assert_eq!(model.false_alarm_probability(0, 3), 0.01);
        assert_eq!(model.false_alarm_probability(4, 0), 0.0);
        assert_eq!(model.false_alarm_probability(u32::MAX, u32::MAX), 0.0);
    }

    #[test]
    fn an_offset_outside_of_the_grid_detects_nothing_and_links_nobody() {
        let config = Config::default();
        let mut words = std::vec![0; Model::table_words(&config).unwrap()];
        let model = Model::new_in(config, &mut words).unwrap();
        let (width, height) = (config.grid_width, config.grid_height);
        for (dx, dy) in [(width, 0), (0, height), (u32::MAX, u32::MAX)] {
            assert_eq!(model.detection_probability(dx, dy, 0.3), 0.0);
            assert_eq!(model.link_throughput(dx, dy, 0.3), 0.0);
        }
        assert!(model.detection_probability(width - 1, height - 1, 0.3) > 0.0);
        assert!(model.link_throughput(width - 1, height - 1, 0.3) > 0.0);
    }
}
