//! Detection and link tables over cell offsets, at the pilot densities that a plan may use.

use alloc::vec::Vec;

use jcas_core::action::{pilot_action, pilot_density};
use jcas_core::{Cell, Model};

/// The number of sites that the inner loops take at a time.
pub(crate) const LANES: usize = 8;
/// The maximum number of entries of cached rows.
pub(crate) const CACHED_ENTRIES_MAX: usize = 1 << 22;
/// The maximum number of levels.
pub(crate) const LEVELS_MAX: usize = 5;
/// The difference of a detection probability below which two densities are enough.
const FINE_DIFFERENCE: f64 = 0.1;

/// Tables of the chances of detection and the links between cells.
///
/// A *level* is an index into the pilot densities of the plan, which ascend. One level more,
/// [`Odds::grounded`], stands for a UAV with an empty battery: it detects nothing and has no links.
#[derive(Clone, Debug)]
pub struct Odds {
    width: u32,
    densities: Vec<f64>,
    detection: Vec<Vec<f64>>,
    linked: Vec<Vec<bool>>,
    sites: Vec<Cell>,
    rows: Vec<f64>,
}

impl Odds {
    /// Reads the model's tables for the cells that may hold a hotspot.
    #[must_use]
    pub fn new(model: &Model<'_>, sites: Vec<Cell>) -> Self {
        let config = model.config();
        let (width, height) = (config.grid_width, config.grid_height);
        let offsets = || (0..height).flat_map(move |dy| (0..width).map(move |dx| (dx, dy)));
        let densities = densities(model);
        let mut detection: Vec<Vec<f64>> = densities
            .iter()
            .map(|&density| {
                offsets()
                    .map(|(dx, dy)| model.detection_probability(dx, dy, density))
                    .collect()
            })
            .collect();
        let mut linked: Vec<Vec<bool>> = densities
            .iter()
            .map(|&density| {
                offsets()
                    .map(|(dx, dy)| {
                        model.link_throughput(dx, dy, density) >= config.link_throughput_min
                    })
                    .collect()
            })
            .collect();
        detection.push(offsets().map(|_| 0.0).collect());
        linked.push(offsets().map(|_| false).collect());
        let stride = sites.len();
        let mut odds = Self {
            width,
            densities,
            detection,
            linked,
            sites,
            rows: Vec::new(),
        };
        let cells = (width * height) as usize;
        let levels = odds.detection.len();
        if levels * cells * stride <= CACHED_ENTRIES_MAX {
            let mut rows = Vec::with_capacity(levels * cells * stride);
            let mut row = Vec::new();
            for level in 0..levels {
                for cell in 0..cells as u32 {
                    odds.fill(level as u8, odds.cell(cell), &mut row);
                    rows.extend_from_slice(&row);
                }
            }
            odds.rows = rows;
        }
        odds
    }

    /// Returns the pilot densities of the levels, in ascending order.
    #[must_use]
    pub fn densities(&self) -> &[f64] {
        &self.densities
    }

    /// Returns the level of a UAV with an empty battery.
    #[must_use]
    pub fn grounded(&self) -> u8 {
        self.densities.len() as u8
    }

    /// Returns the level of the highest density.
    #[must_use]
    pub fn highest(&self) -> u8 {
        self.densities.len() as u8 - 1
    }

    /// Returns the cells that may hold a hotspot, group by group. Each group is padded to whole
    /// lanes.
    #[must_use]
    pub fn sites(&self) -> &[Cell] {
        &self.sites
    }

    /// Returns the length of a row over the sites.
    pub(crate) fn stride(&self) -> usize {
        self.sites.len()
    }

    /// Returns the cell with a row-major index.
    #[must_use]
    pub fn cell(&self, index: u32) -> Cell {
        Cell {
            x: index % self.width,
            y: index / self.width,
        }
    }

    /// Returns the row-major index of a cell.
    #[must_use]
    pub fn index(&self, cell: Cell) -> u32 {
        cell.y * self.width + cell.x
    }

    pub(crate) fn offset(&self, a: Cell, b: Cell) -> usize {
        (a.y.abs_diff(b.y) * self.width + a.x.abs_diff(b.x)) as usize
    }

    /// Returns the chance that a UAV at a level detects a hotspot in one step.
    #[must_use]
    pub fn detection(&self, level: u8, uav: Cell, hotspot: Cell) -> f64 {
        self.detection[usize::from(level)][self.offset(uav, hotspot)]
    }

    /// Returns whether two UAVs have a radio link. The UAV with more pilots has the weaker link.
    #[must_use]
    pub fn linked(&self, (a, level_a): (Cell, u8), (b, level_b): (Cell, u8)) -> bool {
        self.linked[usize::from(level_a.max(level_b))][self.offset(a, b)]
    }

    fn fill(&self, level: u8, cell: Cell, row: &mut Vec<f64>) {
        row.clear();
        let table = &self.detection[usize::from(level)];
        row.extend(
            self.sites
                .iter()
                .map(|&site| table[self.offset(cell, site)]),
        );
    }

    /// Returns the chances of detection at every site from a cell, in a table or in the scratch
    /// row.
    pub(crate) fn row<'r>(&'r self, level: u8, cell: u32, scratch: &'r mut Vec<f64>) -> &'r [f64] {
        if self.rows.is_empty() {
            self.fill(level, self.cell(cell), scratch);
            return scratch;
        }
        let cells = self.detection[0].len();
        let first = (usize::from(level) * cells + cell as usize) * self.sites.len();
        &self.rows[first..first + self.sites.len()]
    }
}

/// Returns the pilot density of each level of a plan. The last level, for an empty battery, has the
/// least density.
pub(crate) fn plan_densities(model: &Model<'_>) -> Vec<f64> {
    let mut densities = densities(model);
    densities.push(model.config().pilot_density_min);
    densities
}

/// Returns one density if it does not matter to the radar, two if it matters little, and four if it
/// matters much. An action can ask for each of them.
fn densities(model: &Model<'_>) -> Vec<f64> {
    let config = model.config();
    let (low, high) = (config.pilot_density_min, config.pilot_density_max);
    let asked = |density: f64| pilot_density(pilot_action(density, low, high), low, high);
    let mut difference = 0.0;
    for dy in 0..config.grid_height {
        for dx in 0..config.grid_width {
            let gain = model.detection_probability(dx, dy, high)
                - model.detection_probability(dx, dy, low);
            if gain > difference {
                difference = gain;
            }
        }
    }
    let count = if difference <= 0.0 {
        1
    } else if difference < FINE_DIFFERENCE {
        2
    } else {
        4
    };
    (0..count)
        .map(|level| {
            let share = f64::from(level) / f64::from(if count > 1 { count - 1 } else { 1 });
            asked(low + (high - low) * share * share)
        })
        .collect()
}
