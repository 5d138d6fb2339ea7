//! Where each quantity of a state lies in its slab of words.

use super::reward::{KEPT, OWN_KEPT};
use crate::config::{Config, QuorumWindow, SearchMaps};
use crate::radio::false_alarms::ALARMS_MAX;
use crate::words::bits::words_for;

/// Number of words of a state's header.
pub(crate) const HEADER_WORDS: usize = 15 + KEPT;

/// Layout of a state: its sizes, from which the position of each quantity follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    pub(crate) uavs: usize,
    pub(crate) hotspots: usize,
    pub(crate) visited: usize,
    /// Number of words of a UAV's search map; 0 without maps.
    pub(crate) map: usize,
    /// Number of words of a UAV's false alarms, and of a set of cells for the false confirmations;
    /// both 0 without false alarms.
    pub(crate) alarms: usize,
    pub(crate) false_cells: usize,
    /// Number of words of a UAV's reports; 0 without reports.
    pub(crate) reports: usize,
    /// Number of words of the hotspots that a UAV remembers to have detected, and of the cells of
    /// its false alarms that it remembers. Both are 0 unless the quorum counts the whole episode.
    pub(crate) remembered: usize,
    pub(crate) remembered_false: usize,
    /// Number of words of cells that a UAV shares: its search map and its reports.
    pub(crate) shared: usize,
    /// Number of words of a state.
    pub end: usize,
}

impl Layout {
    /// The layout of a configuration's states.
    #[must_use]
    pub const fn of(config: &Config) -> Self {
        let uavs = config.uav_count as usize;
        let hotspots = config.hotspot_count as usize;
        let cells = config.grid_width as usize * config.grid_height as usize;
        let visited = words_for(cells);
        let map = match config.search_maps {
            SearchMaps::Off => 0,
            SearchMaps::Shared => words_for(cells),
        };
        let (alarms, false_cells) = if config.false_alarm_per_cell > 0.0 {
            (ALARMS_MAX, words_for(cells))
        } else {
            (0, 0)
        };
        let alarm_words = uavs * alarms + false_cells + alarms / ALARMS_MAX;
        let reports = config.report_levels as usize * false_cells;
        let (remembered, remembered_false) = match config.quorum_window {
            QuorumWindow::Step => (0, 0),
            QuorumWindow::Episode => (words_for(hotspots), false_cells),
        };
        let per_uav = (12 + OWN_KEPT) * uavs + 3 * words_for(uavs);
        let per_hotspot = 3 * hotspots + 2 * words_for(hotspots);
        let pairs = 2 * uavs * words_for(hotspots) + uavs * words_for(uavs);
        let memory = uavs * (remembered + remembered_false);
        let cell_sets = uavs * map + alarm_words + 2 * uavs * reports;
        Self {
            uavs,
            hotspots,
            visited,
            map,
            alarms,
            false_cells,
            reports,
            remembered,
            remembered_false,
            shared: map + reports,
            end: HEADER_WORDS + per_uav + per_hotspot + pairs + visited + cell_sets + memory,
        }
    }
}
