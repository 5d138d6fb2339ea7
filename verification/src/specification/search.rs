//! Search maps: the cells that each UAV knows to be searched.

use super::{Position, Specification, World, fraction};
use jcas_core::{MapDirections, SearchMaps, UavTag};

impl Specification {
    /// Adds the cells within the radius to the map of each UAV that is not grounded, after the
    /// move.
    pub(super) fn look_around(&self, world: &mut World) {
        if self.config.search_maps == SearchMaps::Off {
            return;
        }
        let cells_m = self.config.search_map_radius_m / self.config.cell_size_m;
        for i in 0..self.uavs() {
            if world.grounded[i] {
                continue;
            }
            for y in 0..self.height() {
                for x in 0..self.width() {
                    let squared = world.position[i].squared(Position { x, y }) as f64;
                    if squared <= cells_m * cells_m {
                        world.searched[i][y as usize][x as usize] = true;
                    }
                }
            }
        }
    }

    /// Makes N rounds in which each UAV takes over its neighbours' maps of the round before.
    pub(super) fn share_maps(&self, world: &mut World) {
        if self.config.search_maps == SearchMaps::Off {
            return;
        }
        // After a round without a change, no round changes anything.
        let mut settled = false;
        for _ in 0..self.uavs() {
            if settled {
                break;
            }
            let before = world.searched.clone();
            for i in 0..self.uavs() {
                for k in 0..self.uavs() {
                    if !world.linked[i][k] {
                        continue;
                    }
                    for (own, other) in world.searched[i].iter_mut().zip(&before[k]) {
                        for (own, other) in own.iter_mut().zip(other) {
                            *own |= other;
                        }
                    }
                }
            }
            settled = world.searched == before;
        }
    }

    /// Appends the window of the map, the unsearched fraction of each direction, and the tag.
    pub(super) fn push_search(&self, world: &World, i: usize, entries: &mut Vec<f64>) {
        let radius = i64::from(self.config.map_window_radius);
        if radius > 0 && self.config.search_maps != SearchMaps::Off {
            for dy in -radius..=radius {
                for dx in -radius..=radius {
                    entries.push(self.window_entry(world, i, dx, dy));
                }
            }
        }
        if self.config.map_directions == MapDirections::Shown {
            entries.extend(self.unsearched_shares(world, i));
        }
        match self.config.uav_tag {
            UavTag::Off => {}
            UavTag::Index => entries.push(fraction(i as f64, (self.uavs() - 1) as f64)),
        }
    }

    fn window_entry(&self, world: &World, i: usize, dx: i64, dy: i64) -> f64 {
        let (x, y) = (world.position[i].x + dx, world.position[i].y + dy);
        if x < 0 || y < 0 || x >= self.width() || y >= self.height() {
            -1.0
        } else if world.searched[i][y as usize][x as usize] {
            0.0
        } else {
            1.0
        }
    }

    /// Returns the fraction of each direction's cells that the UAV's map does not hold.
    fn unsearched_shares(&self, world: &World, i: usize) -> [f64; 8] {
        let (mut cells, mut unsearched) = ([0.0; 8], [0.0; 8]);
        for (y, row) in world.searched[i].iter().enumerate() {
            for (x, &searched) in row.iter().enumerate() {
                let dx = x as i64 - world.position[i].x;
                let dy = y as i64 - world.position[i].y;
                let Some(direction) = direction(dx, dy) else {
                    continue;
                };
                cells[direction] += 1.0;
                if !searched {
                    unsearched[direction] += 1.0;
                }
            }
        }
        std::array::from_fn(|direction| fraction(unsearched[direction], cells[direction]))
    }
}

/// Returns the direction of an offset, 0 to 7: 0 is right, and they increase counterclockwise.
fn direction(dx: i64, dy: i64) -> Option<usize> {
    let flat = 2 * dy.abs() < dx.abs();
    let steep = 2 * dx.abs() < dy.abs();
    match (dx.signum(), dy.signum()) {
        (0, 0) => None,
        (1, _) if flat => Some(0),
        (-1, _) if flat => Some(4),
        (_, 1) if steep => Some(2),
        (_, -1) if steep => Some(6),
        (1, 1) => Some(1),
        (-1, 1) => Some(3),
        (-1, -1) => Some(5),
        _ => Some(7),
    }
}
