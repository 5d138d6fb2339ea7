//! The choice of actions while experience is collected.

use super::rollout::Rollout;
use crate::head::LearningHead;
use crate::network::{Network, values};
use burn_tensor::{Device, Tensor};
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
                let fleet = row - row % uavs;
                let observations = &self.observations[(first + fleet) * len..];
                if in_turn {
                    let actions = &actions[2 * fleet..];
                    read_choices(shape.row_layout(), observations, actions, turn, seen);
                } else {
                    seen.copy_from_slice(&observations[(row - fleet) * len..][..len]);
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
                    (policy.head.most_likely(output), [0.0; 2])
                } else {
                    policy.head.draw(output, random)
                };
                let place = 2 * (first + row);
                self.raw_actions[place..place + 2].copy_from_slice(&raw);
                self.log_probs[place..place + 2].copy_from_slice(&log_probs);
                actions[2 * row..][..2].copy_from_slice(&policy.head.action(raw));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{Shape, StepOut};
    use crate::network::Architecture;
    use crate::random::stream;
    use crate::settings::Credit;
    use jcas_policy::head::motion_centre;

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
        let out = StepOut::new(shape, Credit::Teacher, false);
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
                    let other = action[0] != motion_centre(3);
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
