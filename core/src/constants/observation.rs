//! The number of entries that a configuration adds to an observation.

use crate::config::{Config, MapDirections, SearchMaps, UavTag};

/// Number of directions for which an observation has the unsearched fraction.
pub const DIRECTIONS: usize = 8;

/// Number of entries for a reported cell.
pub(crate) const REPORT: usize = 3;

/// Number of all entries that the configuration adds.
pub(crate) const fn added_len(config: &Config) -> usize {
    let mut sum = 0;
    let lens = lens(config);
    let mut index = 0;
    while index < lens.len() {
        sum += lens[index];
        index += 1;
    }
    sum
}

/// Number of entries of each part, in order: window of the search map, unsearched fractions, tag,
/// windows of the reports, reported cells.
pub(crate) const fn lens(config: &Config) -> [usize; 5] {
    let window = window_cells(config);
    [
        match config.search_maps {
            SearchMaps::Off => 0,
            SearchMaps::Shared => window,
        },
        match config.map_directions {
            MapDirections::Off => 0,
            MapDirections::Shown => DIRECTIONS,
        },
        match config.uav_tag {
            UavTag::Off => 0,
            UavTag::Index => 1,
        },
        config.report_levels as usize * window,
        config.report_slots as usize * REPORT,
    ]
}

/// Number of cells of a window: (2 r + 1)², or 0.
pub(crate) const fn window_cells(config: &Config) -> usize {
    match config.map_window_radius as usize {
        0 => 0,
        radius => (2 * radius + 1) * (2 * radius + 1),
    }
}
