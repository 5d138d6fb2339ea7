//! A teacher: the baseline `squads`, asked in every state that the learner visits.
//!
//! A learner observes a state and no plan. So the teacher plans anew in each state, by what the
//! members of a radio component know. Which UAV of a cell joins which team does not matter. So the
//! motions of a cell are assigned round-robin, and its first UAVs show whether and how it divides.
//! Pilot densities are those of the rule `adaptive`, which reads all confirmations.

use jcas_core::action::motion;
use jcas_core::{Model, Motion, StateRef};
use jcas_policy::{Baseline, BaselineKind, PilotMode, Policy};

/// The teacher of any number of episodes of one configuration.
#[derive(Debug)]
pub struct Teacher {
    /// The planner of motions.
    squads: Baseline,
    /// Actions of one fleet.
    actions: Vec<f32>,
}

impl Default for Teacher {
    fn default() -> Teacher {
        Teacher::new()
    }
}

impl Teacher {
    /// A teacher of motions and pilot densities.
    pub fn new() -> Teacher {
        Teacher {
            squads: BaselineKind::Squads.build_privileged(PilotMode::Adaptive),
            actions: Vec::new(),
        }
    }

    /// Writes a raw action of the hybrid head for each UAV in these states.
    ///
    /// It has the motion as an index of `Motion::ALL`, and the place of the pilot density in its
    /// range.
    pub fn teach(&mut self, model: &Model<'_>, states: &[u64], labels: &mut [f32]) {
        let uavs = model.uav_count();
        self.actions.resize(2 * uavs, 0.0);
        let states = states.chunks_exact(model.state_words());
        for (state, labels) in states.zip(labels.chunks_exact_mut(2 * uavs)) {
            let state = model.state(state).expect("a state of this model");
            // Without a plan from the state before.
            self.squads.reset(model, 0);
            self.squads.act(model, &state, &mut self.actions);
            let actions = self.actions.chunks_exact(2);
            for (label, action) in labels.chunks_exact_mut(2).zip(actions) {
                label[0] = motion(action[0], model.config().motion_map) as u8 as f32;
                label[1] = (action[1] + 1.0) / 2.0;
            }
            deal(&state, labels);
        }
    }
}

/// Deals the motions of each cell to its UAVs by turns, so that every motion has its share of any
/// number of first UAVs.
fn deal(state: &StateRef<'_>, labels: &mut [f32]) {
    let uavs = labels.len() / 2;
    // The motions of a cell, all and those dealt, are counted where its first UAV is.
    let mut all = vec![[0i32; Motion::ALL.len()]; uavs];
    let mut dealt = all.clone();
    let flies = |uav: usize| !state.grounded(uav) && !state.returning(uav);
    let first = |uav: usize| {
        let alike = |&other: &usize| flies(other) && state.cell(other) == state.cell(uav);
        (0..uav).find(alike).unwrap_or(uav)
    };
    for uav in (0..uavs).filter(|&uav| flies(uav)) {
        all[first(uav)][labels[2 * uav] as usize] += 1;
    }
    for uav in (0..uavs).filter(|&uav| flies(uav)) {
        let (all, dealt) = (&all[first(uav)], &mut dealt[first(uav)]);
        let (size, turn) = (all.iter().sum::<i32>(), dealt.iter().sum::<i32>() + 1);
        let behind = |motion: &usize| all[*motion] * turn - dealt[*motion] * size;
        let motion = (0..all.len()).rev().max_by_key(behind).unwrap_or(0);
        dealt[motion] += 1;
        labels[2 * uav] = motion as f32;
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
        let mut teacher = Teacher::new();
        for seed in 0..20 {
            sim.reset(seed);
            let there = sim.state().hotspot_cell(0);
            for step in 0..4 {
                let mut labels = [9.0; 6];
                teacher.teach(&model, sim.words(), &mut labels);
                let motions = [labels[0], labels[2], labels[4]];
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
                let actions = motions.map(|motion| {
                    [
                        Motion::ALL[motion as usize].to_action(config.motion_map),
                        -1.0,
                    ]
                });
                if sim.step(actions.as_flattened()).unwrap().terminated {
                    break;
                }
            }
        }
    }

    // Twelve UAVs of `squads` divide as they leave the depot. A learner that goes by the labels
    // has as many of each motion in each cell, and the densities of `adaptive`.
    #[test]
    fn a_fleet_that_follows_divides_as_the_teacher() {
        let config = Config {
            uav_count: 12,
            hotspot_count: 6,
            ..Config::preset(Preset::Paper)
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        let mut squads = BaselineKind::Squads.build_privileged(PilotMode::Adaptive);
        let mut teacher = Teacher::new();
        let (mut actions, mut labels) = ([0.0; 24], [9.0; 24]);
        let (mut divided, mut reordered) = (0, 0);
        for seed in 0..20 {
            sim.reset(seed);
            for _ in 0..8 {
                let state = sim.state();
                squads.reset(&model, seed);
                squads.act(&model, &state, &mut actions);
                teacher.teach(&model, sim.words(), &mut labels);
                let mut chosen = [0.0; 24];
                for uav in 0..12 {
                    chosen[2 * uav] =
                        Motion::ALL[labels[2 * uav] as usize].to_action(config.motion_map);
                    chosen[2 * uav + 1] = actions[2 * uav + 1];
                    let density = (actions[2 * uav + 1] + 1.0) / 2.0;
                    assert_eq!(labels[2 * uav + 1], density);
                }
                for uav in 0..12 {
                    let cell = |other: &usize| state.cell(*other) == state.cell(uav);
                    let motions = |actions: &[f32]| -> Vec<usize> {
                        let each = (0..12).filter(cell);
                        each.map(|uav| motion(actions[2 * uav], config.motion_map) as usize)
                            .collect()
                    };
                    let (mut planned, mut followed) = (motions(&actions), motions(&chosen));
                    reordered += u32::from(planned != followed);
                    planned.sort_unstable();
                    followed.sort_unstable();
                    divided += u32::from(planned.first() != planned.last());
                    assert_eq!(planned, followed);
                }
                if sim.step(&chosen).unwrap().terminated {
                    break;
                }
            }
        }
        assert!(divided > 100 && reordered > 10, "{divided} {reordered}");
    }

    // Six UAVs in one cell, of which four fly to the right and two upwards.
    #[test]
    fn motions_are_dealt_by_turns() {
        let config = Config {
            uav_count: 6,
            ..Config::preset(Preset::Paper)
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(0);
        let dealt = |motions: [Motion; 6]| {
            let index = |motion: Motion| motion as u8 as f32;
            let mut labels = motions.map(|motion| [index(motion), 0.5]);
            deal(&sim.state(), labels.as_flattened_mut());
            labels.map(|label| Motion::ALL[label[0] as usize])
        };
        let (right, up) = (Motion::Right, Motion::Up);
        let expected = [right, up, right, right, up, right];
        assert_eq!(dealt([right, right, right, right, up, up]), expected);
        assert_eq!(dealt([up, right, right, up, right, right]), expected);
        assert_eq!(dealt([up; 6]), [up; 6]);
    }
}
