//! The world at t = 0.

use super::{Position, Rewards, Specification, World, draws, energy};
use jcas_core::StartCells;

impl Specification {
    /// Returns the start of the episode of `seed`.
    pub fn reset(&self, seed: u64) -> World {
        let (n, m) = (self.uavs(), self.hotspots());
        let position: Vec<Position> = (0..n).map(|i| self.start(seed, i)).collect();
        let mut visited = vec![vec![false; self.width() as usize]; self.height() as usize];
        for start in &position {
            visited[start.y as usize][start.x as usize] = true;
        }
        let initial_uj: Vec<u64> = (0..n).map(|i| self.initial_battery_uj(seed, i)).collect();
        let mut world = World {
            seed,
            t: 0,
            position,
            initial_uj: initial_uj.clone(),
            grounded: initial_uj.iter().map(|&battery| battery == 0).collect(),
            battery_uj: initial_uj,
            spent_uj: vec![0; n],
            accepted_uj: vec![0; n],
            given_uj: vec![0; n],
            shortfall_uj: vec![0; n],
            pilot: vec![self.config.pilot_density_min; n],
            throughput: vec![0.0; n],
            returning: vec![false; n],
            moved: vec![false; n],
            linked: vec![vec![false; n]; n],
            hotspot: self.place_hotspots(seed),
            detected: vec![vec![false; m]; n],
            knows: vec![vec![false; m]; n],
            confirmed_at: vec![None; m],
            informed_at: vec![None; m],
            searched: vec![vec![vec![false; self.width() as usize]; self.height() as usize]; n],
            false_alarms: vec![Vec::new(); n],
            falsely_confirmed: vec![vec![false; self.width() as usize]; self.height() as usize],
            newly_false: 0,
            sightings: vec![vec![vec![0; self.width() as usize]; self.height() as usize]; n],
            reported: vec![vec![vec![0; self.width() as usize]; self.height() as usize]; n],
            remembered: vec![vec![false; m]; n],
            remembered_false: vec![
                vec![vec![false; self.width() as usize]; self.height() as usize];
                n
            ],
            visited,
            coming_intensity_mg_per_kwh: self.draw_intensity(seed, 0),
            billed_intensity_mg_per_kwh: 0,
            grid_uj: 0,
            co2_ng: 0,
            mean_throughput: 0.0,
            rewards: Rewards::default(),
            uav_rewards: vec![Rewards::default(); n],
            terminated: false,
            truncated: false,
        };
        // The first observation shows the links among the start cells.
        self.link_up(&mut world);
        world
    }

    /// Returns the cell in which UAV i starts. A drawn one counts the cells of the grid row by row.
    fn start(&self, seed: u64, i: usize) -> Position {
        match self.config.start_cells {
            StartCells::Depot => self.depots[0],
            StartCells::Random => {
                let rank = draws::start_rank(seed, i, (self.width() * self.height()) as u64) as i64;
                Position {
                    x: rank % self.width(),
                    y: rank / self.width(),
                }
            }
        }
    }

    fn initial_battery_uj(&self, seed: u64, i: usize) -> u64 {
        let (lo, hi) = (self.config.initial_soc_min, self.config.initial_soc_max);
        let soc = draws::initial_soc(seed, i, lo, hi);
        energy::half_up(self.energy.capacity_uj as f64 * soc)
    }

    /// Draws the hotspots on distinct cells without a depot. Ranks count those cells row by row.
    fn place_hotspots(&self, seed: u64) -> Vec<Position> {
        let mut free = Vec::new();
        for y in 0..self.height() {
            for x in 0..self.width() {
                let cell = Position { x, y };
                if !self.is_depot(cell) {
                    free.push(cell);
                }
            }
        }
        let ranks = draws::distinct_ranks(seed, self.hotspots(), free.len());
        ranks.into_iter().map(|rank| free[rank as usize]).collect()
    }

    /// Returns the carbon intensity of the step after time t, in mg/kWh.
    pub(super) fn draw_intensity(&self, seed: u64, t: u32) -> u64 {
        let lo = self.energy.intensity_min_mg_per_kwh;
        let hi = self.energy.intensity_max_mg_per_kwh;
        draws::carbon_intensity(seed, t, lo, hi)
    }
}
