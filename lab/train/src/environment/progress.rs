//! Each UAV's own progress: how many cells it has come nearer to the unconfirmed hotspot nearest to it.

use jcas_core::{Model, StateRef};

/// Where the UAVs of some missions stood when they were last looked at.
#[derive(Clone, Debug)]
pub struct Progress {
    uavs: usize,
    /// Manhattan distance of each UAV to its nearest unconfirmed hotspot; 0 where there is none.
    ways: Vec<u32>,
    /// Unconfirmed hotspots of each mission.
    open: Vec<usize>,
}

impl Progress {
    /// Of so many missions of so many UAVs each, none of which has been looked at.
    pub fn new(missions: usize, uavs: usize) -> Progress {
        Progress {
            uavs,
            ways: vec![0; missions * uavs],
            open: vec![0; missions],
        }
    }

    /// Looks at a mission: whatever it was before, progress counts from here.
    pub fn start(&mut self, mission: usize, model: &Model<'_>, state: &StateRef<'_>) {
        let open: Vec<_> = (0..model.hotspot_count())
            .filter(|&hotspot| !state.confirmed(hotspot))
            .map(|hotspot| state.hotspot_cell(hotspot))
            .collect();
        self.open[mission] = open.len();
        let ways = &mut self.ways[mission * self.uavs..][..self.uavs];
        for (uav, way) in ways.iter_mut().enumerate() {
            let cell = state.cell(uav);
            *way = open.iter().map(|&to| cell.manhattan(to)).min().unwrap_or(0);
        }
    }

    /// Cells that each UAV of a mission has come nearer since it was last looked at. Where a hotspot was
    /// confirmed since, nobody's: the next one is farther away, and nobody is to pay for that.
    pub fn gained(
        &mut self,
        mission: usize,
        model: &Model<'_>,
        state: &StateRef<'_>,
        cells: &mut [f64],
    ) {
        let place = mission * self.uavs;
        let open = self.open[mission];
        for (cells, &way) in cells.iter_mut().zip(&self.ways[place..]) {
            *cells = f64::from(way);
        }
        self.start(mission, model, state);
        let same = self.open[mission] == open;
        for (cells, &way) in cells.iter_mut().zip(&self.ways[place..]) {
            *cells = if same { *cells - f64::from(way) } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Sim};

    // Each UAV flies one cell along x: nearer by one where its nearest hotspot lies that way, farther by one
    // where it does not; all of it worked out from the positions.
    #[test]
    fn a_step_gains_what_the_distances_say_and_a_confirmation_nothing() {
        let config = Config {
            uav_count: 4,
            hotspot_count: 2,
            detection_threshold_db: Some(200.0),
            ..Config::default()
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(11);
        let mut progress = Progress::new(1, 4);
        progress.start(0, &model, &sim.state());
        let way = |sim: &Sim<'_>, uav: usize| {
            let state = sim.state();
            let to = |hotspot| state.cell(uav).manhattan(state.hotspot_cell(hotspot));
            f64::from(to(0).min(to(1)))
        };
        let mut cells = [0.0; 4];
        let mut seen = Vec::new();
        for step in 0..12 {
            let before: Vec<f64> = (0..4).map(|uav| way(&sim, uav)).collect();
            let direction = [-0.8, 0.4, -0.4, 0.0][step % 4];
            sim.step(&[direction, 0.0, -direction, 0.0, 0.8, 0.0, 0.4, 0.0])
                .unwrap();
            progress.gained(0, &model, &sim.state(), &mut cells);
            let gained: Vec<f64> = (0..4).map(|uav| before[uav] - way(&sim, uav)).collect();
            assert_eq!(cells.as_slice(), gained);
            seen.extend(gained);
        }
        assert!(seen.contains(&1.0) && seen.contains(&-1.0) && seen.contains(&0.0));

        progress.open[0] = 3;
        sim.step(&[0.4, 0.0, 0.4, 0.0, 0.4, 0.0, 0.4, 0.0]).unwrap();
        progress.gained(0, &model, &sim.state(), &mut cells);
        assert_eq!(cells, [0.0; 4]);
    }
}
