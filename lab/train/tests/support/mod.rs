//! A toy task to test the algorithm on: UAVs walk to a beacon on a small grid.
//!
//! Each step pays the share of UAVs that stand on the beacon. The best policy is known (walk
//! straight there, stay), so a learning curve can be judged without the kernel.

use jcas_core::MotionMap;
use jcas_core::action::motion;
use jcas_train::environment::{Episode, Shape, StepOut, VectorEnvironment};
use jcas_train::error::FormatError;
use jcas_train::random::stream;
use rand::RngExt;

const SIDE: i32 = 5;
const HORIZON: u32 = 16;
/// Fields of an observation.
const FIELDS: usize = 3;

/// Beacon missions side by side.
#[derive(Clone)]
pub struct Beacon {
    agents: usize,
    missions: Vec<Mission>,
}

#[derive(Clone, serde::Serialize, serde::Deserialize)]
struct Mission {
    seed: u64,
    episode: u64,
    t: u32,
    beacon: [i32; 2],
    positions: Vec<[i32; 2]>,
    return_sum: f64,
}

impl Mission {
    fn start(&mut self) {
        let mut random = stream(self.seed, self.episode);
        let mut cell = || [random.random_range(0..SIDE), random.random_range(0..SIDE)];
        self.beacon = cell();
        for position in &mut self.positions {
            *position = cell();
        }
        self.t = 0;
        self.return_sum = 0.0;
    }

    fn walk(&mut self, actions: &[f32]) -> f32 {
        let mut arrived = 0;
        for (position, action) in self.positions.iter_mut().zip(actions.chunks_exact(2)) {
            let (right, up) = motion(action[0], MotionMap::Udlrs).offset();
            let step = [right, up];
            for axis in 0..2 {
                position[axis] = (position[axis] + step[axis]).clamp(0, SIDE - 1);
            }
            arrived += i32::from(*position == self.beacon);
        }
        self.t += 1;
        arrived as f32 / self.positions.len() as f32
    }
}

impl Beacon {
    /// `environments` missions of `agents` UAVs each.
    pub fn new(environments: usize, agents: usize) -> Beacon {
        let mission = Mission {
            seed: 0,
            episode: 0,
            t: 0,
            beacon: [0, 0],
            positions: vec![[0, 0]; agents],
            return_sum: 0.0,
        };
        let mut beacon = Beacon {
            agents,
            missions: vec![mission; environments],
        };
        beacon.reset(0);
        beacon
    }

    fn write_observations(mission: &Mission, out: &mut [f32]) {
        for (position, row) in mission.positions.iter().zip(out.chunks_exact_mut(FIELDS)) {
            row[0] = (mission.beacon[0] - position[0]) as f32 / SIDE as f32;
            row[1] = (mission.beacon[1] - position[1]) as f32 / SIDE as f32;
            row[2] = mission.t as f32 / HORIZON as f32;
        }
    }

    fn write_global(mission: &Mission, out: &mut [f32]) {
        out[0] = mission.t as f32 / HORIZON as f32;
        for (position, fields) in mission.positions.iter().zip(out[1..].chunks_exact_mut(2)) {
            for axis in 0..2 {
                fields[axis] = (mission.beacon[axis] - position[axis]) as f32 / SIDE as f32;
            }
        }
    }
}

impl VectorEnvironment for Beacon {
    fn shape(&self) -> Shape {
        Shape {
            motion_map: MotionMap::Udlrs,
            environments: self.missions.len(),
            agents: self.agents,
            observation_len: FIELDS,
            global_len: 1 + 2 * self.agents,
            hotspots: 0,
            neighbour_slots: 0,
            grid: [SIDE as u32; 2],
            reach: 1.0,
        }
    }

    fn reset(&mut self, seed: u64) {
        for (index, mission) in self.missions.iter_mut().enumerate() {
            mission.seed = seed.wrapping_add(1_000_003 * index as u64);
            mission.episode = 0;
            mission.start();
        }
    }

    fn observe(&mut self, observations: &mut [f32], global: &mut [f32]) {
        let global_len = self.shape().global_len;
        let rows = observations.chunks_exact_mut(FIELDS * self.agents);
        let states = global.chunks_exact_mut(global_len);
        for ((mission, rows), state) in self.missions.iter().zip(rows).zip(states) {
            Beacon::write_observations(mission, rows);
            Beacon::write_global(mission, state);
        }
    }

    fn step(&mut self, actions: &[f32], out: &mut StepOut) {
        let global_len = self.shape().global_len;
        let team = out.rewards.len() == self.missions.len();
        out.finished.clear();
        for (m, mission) in self.missions.iter_mut().enumerate() {
            let reward = mission.walk(&actions[m * self.agents * 2..(m + 1) * self.agents * 2]);
            mission.return_sum += f64::from(reward);
            if team {
                out.rewards[m] = reward;
            } else {
                let own = &mut out.rewards[m * self.agents..(m + 1) * self.agents];
                for (own, position) in own.iter_mut().zip(&mission.positions) {
                    *own = f32::from(u8::from(*position == mission.beacon));
                }
            }
            out.terminated[m] = false;
            out.truncated[m] = mission.t == HORIZON;
            if mission.t == HORIZON {
                Beacon::write_global(
                    mission,
                    &mut out.final_global[m * global_len..(m + 1) * global_len],
                );
                out.finished.push(Episode {
                    return_sum: mission.return_sum,
                    success: reward == 1.0,
                    steps: mission.t,
                    energy_kwh: 0.0,
                    throughput: 0.0,
                });
                mission.episode += 1;
                mission.start();
            }
        }
    }

    fn save(&self) -> Vec<u8> {
        serde_json::to_vec(&self.missions).expect("plain data serialises")
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), FormatError> {
        self.missions = serde_json::from_slice(bytes)?;
        Ok(())
    }
}
