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
    /// The team's potentials: the means of its UAVs'.
    pub(super) fn potentials(&self, world: &World) -> Potentials {
        let mean = |part: &dyn Fn(usize) -> f64| {
            (0..self.uavs()).map(part).sum::<f64>() / self.uavs() as f64
        };
        let goal = mean(&|i| self.way_to_go(world, i)) + self.left_to_confirm(world);
        Potentials {
            goal: -self.config.shaping_goal_weight * goal,
            charge: self.config.shaping_charge_weight * mean(&|i| self.use_of_charging(world, i)),
        }
    }

    /// The potentials of UAV i.
    pub(super) fn uav_potentials(&self, world: &World, i: usize) -> Potentials {
        let goal = self.way_to_go(world, i) + self.left_to_confirm(world);
        Potentials {
            goal: -self.config.shaping_goal_weight * goal,
            charge: self.config.shaping_charge_weight * self.use_of_charging(world, i),
        }
    }

    /// Distance to the nearest unconfirmed hotspot over W + H − 2, 0 if there is none.
    fn way_to_go(&self, world: &World, i: usize) -> f64 {
        let mut nearest: Option<i64> = None;
        for j in 0..self.hotspots() {
            if world.confirmed_at[j].is_some() {
                continue;
            }
            let distance = world.position[i].manhattan(world.hotspot[j]);
            if nearest.is_none_or(|best| distance < best) {
                nearest = Some(distance);
            }
        }
        fraction(nearest.unwrap_or(0) as f64, self.longest_path())
    }

    /// w_u for each unconfirmed hotspot.
    fn left_to_confirm(&self, world: &World) -> f64 {
        let unconfirmed = world.confirmed_at.iter().filter(|at| at.is_none()).count();
        self.config.shaping_unconfirmed_weight * unconfirmed as f64
    }

    /// (1 − soc_i) · g_t · (1 − depot distance / (W + H − 2)).
    fn use_of_charging(&self, world: &World, i: usize) -> f64 {
        let here = world.position[i];
        let distance = here.manhattan(self.nearest_depot(here)) as f64;
        let near = 1.0 - fraction(distance, self.longest_path());
        (1.0 - self.soc(world, i)) * self.green_share(world) * near
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
