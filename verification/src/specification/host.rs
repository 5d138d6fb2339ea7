//! What a host simulator puts in place of the model's own.

use super::{Position, Specification, World};

/// What a host owns of one step; nothing by default.
#[derive(Clone, Debug, Default)]
pub struct Host {
    /// Where it has moved the UAVs.
    pub positions: Option<Vec<Position>>,
    /// UAVs that it keeps on the ground.
    pub grounded: Vec<usize>,
    /// Hotspots that it confirms.
    pub confirmed: Vec<usize>,
    /// `detections[i][j]`, in place of the draws.
    pub detections: Option<Vec<Vec<bool>>>,
    /// `links[i][k]`, in place of the link budget's graph.
    pub links: Option<Vec<Vec<bool>>>,
    /// The mean throughput of each UAV as it measured it; only with `links`.
    pub throughput: Option<Vec<f64>>,
}

impl Specification {
    /// Puts the UAVs where they start.
    pub fn set_starts(&self, world: &mut World, starts: &[Position]) {
        for row in &mut world.visited {
            row.fill(false);
        }
        world.position = starts.to_vec();
        for start in starts {
            world.visited[start.y as usize][start.x as usize] = true;
        }
        self.link_up(world);
    }

    /// Sets what battery i holds; the difference is the host's.
    pub fn set_battery(&self, world: &mut World, i: usize, charge_uj: u64) {
        world.given_uj[i] += charge_uj as i64 - world.battery_uj[i] as i64;
        world.battery_uj[i] = charge_uj;
        if world.t == 0 {
            world.grounded[i] = charge_uj == 0;
            self.link_up(world);
        }
    }

    /// Sets what each battery holds at the start, in place of the drawn charge.
    pub fn set_batteries(&self, world: &mut World, charges_uj: &[u64]) {
        world.battery_uj = charges_uj.to_vec();
        world.initial_uj = charges_uj.to_vec();
        world.given_uj.fill(0);
        world.grounded = charges_uj.iter().map(|&charge| charge == 0).collect();
        self.link_up(world);
    }

    /// The host's graph among the UAVs that fly, and what it measured over it.
    pub(super) fn link_over(&self, world: &mut World, links: &[Vec<bool>], host: &Host) {
        let n = self.uavs();
        for (i, row) in links.iter().enumerate() {
            for (k, &link) in row.iter().enumerate() {
                let both_fly = !world.grounded[i] && !world.grounded[k];
                world.linked[i][k] = i != k && both_fly && link;
            }
        }
        self.measure(world);
        if let Some(measured) = &host.throughput {
            for (i, &value) in measured.iter().enumerate() {
                let alone = !world.linked[i].contains(&true);
                world.throughput[i] = if alone { 0.0 } else { value };
            }
            world.mean_throughput = world.throughput.iter().sum::<f64>() / n as f64;
        }
    }
}
