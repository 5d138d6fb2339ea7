//! A potential for gathering: it falls as the fleet closes in on one hotspot and as hotspots are confirmed.
//!
//! Confirming takes a quorum in one cell, so a UAV that searches alone learns nothing from its reward.
//! The model's own goal potential draws every UAV to the hotspot nearest to itself and so apart; this one
//! counts, for the hotspot where they are nearest on the whole, the way of the nearest few.

use jcas_core::{Model, StateRef};

/// How much gathering counts while training, and for how many UAVs.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Gather {
    /// Weight; 0 leaves it out.
    pub weight: f64,
    /// Nearest UAVs that count, at least one; more than the fleet has are all of it.
    pub uavs: usize,
}

impl Gather {
    /// Φ(s) = −w · (unconfirmed hotspots + least mean way of the nearest UAVs in units of W + H − 2).
    pub fn potential(&self, model: &Model<'_>, state: &StateRef<'_>) -> f64 {
        let config = model.config();
        let far = f64::from((config.grid_width + config.grid_height - 2).max(1));
        let mut left = 0;
        let mut nearest = f64::INFINITY;
        let mut ways = vec![0; model.uav_count()];
        for hotspot in 0..model.hotspot_count() {
            if state.confirmed(hotspot) {
                continue;
            }
            left += 1;
            let cell = state.hotspot_cell(hotspot);
            for (uav, way) in ways.iter_mut().enumerate() {
                *way = state.cell(uav).manhattan(cell);
            }
            ways.sort_unstable();
            let counted = &ways[..self.uavs.min(ways.len())];
            let mean = f64::from(counted.iter().sum::<u32>()) / counted.len() as f64;
            nearest = nearest.min(mean / far);
        }
        let way = if left > 0 { nearest } else { 0.0 };
        -self.weight * (f64::from(left) + way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Sim};

    // Four UAVs at the depot; by hand: the hotspot nearest to it decides, and all have the same way.
    #[test]
    fn at_the_start_it_is_the_way_to_the_nearest_hotspot() {
        let model = Model::new(Config {
            uav_count: 4,
            hotspot_count: 3,
            ..Config::default()
        })
        .unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(7);
        let state = sim.state();
        let depot = state.cell(0);
        let ways = (0..3).map(|hotspot| depot.manhattan(state.hotspot_cell(hotspot)));
        let nearest = f64::from(ways.min().unwrap());
        for uavs in [1, 3, 9] {
            let gather = Gather { weight: 2.0, uavs };
            let expected = -2.0 * (3.0 + nearest / 22.0);
            assert!((gather.potential(&model, &state) - expected).abs() < 1e-12);
        }
    }
}
