//! Trajectories: the cell and the pilot density of each UAV in each step.

use alloc::vec;
use alloc::vec::Vec;

/// Cells are row-major indices; levels are indices into
/// [`Odds::densities`](crate::Odds::densities).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Paths {
    uavs: usize,
    steps: usize,
    cells: Vec<u32>,
    levels: Vec<u8>,
}

impl Paths {
    /// Makes the trajectories of a fleet that stays in its cells, one for each UAV, for a number of
    /// steps.
    #[must_use]
    pub fn hovering(cells: &[u32], steps: usize, level: u8) -> Self {
        Self {
            uavs: cells.len(),
            steps,
            cells: cells
                .iter()
                .flat_map(|&cell| core::iter::repeat_n(cell, steps + 1))
                .collect(),
            levels: vec![level; cells.len() * (steps + 1)],
        }
    }

    /// Returns the number of UAVs.
    #[must_use]
    pub fn uav_count(&self) -> usize {
        self.uavs
    }

    /// Returns the number of steps; the fleet stays in its last cells after them.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Returns the cell of a UAV after a step. After step 0 it is where the plan begins.
    #[must_use]
    pub fn cell(&self, uav: usize, step: usize) -> u32 {
        self.cells[uav * (self.steps + 1) + step.min(self.steps)]
    }

    /// Returns the level at which a UAV senses and communicates in a step, from 1.
    #[must_use]
    pub fn level(&self, uav: usize, step: usize) -> u8 {
        self.levels[uav * (self.steps + 1) + step.min(self.steps)]
    }

    /// Returns the cells of a UAV, from where the plan begins on.
    #[must_use]
    pub fn cells_of(&self, uav: usize) -> &[u32] {
        &self.cells[uav * (self.steps + 1)..][..self.steps + 1]
    }

    /// Returns the levels of a UAV; the first is not used.
    #[must_use]
    pub fn levels_of(&self, uav: usize) -> &[u8] {
        &self.levels[uav * (self.steps + 1)..][..self.steps + 1]
    }

    /// Sets the cell of a UAV after a step, and its level in the step.
    pub fn set(&mut self, uav: usize, step: usize, cell: u32, level: u8) {
        let slot = uav * (self.steps + 1) + step;
        self.cells[slot] = cell;
        self.levels[slot] = level;
    }

    /// Returns the remainder after some steps, as trajectories of another number of steps.
    #[must_use]
    pub fn after(&self, done: usize, steps: usize) -> Self {
        let slots = || (0..self.uavs).flat_map(|uav| (0..=steps).map(move |step| (uav, step)));
        Self {
            uavs: self.uavs,
            steps,
            cells: slots()
                .map(|(uav, step)| self.cell(uav, done + step))
                .collect(),
            levels: slots()
                .map(|(uav, step)| self.level(uav, done + step))
                .collect(),
        }
    }
}
