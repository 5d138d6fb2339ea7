//! One step, in the order of the model's list.

use super::{
    Host, Position, Specification, World, draws, potential::Potentials, reward::StepFacts,
};
use jcas_core::{LearnedDetections, MotionMap, QuorumWindow};

impl Specification {
    /// Advances the world by one step. `actions[i]` is (u_dir, u_pilot) of UAV i
    /// and must hold no NaN.
    pub fn step(&self, world: &mut World, actions: &[(f32, f32)]) {
        self.step_with(world, actions, &Host::default());
    }

    /// Advances the world by one step, with a host's values in place of the model's.
    pub fn step_with(&self, world: &mut World, actions: &[(f32, f32)], host: &Host) {
        let before = self.potentials(world);
        let before_of: Vec<Potentials> = (0..self.uavs())
            .map(|i| self.uav_potentials(world, i))
            .collect();
        world.t += 1;
        self.decide_pilot(world, actions);
        let mut facts = self.fly(world, actions, host);
        self.look_around(world);
        let was_sensing = self.sense_and_learn(world, host);
        // A host's detections stand for all looks of the step.
        let looking = host.detections.is_none();
        let drawing: Vec<bool> = was_sensing
            .iter()
            .map(|&senses| senses && looking)
            .collect();
        self.raise_false_alarms(world, &drawing);
        self.count_sightings(world);
        match &host.links {
            None => self.link_up(world),
            Some(links) => self.link_over(world, links, host),
        }
        self.consensus(world);
        self.share_maps(world);
        self.share_reports(world);
        world.billed_intensity_mg_per_kwh = world.coming_intensity_mg_per_kwh;
        self.spend_and_charge(world, &was_sensing, &mut facts);
        self.inform(world);
        world.coming_intensity_mg_per_kwh = self.draw_intensity(world.seed, world.t);
        let after = if world.terminated {
            Potentials::ZERO
        } else {
            self.potentials(world)
        };
        world.rewards = self.reward(world, &facts, before, after);
        for (i, before) in before_of.into_iter().enumerate() {
            let after = if world.terminated {
                Potentials::ZERO
            } else {
                self.uav_potentials(world, i)
            };
            world.uav_rewards[i] = self.uav_reward(world, &facts, i, before, after);
        }
    }

    fn decide_pilot(&self, world: &mut World, actions: &[(f32, f32)]) {
        let (lo, hi) = (self.config.pilot_density_min, self.config.pilot_density_max);
        for (i, &(_, u_pilot)) in actions.iter().enumerate() {
            let u = clip(f64::from(u_pilot), -1.0, 1.0);
            world.pilot[i] = clip(lo + (u + 1.0) / 2.0 * (hi - lo), lo, hi);
        }
    }

    /// Moves each UAV, back to base where its battery is low, and counts what the reward needs.
    fn fly(&self, world: &mut World, actions: &[(f32, f32)], host: &Host) -> StepFacts {
        let visited_before = world.visited.clone();
        let mut facts = StepFacts::default();
        for (i, &(u_dir, _)) in actions.iter().enumerate() {
            let battery = world.battery_uj[i];
            world.grounded[i] = battery == 0;
            world.returning[i] = battery > 0 && battery < self.energy.return_uj;
            let here = world.position[i];
            let there = if world.grounded[i] {
                here
            } else if world.returning[i] {
                self.homeward(here)
            } else {
                self.moved_by(here, motion(u_dir, self.config.motion_map))
            };
            let there = match &host.positions {
                None => there,
                Some(positions) => positions[i],
            };
            let held = host.grounded.contains(&i);
            world.grounded[i] |= held;
            world.returning[i] &= !held;
            let there = if held { here } else { there };
            world.moved[i] = there != here;
            world.position[i] = there;
            let (x, y) = (there.x as usize, there.y as usize);
            facts.revisits.push(world.moved[i] && visited_before[y][x]);
            facts.first_visits.push(!world.visited[y][x]);
            world.visited[y][x] = true;
        }
        facts
    }

    /// Returns the cell one step toward the nearest depot, along x before y.
    fn homeward(&self, here: Position) -> Position {
        let home = self.nearest_depot(here);
        if here.x != home.x {
            Position {
                x: here.x + (home.x - here.x).signum(),
                y: here.y,
            }
        } else {
            Position {
                x: here.x,
                y: here.y + (home.y - here.y).signum(),
            }
        }
    }

    fn moved_by(&self, here: Position, (dx, dy): (i64, i64)) -> Position {
        let (x, y) = (here.x + dx, here.y + dy);
        let on_grid = x >= 0 && y >= 0 && x < self.width() && y < self.height();
        if on_grid { Position { x, y } } else { here }
    }

    /// Draws the detections, confirms hotspots and updates the knowledge. Returns for each UAV
    /// whether it was sensing, which its energy depends on.
    fn sense_and_learn(&self, world: &mut World, host: &Host) -> Vec<bool> {
        let (n, m) = (self.uavs(), self.hotspots());
        let mut was_sensing = vec![false; n];
        let mut positive = vec![vec![false; m]; n];
        for &j in &host.confirmed {
            world.confirmed_at[j] = world.confirmed_at[j].or(Some(world.t));
        }
        for i in 0..n {
            for j in 0..m {
                let settled = world.knows[i][j] && world.confirmed_at[j].is_some();
                if settled || world.grounded[i] {
                    continue;
                }
                was_sensing[i] = true;
                let (uav, hotspot) = (world.position[i], world.hotspot[j]);
                positive[i][j] = match &host.detections {
                    Some(detections) => detections[i][j],
                    None => {
                        let p = self.detection_probability(uav, hotspot, world.pilot[i]);
                        draws::detects(world.seed, world.t, i, j, p)
                    }
                };
            }
        }
        for j in 0..m {
            for i in 0..n {
                let kept = &mut world.remembered[i][j];
                *kept =
                    positive[i][j] || (*kept && self.config.quorum_window == QuorumWindow::Episode);
            }
            let count = (0..n).filter(|&i| world.remembered[i][j]).count();
            if world.confirmed_at[j].is_none() && count >= self.config.quorum as usize {
                world.confirmed_at[j] = Some(world.t);
            }
            for i in 0..n {
                let counts = world.confirmed_at[j].is_some()
                    || self.config.learned_detections == LearnedDetections::All;
                world.knows[i][j] |= world.remembered[i][j] && counts;
            }
        }
        world.detected = positive;
        was_sensing
    }

    /// Marks hotspots as informed, and decides whether the episode is over.
    fn inform(&self, world: &mut World) {
        for j in 0..self.hotspots() {
            let everybody = (0..self.uavs()).all(|i| world.knows[i][j]);
            if world.informed_at[j].is_none() && everybody {
                world.informed_at[j] = Some(world.t);
            }
        }
        let times = world.informed_at.iter().chain(&world.confirmed_at);
        world.terminated = times.into_iter().all(|at| at.is_some());
        world.truncated = !world.terminated && world.t == self.config.horizon_steps;
    }
}

/// Motion k = min(4, floor((u + 1)/2 · 5)) of the map's order.
pub fn motion(u_dir: f32, map: MotionMap) -> (i64, i64) {
    let (up, down, left, right, stay) = ((0, 1), (0, -1), (-1, 0), (1, 0), (0, 0));
    let order = match map {
        MotionMap::Udlrs => [up, down, left, right, stay],
        MotionMap::Symmetric => [up, left, stay, right, down],
    };
    let u = clip(f64::from(u_dir), -1.0, 1.0);
    let index = libm::floor((u + 1.0) / 2.0 * 5.0) as usize;
    order[index.min(4)]
}

fn clip(x: f64, lo: f64, hi: f64) -> f64 {
    if x < lo {
        lo
    } else if x > hi {
        hi
    } else {
        x
    }
}
