//! Where each quantity of a state lies in its slab of words.

use crate::bits::words_for;
use crate::config::{Config, SearchMaps};
use crate::header;
use crate::reward::OWN_KEPT;

/// Layout of a state: its sizes, from which the position of each quantity follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    pub(crate) uavs: usize,
    pub(crate) hotspots: usize,
    pub(crate) visited: usize,
    /// Number of words of a UAV's search map; 0 without maps.
    pub(crate) map: usize,
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
        let per_uav = (12 + OWN_KEPT) * uavs + 3 * words_for(uavs);
        let per_hotspot = 3 * hotspots + 2 * words_for(hotspots);
        let pairs = 2 * uavs * words_for(hotspots) + uavs * words_for(uavs);
        Self {
            uavs,
            hotspots,
            visited,
            map,
            end: header::WORDS + per_uav + per_hotspot + pairs + visited + uavs * map,
        }
    }
}
