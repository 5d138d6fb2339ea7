//! False alarms, and the cells that a quorum of them confirms.

use super::{Position, Specification, World, draws, radar};
use jcas_core::QuorumWindow;

/// The most false alarms of a UAV in a step.
const MOST: usize = 8;

impl Specification {
    /// Draws the false alarms of each UAV that sensed, and confirms cells without a hotspot.
    pub(super) fn raise_false_alarms(&self, world: &mut World, was_sensing: &[bool]) {
        for (i, &senses) in was_sensing.iter().enumerate() {
            world.false_alarms[i] = if senses {
                self.false_alarms_of(world, i)
            } else {
                Vec::new()
            };
        }
        world.newly_false = 0;
        for y in 0..self.height() {
            for x in 0..self.width() {
                let cell = Position { x, y };
                let seen = self.seers_of(world, cell);
                let confirmed = &mut world.falsely_confirmed[y as usize][x as usize];
                if seen >= self.config.quorum as usize && !*confirmed {
                    *confirmed = true;
                    world.newly_false += 1;
                }
            }
        }
    }

    /// Returns how many UAVs raise a false alarm in a cell, in this step or in the episode so far.
    fn seers_of(&self, world: &mut World, cell: Position) -> usize {
        let (x, y) = (cell.x as usize, cell.y as usize);
        for (alarms, kept) in world.false_alarms.iter().zip(&mut world.remembered_false) {
            let kept = &mut kept[y][x];
            let alarmed = alarms.contains(&cell);
            *kept = alarmed || (*kept && self.config.quorum_window == QuorumWindow::Episode);
        }
        let kept = world.remembered_false.iter().filter(|kept| kept[y][x]);
        kept.count()
    }

    /// Returns the cells in which UAV i sees a hotspot that is not there.
    fn false_alarms_of(&self, world: &World, i: usize) -> Vec<Position> {
        let p = self.config.false_alarm_per_cell;
        if p == 0.0 {
            return Vec::new();
        }
        let mut footprint = Vec::new();
        let cells = self.footprint_m / self.config.cell_size_m;
        for y in 0..self.height() {
            for x in 0..self.width() {
                let cell = Position { x, y };
                if cell.squared(world.position[i]) as f64 <= cells * cells {
                    footprint.push(cell);
                }
            }
        }
        let count = draws::alarm_count(world.seed, world.t, i, footprint.len(), p, MOST);
        let ranks = draws::alarm_ranks(world.seed, world.t, i, count, footprint.len());
        let seen = ranks.into_iter().map(|rank| footprint[rank]);
        seen.filter(|cell| !world.hotspot.contains(cell)).collect()
    }

    /// Returns the radius of a footprint in metres.
    pub(super) fn footprint_radius_m(&self) -> f64 {
        let c = &self.config;
        if let Some(radius_m) = c.sensing_footprint_m {
            return radius_m;
        }
        if let (None, Some(range_m)) = (c.detection_threshold_db, c.sensing_range_m) {
            return range_m;
        }
        // The range at which P_d falls to one half at the highest density. No cell is further away
        // than the grid is long.
        let corner = Position {
            x: self.width() - 1,
            y: self.height() - 1,
        };
        let (mut low, mut high) = (
            0.0,
            c.cell_size_m * (corner.squared(Position { x: 0, y: 0 }) as f64).sqrt(),
        );
        let even =
            |range_m| self.probability_at(radar::by_range(c, range_m), c.pilot_density_max) >= 0.5;
        if even(high) {
            return high;
        }
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if even(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}
