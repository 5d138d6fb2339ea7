//! Reports: how often a UAV saw a hotspot in each cell, and what it knows of the others' counts.

use super::{Position, Specification, World, fraction};

impl Specification {
    /// Counts the detections and false alarms of the step.
    pub(super) fn count_sightings(&self, world: &mut World) {
        for i in 0..self.uavs() {
            let mut seen = world.false_alarms[i].clone();
            seen.extend((0..self.hotspots()).filter_map(|j| {
                let detected = world.detected[i][j];
                detected.then_some(world.hotspot[j])
            }));
            for cell in seen {
                let (x, y) = (cell.x as usize, cell.y as usize);
                world.sightings[i][y][x] += 1;
                let count = self.report_level(world.sightings[i][y][x]);
                world.reported[i][y][x] = world.reported[i][y][x].max(count);
            }
        }
    }

    /// Returns the level of a number of sightings: no more than the configured number of levels.
    pub fn report_level(&self, sightings: u32) -> u32 {
        sightings.min(self.config.report_levels)
    }

    /// Makes N rounds in which each UAV takes over its neighbours' reports of the round before.
    pub(super) fn share_reports(&self, world: &mut World) {
        if self.config.report_levels == 0 {
            return;
        }
        for _ in 0..self.uavs() {
            let before = world.reported.clone();
            for i in 0..self.uavs() {
                for k in 0..self.uavs() {
                    if world.linked[i][k] {
                        take_over(&mut world.reported[i], &before[k]);
                    }
                }
            }
            // After a round without a change, no round changes anything.
            if world.reported == before {
                break;
            }
        }
    }

    /// Appends a window for each level, and then the nearest reported cells.
    pub(super) fn push_reports(&self, world: &World, i: usize, entries: &mut Vec<f64>) {
        let radius = i64::from(self.config.map_window_radius);
        if radius > 0 {
            for level in 1..=self.config.report_levels {
                for dy in -radius..=radius {
                    for dx in -radius..=radius {
                        entries.push(self.report_entry(world, i, (dx, dy), level));
                    }
                }
            }
        }
        let cells = self.open_reports(world, i);
        for slot in 0..self.config.report_slots as usize {
            let Some(&(cell, level)) = cells.get(slot) else {
                entries.extend([0.0, 0.0, 0.0]);
                continue;
            };
            self.push_offset(world.position[i], cell, entries);
            entries.push(fraction(level.into(), self.config.report_levels.into()));
        }
    }

    fn report_entry(&self, world: &World, i: usize, offset: (i64, i64), level: u32) -> f64 {
        let (x, y) = (
            world.position[i].x + offset.0,
            world.position[i].y + offset.1,
        );
        if x < 0 || y < 0 || x >= self.width() || y >= self.height() {
            -1.0
        } else if world.reported[i][y as usize][x as usize] >= level {
            1.0
        } else {
            0.0
        }
    }

    /// Returns the reported cells that no quorum has confirmed, with their levels: nearest first,
    /// and on a tie row by row.
    fn open_reports(&self, world: &World, i: usize) -> Vec<(Position, u32)> {
        let confirmed = |cell: Position| {
            let mut hotspots = world.hotspot.iter().zip(&world.confirmed_at);
            hotspots.any(|(&hotspot, at)| hotspot == cell && at.is_some())
        };
        let mut open = Vec::new();
        for y in 0..self.height() {
            for x in 0..self.width() {
                let cell = Position { x, y };
                let level = world.reported[i][y as usize][x as usize];
                let falsely = world.falsely_confirmed[y as usize][x as usize];
                if level > 0 && !falsely && !confirmed(cell) {
                    open.push((cell, level));
                }
            }
        }
        // The sort keeps the order of cells at the same distance.
        open.sort_by_key(|&(cell, _)| cell.squared(world.position[i]));
        open
    }
}

fn take_over(own: &mut [Vec<u32>], other: &[Vec<u32>]) {
    for (own, other) in own.iter_mut().zip(other) {
        for (own, &other) in own.iter_mut().zip(other) {
            *own = (*own).max(other);
        }
    }
}
