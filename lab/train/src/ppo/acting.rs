//! The choice of actions while experience is collected.

use super::rollout::Rollout;
use crate::head::LearningHead;
use crate::network::{Network, values};
use burn_tensor::{Device, Tensor};
use jcas_core::Motion;
use jcas_policy::head::Head;
use jcas_policy::network::choices::read_choices;
use rand_chacha::ChaCha8Rng;

/// The actor as the workers use it: weights on a device without gradients.
pub struct ActingPolicy<'a> {
    /// Action head.
    pub head: Head,
    /// Actor network.
    pub network: &'a Network,
    /// Its parameters.
    pub parameters: &'a [f32],
    /// Device of the weights.
    pub device: &'a Device,
    /// Whether episodes with an even index fly the most likely actions. All others fly drawn ones.
    pub half_deterministic: bool,
}

impl Rollout {
    /// Chooses the actions of step `t`: of all UAVs at once, or in turn. A turn has the UAVs of one
    /// index in all missions.
    pub(super) fn choose(
        &mut self,
        t: usize,
        policy: &ActingPolicy,
        weights: &[Tensor<2>],
        actions: &mut [f32],
        random: &mut ChaCha8Rng,
    ) {
        let (shape, network) = (self.shape, policy.network);
        let (rows, uavs, len) = (shape.rows(), shape.agents, shape.observation_len);
        let (first, width) = (t * rows, network.features_len(&shape));
        self.actor_features.resize((first + rows) * width, 0.0);
        let in_turn = network.reads_choices();
        let turns = if in_turn { uavs } else { 1 };
        let mut seen = vec![0.0; rows / turns * len];
        for turn in 0..turns {
            let own = (turn..rows).step_by(turns);
            for (row, seen) in own.clone().zip(seen.chunks_exact_mut(len)) {
                if in_turn {
                    self.read_fleet(t, row, actions, seen);
                } else {
                    seen.copy_from_slice(&self.observations[(first + row) * len..][..len]);
                }
            }
            let features = network.features(&seen, &shape);
            for (row, features) in own.clone().zip(features.chunks_exact(width)) {
                self.actor_features[(first + row) * width..][..width].copy_from_slice(features);
            }
            let outputs = values(network.forward(weights, features, &shape));
            for (row, output) in own.zip(outputs.chunks_exact(policy.head.outputs())) {
                let even = (row / uavs).is_multiple_of(2);
                let (raw, log_probs) = if policy.half_deterministic && even {
                    // What was not drawn has no density.
                    (policy.head.most_likely(output, shape.motion_map), [0.0; 2])
                } else {
                    policy.head.draw(output, random)
                };
                let place = 2 * (first + row);
                self.raw_actions[place..place + 2].copy_from_slice(&raw);
                self.log_probs[place..place + 2].copy_from_slice(&log_probs);
                actions[2 * row..][..2].copy_from_slice(&policy.head.action(raw, shape.motion_map));
            }
        }
    }

    /// Copies a row's observation in step `t` to `seen`, with what the UAVs before it in its fleet
    /// choose in `actions`.
    fn read_fleet(&self, t: usize, row: usize, actions: &[f32], seen: &mut [f32]) {
        let shape = self.shape;
        let uav = row % shape.agents;
        let fleet = row - uav;
        let observations = (t * shape.rows() + fleet) * shape.observation_len;
        let observations = &self.observations[observations..];
        let actions = &actions[2 * fleet..];
        read_choices(shape.row_layout(), observations, actions, uav, seen);
    }

    /// Shows each UAV the labels of the UAVs before it, in place of what they have chosen in step
    /// `t`.
    pub(super) fn show_labels(&mut self, t: usize, network: &Network) {
        let shape = self.shape;
        let (rows, len) = (shape.rows(), shape.observation_len);
        let first = t * rows;
        let labels = self.labels[2 * first..][..2 * rows].chunks_exact(2);
        let taught: Vec<f32> = labels
            .flat_map(|label| {
                [
                    Motion::ALL[label[0] as usize].to_action(shape.motion_map),
                    0.0,
                ]
            })
            .collect();
        let mut seen = vec![0.0; rows * len];
        for (row, seen) in seen.chunks_exact_mut(len).enumerate() {
            self.read_fleet(t, row, &taught, seen);
        }
        let features = network.features(&seen, &shape);
        self.actor_features[first * network.features_len(&shape)..][..features.len()]
            .copy_from_slice(&features);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{Shape, StepOut};
    use crate::network::Architecture;
    use crate::random::stream;
    use crate::settings::Credit;

    // Three UAVs in one cell learn to divide. Each sees the labels of those before it, and not
    // what these have chosen.
    #[test]
    fn features_show_the_labels_before() {
        let shape = Shape {
            environments: 1,
            agents: 3,
            hotspots: 1,
            neighbour_slots: 2,
            observation_len: 21,
            grid: [9, 9],
            reach: 2.0,
            ..Shape::default()
        };
        let network = Network::new(Architecture::SetActor {
            hidden: vec![8],
            outputs: 7,
            added: 0,
            fleet_size: false,
            choices: true,
        });
        let mut observations = vec![0.0; 3 * shape.observation_len];
        for row in observations.chunks_exact_mut(shape.observation_len) {
            row[..2].fill(0.5);
            row[9] = 1.0;
            row[12] = 1.0;
        }
        let out = StepOut::new(shape, Credit::Teacher);
        let shown = |motions: [usize; 3]| {
            let mut rollout = Rollout::new(shape, 1, &out);
            rollout.observations.clone_from(&observations);
            rollout.actor_features = vec![9.0; 3 * network.features_len(&shape)];
            rollout.labels = motions
                .iter()
                .flat_map(|&motion| [motion as f32, 0.5])
                .collect();
            rollout.show_labels(0, &network);
            let features = rollout.actor_features;
            let width = network.features_len(&shape);
            [0, 1, 2].map(|uav| features[uav * width..][..width].to_vec())
        };
        let expected = |motions: [usize; 3], uav: usize| {
            let actions: Vec<f32> = motions
                .iter()
                .flat_map(|&motion| [Motion::ALL[motion].to_action(shape.motion_map), 0.0])
                .collect();
            let mut row = vec![0.0; shape.observation_len];
            read_choices(shape.row_layout(), &observations, &actions, uav, &mut row);
            network.features(&row, &shape)
        };
        for motions in [[0, 3, 0], [4, 2, 1]] {
            let shown = shown(motions);
            for (uav, shown) in shown.iter().enumerate() {
                assert_eq!(*shown, expected(motions, uav), "{motions:?} {uav}");
            }
            assert_ne!(shown[0], shown[1]);
            assert_ne!(shown[1], shown[2]);
        }
    }

    // Six episodes with the same observation: those with an even index fly its likeliest motion.
    #[test]
    fn half_of_a_teachers_episodes_fly_the_most_likely_actions() {
        let shape = Shape {
            environments: 6,
            agents: 1,
            observation_len: 2,
            ..Shape::default()
        };
        let sizes = vec![2, 7];
        let network = Network::new(Architecture::Mlp { sizes });
        let mut parameters = vec![0.0; network.parameters()];
        // The bias of the motion right is 0.5, and those of the others are 0.
        parameters[14 + 3] = 0.5;
        let device = Device::flex();
        let weights = network.tensors(&parameters, &device);
        let out = StepOut::new(shape, Credit::Teacher);
        let mut random = stream(1, 0);
        let mut others = [0; 2];
        for half_deterministic in [true, false] {
            let policy = ActingPolicy {
                head: Head::Hybrid,
                network: &network,
                parameters: &parameters,
                device: &device,
                half_deterministic,
            };
            for _ in 0..50 {
                let mut rollout = Rollout::new(shape, 1, &out);
                let mut actions = [0.0; 12];
                rollout.choose(0, &policy, &weights, &mut actions, &mut random);
                for (episode, action) in actions.chunks_exact(2).enumerate() {
                    let other = action[0] != Motion::Right.to_action(shape.motion_map);
                    assert_eq!(rollout.raw_actions[2 * episode] != 3.0, other);
                    if half_deterministic {
                        others[episode % 2] += u32::from(other);
                    } else {
                        assert!(rollout.log_probs[2 * episode] < 0.0);
                    }
                }
            }
        }
        assert!(others[0] == 0 && others[1] > 50, "{others:?}");
    }
}
