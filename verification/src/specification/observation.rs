//! The observation of each UAV and the global state, entry by entry.

use super::{Position, Specification, World, fraction};
use jcas_core::TargetVisibility;

impl Specification {
    /// Returns the observation of UAV i.
    pub fn observe(&self, world: &World, i: usize) -> Vec<f32> {
        let mut entries = Vec::new();
        self.push_self(world, i, &mut entries);
        for j in 0..self.hotspots() {
            self.push_hotspot(world, i, j, &mut entries);
        }
        self.push_neighbours(world, i, &mut entries);
        let here = world.position[i];
        let depot_distance = here.manhattan(self.nearest_depot(here)) as f64;
        entries.push(self.normalised_intensity(world));
        entries.push(fraction(depot_distance, self.longest_path()));
        self.push_progress(world, &mut entries);
        self.push_search(world, i, &mut entries);
        self.push_reports(world, i, &mut entries);
        entries.into_iter().map(|entry| entry as f32).collect()
    }

    fn push_self(&self, world: &World, i: usize, entries: &mut Vec<f64>) {
        self.push_cell(world.position[i], entries);
        entries.push(self.soc(world, i));
        entries.push(self.normalised_pilot(world, i));
        entries.push(world.throughput[i]);
    }

    fn push_hotspot(&self, world: &World, i: usize, j: usize, entries: &mut Vec<f64>) {
        let knows = world.knows[i][j];
        let seen = knows || self.config.target_visibility == TargetVisibility::Known;
        let (here, there) = (world.position[i], world.hotspot[j]);
        if seen {
            self.push_offset(here, there, entries);
        } else {
            entries.extend([0.0, 0.0]);
        }
        entries.push(flag(world.confirmed_at[j].is_some()));
        entries.push(flag(knows));
    }

    /// Appends the neighbours, nearest first and on a tie by index, and then their count.
    fn push_neighbours(&self, world: &World, i: usize, entries: &mut Vec<f64>) {
        let others = self.uavs() - 1;
        let slots = others.min(self.config.neighbour_slots as usize);
        let here = world.position[i];
        let mut neighbours: Vec<usize> = (0..self.uavs()).filter(|&k| world.linked[i][k]).collect();
        let count = neighbours.len();
        neighbours.sort_by_key(|&k| (here.squared(world.position[k]), k));
        for slot in 0..slots {
            match neighbours.get(slot) {
                Some(&k) => {
                    entries.push(1.0);
                    self.push_offset(here, world.position[k], entries);
                }
                None => entries.extend([0.0, 0.0, 0.0]),
            }
        }
        entries.push(fraction(count as f64, others as f64));
    }

    fn push_progress(&self, world: &World, entries: &mut Vec<f64>) {
        let m = self.hotspots() as f64;
        entries.push(world.confirmed_at.iter().flatten().count() as f64 / m);
        entries.push(world.informed_at.iter().flatten().count() as f64 / m);
        entries.push(f64::from(world.t) / f64::from(self.config.horizon_steps));
    }

    /// Returns the global state for a centralised critic.
    pub fn observe_global(&self, world: &World) -> Vec<f32> {
        let mut entries = Vec::new();
        for i in 0..self.uavs() {
            self.push_self(world, i, &mut entries);
            let known = world.knows[i].iter().filter(|&&k| k).count();
            entries.push(known as f64 / self.hotspots() as f64);
        }
        for j in 0..self.hotspots() {
            self.push_cell(world.hotspot[j], &mut entries);
            entries.push(flag(world.confirmed_at[j].is_some()));
            entries.push(self.knowing_share(world, j));
        }
        entries.push(self.normalised_intensity(world));
        self.push_progress(world, &mut entries);
        entries.into_iter().map(|entry| entry as f32).collect()
    }

    fn push_cell(&self, cell: Position, entries: &mut Vec<f64>) {
        self.push_offset(Position { x: 0, y: 0 }, cell, entries);
    }

    pub(super) fn push_offset(&self, from: Position, to: Position, entries: &mut Vec<f64>) {
        entries.push(fraction((to.x - from.x) as f64, (self.width() - 1) as f64));
        entries.push(fraction((to.y - from.y) as f64, (self.height() - 1) as f64));
    }

    fn normalised_pilot(&self, world: &World, i: usize) -> f64 {
        let (lo, hi) = (self.config.pilot_density_min, self.config.pilot_density_max);
        fraction(world.pilot[i] - lo, hi - lo)
    }
}

fn flag(x: bool) -> f64 {
    if x { 1.0 } else { 0.0 }
}
