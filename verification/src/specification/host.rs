//! Values that a host simulator supplies in place of the model's.

use super::{Position, Specification, World};

/// The quantities of one step that a host supplies. By default it supplies none.
#[derive(Clone, Debug, Default)]
pub struct Host {
    /// Cell of each UAV, in place of the model's motion.
    pub positions: Option<Vec<Position>>,
    /// Indices of the UAVs that the host keeps on the ground.
    pub grounded: Vec<usize>,
    /// Indices of the hotspots that the host confirms.
    pub confirmed: Vec<usize>,
    /// `detections[i][j]`, in place of the draws.
    pub detections: Option<Vec<Vec<bool>>>,
    /// `links[i][k]`, in place of the link budget's graph.
    pub links: Option<Vec<Vec<bool>>>,
    /// The mean throughput of each UAV as the host measured it, only together with `links`.
    pub throughput: Option<Vec<f64>>,
}

impl Specification {
    /// Sets the start cells of the UAVs.
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

    /// Sets the charge of battery i, and books the difference as the host's adjustment.
    pub fn set_battery(&self, world: &mut World, i: usize, charge_uj: u64) {
        world.given_uj[i] += charge_uj as i64 - world.battery_uj[i] as i64;
        world.battery_uj[i] = charge_uj;
        if world.t == 0 {
            world.grounded[i] = charge_uj == 0;
            self.link_up(world);
        }
    }

    /// Sets the charge of each battery at the start, in place of the drawn charge.
    pub fn set_batteries(&self, world: &mut World, charges_uj: &[u64]) {
        world.battery_uj = charges_uj.to_vec();
        world.initial_uj = charges_uj.to_vec();
        world.given_uj.fill(0);
        world.grounded = charges_uj.iter().map(|&charge| charge == 0).collect();
        self.link_up(world);
    }

    /// Takes over the host's graph among the UAVs that fly, and the throughputs measured over it.
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
