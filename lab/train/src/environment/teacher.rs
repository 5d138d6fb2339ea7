//! A teacher: the baseline `teams`, asked in every state that the learner visits.
//!
//! It knows the positions and confirmations of all hotspots, which a UAV learns by radio alone. The
//! learner imitates it as well as its own observations allow.

use crate::head::motion_of;
use jcas_core::Model;
use jcas_policy::Policy;
use jcas_policy::baselines::{Baseline, BaselineKind, PilotMode};

/// The teachers of several episodes.
#[derive(Debug)]
pub struct Teachers {
    of_mission: Vec<Baseline>,
    /// Actions of one fleet.
    actions: Vec<f32>,
}

impl Teachers {
    /// Teachers for `missions` episodes, before the first of them starts.
    pub fn new(missions: usize) -> Teachers {
        let teams = || BaselineKind::Teams.build_privileged(PilotMode::Adaptive);
        Teachers {
            of_mission: (0..missions).map(|_| teams()).collect(),
            actions: Vec::new(),
        }
    }

    /// Makes the teacher of an episode plan anew in the next state.
    pub fn start(&mut self, mission: usize, model: &Model<'_>) {
        self.of_mission[mission].reset(model, 0);
    }

    /// Writes the motion of each UAV in these states, as an index of `Motion::ALL`.
    pub fn motions(&mut self, model: &Model<'_>, states: &[u64], motions: &mut [f32]) {
        let uavs = model.uav_count();
        self.actions.resize(2 * uavs, 0.0);
        let states = states.chunks_exact(model.state_words());
        let fleets = self.of_mission.iter_mut().zip(states);
        for ((teacher, state), motions) in fleets.zip(motions.chunks_exact_mut(uavs)) {
            let state = model.state(state).expect("a state of this model");
            teacher.act(model, &state, &mut self.actions);
            for (motion, action) in motions.iter_mut().zip(self.actions.chunks_exact(2)) {
                *motion = motion_of(action[0]) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Motion, Preset, Sim};

    // Three UAVs and one hotspot: each step takes all of them nearer, or they stay over it. A
    // teacher that starts anew knows where the next episode has it.
    #[test]
    fn a_fleet_is_sent_to_its_hotspot() {
        let config = Config {
            uav_count: 3,
            hotspot_count: 1,
            ..Config::preset(Preset::Mission)
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        let mut teachers = Teachers::new(1);
        for seed in 0..20 {
            sim.reset(seed);
            teachers.start(0, &model);
            let there = sim.state().hotspot_cell(0);
            for step in 0..4 {
                let mut motions = [9.0; 3];
                teachers.motions(&model, sim.words(), &mut motions);
                let state = sim.state();
                for (uav, motion) in motions.into_iter().enumerate() {
                    let motion = Motion::ALL[motion as usize];
                    let before = state.cell(uav);
                    let (dx, dy) = motion.offset();
                    let after = [before.x as i32 + dx, before.y as i32 + dy];
                    let distance =
                        |x: i32, y: i32| x.abs_diff(there.x as i32) + y.abs_diff(there.y as i32);
                    let nearer = before.manhattan(there) - distance(after[0], after[1]);
                    assert_eq!(nearer, u32::from(before != there), "{seed} {step} {uav}");
                }
                let actions =
                    motions.map(|motion| [Motion::ALL[motion as usize].to_action(), -1.0]);
                if sim.step(actions.as_flattened()).unwrap().terminated {
                    break;
                }
            }
        }
    }
}
