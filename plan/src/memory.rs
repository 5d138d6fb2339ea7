//! A bound on the memory of planning, which follows from the sizes of a model.
//!
//! An allocation that fails ends the program. So a planner first asks for the whole bound at once,
//! gives it back, and refuses where there is no such memory.

use alloc::vec::Vec;

use jcas_core::{Model, TargetVisibility};

use crate::error::PlanError;
use crate::formation;
use crate::odds::{CACHED_ENTRIES_MAX, LANES, LEVELS_MAX};
use crate::problem::{STEPS_MAX, check_model, check_sizes};
use crate::teams;

/// A list that grows by doubling holds its old and its new memory while it moves.
const GROWTH: u128 = 3;
/// Bytes of a word, and of a cell.
const WORD: u128 = 8;
/// Bytes of a site: its cell and its weight.
const SITE: u128 = 2 * WORD;
/// Bytes of a step of a trajectory: its cell's index and its level.
const STEP: u128 = 5;
/// Bytes of a change of the routes of teams.
const CHANGE: u128 = 5 * WORD;
/// Bytes of a observation: its cell and its level.
const OBSERVATION: u128 = 12;
/// Bytes of a step of a trajectory on file: cell, pilot density, and the text of both.
const STEP_ON_FILE: u128 = 2 * WORD + GROWTH * 64;
/// Bytes of a configuration as text, with the figures of a plan.
const TEXT: u128 = 1 << 16;

/// The sizes that the memory of planning depends on.
struct Demand {
    uavs: u128,
    cells: u128,
    hotspots: u128,
    groups: u128,
    sites: u128,
    /// Steps of a trajectory, with its beginning.
    steps: u128,
    /// Steps of an episode.
    horizon: u128,
    /// The distances on the grid, 0 included.
    distances: u128,
    quorum: u128,
    /// Initial trajectories at one level.
    formations: u128,
}

impl Demand {
    /// The sizes of a search, or of a tour of known hotspots.
    fn of(model: &Model<'_>, known: Option<usize>) -> Self {
        let config = model.config();
        let cells = config.cell_count();
        let free = cells - model.depots().len();
        let hidden = free.next_multiple_of(LANES);
        Self {
            uavs: model.uav_count() as u128,
            cells: cells as u128,
            hotspots: model.hotspot_count() as u128,
            groups: known.unwrap_or(1) as u128,
            sites: known.map_or(hidden, |count| LANES * count) as u128,
            steps: STEPS_MAX.min(config.horizon_steps as usize) as u128 + 1,
            horizon: u128::from(config.horizon_steps),
            distances: u128::from(config.grid_width + config.grid_height) + 1,
            quorum: u128::from(config.quorum),
            formations: known.map_or(formation::SWEEPS_MAX, |_| teams::TOURS_MAX) as u128,
        }
    }

    /// Priors and tables: `targets.rs`, `problem.rs`, `odds.rs`.
    fn tables(&self) -> u128 {
        let levels = LEVELS_MAX as u128;
        let rows = (levels * self.cells * self.sites).min(CACHED_ENTRIES_MAX as u128);
        GROWTH * self.sites * SITE
            + (self.groups + 4) * (self.cells * WORD + GROWTH * 128)
            + self.hotspots * SITE
            + levels * GROWTH * self.cells * (WORD + 1)
            + rows * WORD
    }

    /// All initial trajectories at once, at two levels, and the ones that gather: `plan.rs`,
    /// `formation.rs`, `teams.rs`, `replan.rs`.
    fn starts(&self) -> u128 {
        let count = 2 * self.formations + 5;
        let changes = GROWTH * self.groups * (self.groups + teams::TEAMS_MAX as u128) * CHANGE;
        let hazards = teams::TEAMS_MAX as u128 * self.uavs.min(self.groups) * self.cells * WORD;
        count * self.uavs * (2 * STEP * self.steps + 128) + self.steps * 512 + changes + hazards
    }

    /// The tables of `anneal/`, and the trajectories that it keeps.
    fn annealing(&self) -> u128 {
        4 * self.steps * self.sites * WORD
            + self.steps * (self.uavs + 16 * WORD)
            + 4 * self.uavs * (STEP * self.steps + 16 * WORD)
            + (4 * self.sites + self.quorum * LANES as u128) * WORD
    }

    /// The tables of `bound.rs`. UAVs that share a start share a table.
    fn bounding(&self, starts: u128) -> u128 {
        let priors = (self.groups + 1) * (self.sites + GROWTH * self.cells + self.distances + 16);
        let nearest = starts * (self.distances * self.sites + 16);
        (priors + nearest + 4 * self.sites + self.quorum + self.uavs) * WORD
    }

    /// Rounds, those that are tried, and the trajectories of the best: `rounds/`.
    fn rounds(&self) -> u128 {
        let teams = 4 * self.uavs * (256 + GROWTH * WORD * (self.hotspots + 1));
        teams
            + (300 * self.hotspots + self.quorum + self.uavs) * WORD
            + 4 * self.uavs * STEP * self.steps
    }

    /// The tables of `belief.rs`, and the observations that it reads. Those are the observations of
    /// each UAV, and those that each component assumes, with as many components as starts.
    fn believing(&self, starts: u128) -> u128 {
        let tables = self.cells * (self.hotspots + 8) * WORD;
        let received = self.uavs * self.uavs * WORD;
        tables + received + (starts + GROWTH) * self.uavs * self.horizon * OBSERVATION
    }

    /// A plan, its file and the text of it: `plan.rs`, `file.rs`.
    fn result(&self) -> u128 {
        self.uavs * self.steps * (STEP + STEP_ON_FILE) + self.groups * SITE * GROWTH + TEXT
    }

    fn total(&self, starts: u128) -> u128 {
        let made = self.starts() + self.annealing() + self.bounding(starts) + self.rounds();
        self.tables() + self.believing(starts) + made + self.result()
    }
}

/// Returns the bytes that making a plan of a whole episode takes at most. Its hotspots are hidden
/// or known, as the configuration says.
#[must_use]
pub fn memory_bound(model: &Model<'_>) -> u64 {
    let known = model.config().target_visibility != TargetVisibility::Hidden;
    bound(model, known.then(|| model.hotspot_count()), 1)
}

fn bound(model: &Model<'_>, known: Option<usize>, starts: usize) -> u64 {
    let bytes = Demand::of(model, known).total(starts as u128);
    u64::try_from(bytes).unwrap_or(u64::MAX)
}

/// Checks that a search, or a tour of known hotspots, can be planned from a number of starts.
pub(crate) fn check(
    model: &Model<'_>,
    known: Option<usize>,
    starts: usize,
) -> Result<(), PlanError> {
    check_model(model)?;
    let sizes = Demand::of(model, known);
    check_sizes(model, sizes.sites as usize, sizes.steps as usize - 1)?;
    check_available(bound(model, known, starts))
}

/// Asks the system for an amount of memory and gives it back.
///
/// # Errors
/// [`PlanError::OutOfMemory`] if it is refused.
pub fn check_available(bytes: u64) -> Result<(), PlanError> {
    let refused = PlanError::OutOfMemory { bytes };
    let size = usize::try_from(bytes).map_err(|_| refused)?;
    let mut memory = Vec::<u8>::new();
    memory.try_reserve_exact(size).map_err(|_| refused)?;
    // An allocation that nothing uses may be left out.
    core::hint::black_box(&memory);
    Ok(())
}
