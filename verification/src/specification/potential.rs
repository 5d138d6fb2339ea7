//! The potentials Φ of the reward's shaping terms.

use super::{Specification, World, fraction};

/// Φ of the goal term and of the charging term.
#[derive(Clone, Copy, Debug)]
pub struct Potentials {
    pub goal: f64,
    pub charge: f64,
}

impl Potentials {
    /// Φ of a terminal state.
    pub const ZERO: Potentials = Potentials {
        goal: 0.0,
        charge: 0.0,
    };
}

impl Specification {
    pub(super) fn potentials(&self, world: &World) -> Potentials {
        Potentials {
            goal: self.goal_potential(world),
            charge: self.charge_potential(world),
        }
    }

    /// −w_g · mean_i (distance to the nearest unconfirmed hotspot) / (W + H − 2).
    fn goal_potential(&self, world: &World) -> f64 {
        let mut sum = 0.0;
        for i in 0..self.uavs() {
            let mut nearest: Option<i64> = None;
            for j in 0..self.hotspots() {
                if world.detected_at[j].is_some() {
                    continue;
                }
                let distance = world.position[i].manhattan(world.hotspot[j]);
                if nearest.is_none_or(|best| distance < best) {
                    nearest = Some(distance);
                }
            }
            sum += fraction(nearest.unwrap_or(0) as f64, self.longest_path());
        }
        -self.config.shaping_goal_weight * sum / self.uavs() as f64
    }

    /// w_c · mean_i ((1 − soc_i) · g_t · (1 − depot distance / (W + H − 2))).
    fn charge_potential(&self, world: &World) -> f64 {
        let green = self.green_share(world);
        let mut sum = 0.0;
        for i in 0..self.uavs() {
            let here = world.position[i];
            let distance = here.manhattan(self.nearest_depot(here)) as f64;
            let near = 1.0 - fraction(distance, self.longest_path());
            sum += (1.0 - self.soc(world, i)) * green * near;
        }
        self.config.shaping_charge_weight * sum / self.uavs() as f64
    }

    /// g_t = ρ_RE + (1 − ρ_RE) · (c_max − c_t)/(c_max − c_min), for the coming step.
    fn green_share(&self, world: &World) -> f64 {
        let renewable = self.config.renewable_share;
        renewable + (1.0 - renewable) * (1.0 - self.normalised_intensity(world))
    }

    /// (c_t − c_min)/(c_max − c_min), 0 where the intensity never changes.
    pub(super) fn normalised_intensity(&self, world: &World) -> f64 {
        let lo = self.energy.intensity_min_mg_per_kwh as f64;
        let hi = self.energy.intensity_max_mg_per_kwh as f64;
        fraction(world.coming_intensity_mg_per_kwh as f64 - lo, hi - lo)
    }

    pub(super) fn soc(&self, world: &World, i: usize) -> f64 {
        world.battery_uj[i] as f64 / self.energy.capacity_uj as f64
    }
}
